"""tentacle simulate: the MuJoCo reference makes a recording, on request with effects that its declaration leaves
out."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mujoco_ref.undeclared import Plan
    from tentacle.recording import Recording
    from tentacle.waveform import Waveform

HELP = "make a recording with the high-order reference (MuJoCo): import folder or .rrd, midline or video"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("model", type=Path, metavar="MODEL.toml", help="specimen, fluid, gravity and effects")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR|FILE.rrd", help="where to write it")
    motion = parser.add_mutually_exclusive_group()
    motion.add_argument("--waveform", type=Path, metavar="FILE.toml", help="base motion, a [waveform] table")
    motion.add_argument("--sine", nargs=2, type=float, metavar=("RAD", "HZ"), help="amplitude and frequency")
    motion.add_argument("--chirp", nargs=3, type=float, metavar=("RAD", "HZ", "HZ"), help="amplitude, from, to")
    parser.add_argument("--duration", type=float, default=12.0, metavar="S", help="default: 12 s")
    parser.add_argument("--fps", type=float, default=60.0, help="frames a second, default: 60")
    parser.add_argument("--seed", type=int, default=0, help="of noise and of whatever is drawn, default: 0")
    parser.add_argument("--links", type=int, default=20, metavar="N", help="hinges of the chain, default: 20")
    parser.add_argument("--noise-mm", type=float, default=0.15, metavar="MM", help="of the midline, default: 0.15")
    parser.add_argument(
        "--servo-limits", nargs=3, type=float, metavar=("RAD", "RAD/S", "RAD/S2"), help="refuse a motion beyond them"
    )
    parser.add_argument(
        "--hide",
        action="append",
        default=[],
        metavar="EFFECT[=VALUE]",
        help="act, but do not declare: tip_mass, tip_mass=faint, tip_mass=0.002, current=U_x:0.05,U_y:0",
    )
    parser.add_argument("--truth", type=Path, metavar="FILE.json", help="where to write what is hidden (not in --out)")
    parser.add_argument("--video", metavar="LOOK", help="a video instead of the midline: clean, tank, ... or mujoco")
    parser.add_argument("--size", nargs=2, type=int, default=(960, 720), metavar=("W", "H"), help="of the video [px]")
    parser.add_argument("--trials", type=int, metavar="N", help="N blind recordings in --out, effects drawn at random")
    parser.add_argument("--sealed", type=Path, metavar="FILE.jsonl", help="with --trials: the answers, a line each")
    parser.add_argument("--most", type=int, default=1, metavar="N", help="with --trials: effects in one, default: 1")


def run(arguments: argparse.Namespace) -> int:
    """Read the model and the motion, simulate, write."""
    import json
    import os

    if arguments.video == "mujoco":
        os.environ.setdefault("MUJOCO_GL", "egl")  # MuJoCo reads it when it is imported
    from mujoco_ref.undeclared import Noise, Plan, make
    from tentacle.errors import InputError
    from tentacle.io.model_file import read_model

    model, waveform = read_model(arguments.model), _motion(arguments)
    noise = Noise(midline=1e-3 * arguments.noise_mm)
    _check(arguments)
    if arguments.trials is not None:
        plan = Plan(
            model, waveform, arguments.seed, arguments.duration, arguments.fps, noise, most=arguments.most
        )  # fmt: skip
        return _write_trials(plan, arguments)
    truth_file = arguments.truth
    if truth_file is not None and _inside(truth_file, arguments.out):
        raise InputError("lies in the recording itself", file=truth_file, field="--truth", expected="a file elsewhere")
    recording, truth = make(
        hidden_effects(arguments.hide, arguments.seed, model),
        model,
        waveform,
        arguments.seed,
        arguments.duration,
        arguments.fps,
        noise,
        name=arguments.out.stem,
        links=arguments.links,
        clean_midline=arguments.video is not None,
    )
    _write(recording, arguments, arguments.out, arguments.seed)
    if truth_file is not None:
        truth_file.write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    print(f"wrote {arguments.out}: {arguments.duration:g} s, {arguments.fps:g} frames/s, {arguments.links} links")
    for effect, values in truth["effects"].items():
        print(f"hidden: {effect} " + ", ".join(f"{name} = {value:.4g}" for name, value in values.items()))
    if truth["effects"]:
        print(f"it moves the midline by {truth['moved_mm']:.3f} mm rms")
    return 0


def _motion(arguments: argparse.Namespace) -> Waveform:
    """The base motion; without a flag the chirp on which effects differ most, 0.3 to 2.2 Hz."""
    from tentacle.io.waveform_file import read_waveform
    from tentacle.waveform import Chirp, Sine

    if arguments.waveform is not None:
        return read_waveform(arguments.waveform)
    if arguments.sine is not None:
        return Sine(*arguments.sine)
    amplitude, start, stop = arguments.chirp or (0.5, 0.3, 2.2)
    return Chirp(amplitude, start, stop, arguments.duration)


def _check(arguments: argparse.Namespace) -> None:
    from tentacle.errors import InputError
    from tentacle.servo_limits import ServoLimits

    for name in ("duration", "fps"):
        if not getattr(arguments, name) > 0.0:
            raise InputError(f"{getattr(arguments, name)!r} is not usable", field=f"--{name}", expected="above 0")
    if arguments.noise_mm < 0.0:
        raise InputError(f"{arguments.noise_mm!r} is not usable", field="--noise-mm", expected="0 or more")
    if arguments.trials is not None and arguments.sealed is None:
        raise InputError("trials need a place for their answers", field="--sealed", expected="FILE.jsonl")
    if arguments.trials is not None and (arguments.trials < 1 or arguments.most < 1):
        raise InputError("not usable", field="--trials/--most", expected="1 or more")
    if arguments.trials is not None and _inside(arguments.sealed, arguments.out):
        raise InputError("lies among the trials", file=arguments.sealed, field="--sealed", expected="a file elsewhere")
    if arguments.trials is not None and arguments.hide:
        raise InputError("trials draw their own effects", field="--hide", expected="either --trials or --hide")
    if arguments.servo_limits is not None:
        ServoLimits(*arguments.servo_limits).check(_motion(arguments), arguments.duration)


def _inside(file: Path, folder: Path) -> bool:
    return file.resolve().is_relative_to(folder.resolve())


def hidden_effects(options: list[str], seed: int, model: Any) -> dict[str, str | float | Mapping[str, float]]:
    """--hide options as effects for undeclared.make; InputError where one cannot be read."""
    import numpy as np

    from mujoco_ref.undeclared.strength import SCALED, SIZES, typical
    from tentacle.errors import InputError

    effects: dict[str, str | float | Mapping[str, float]] = {}
    for option in options:
        effect, _, text = option.partition("=")
        drawn = typical(effect, model, np.random.default_rng(seed))
        if text in ("", *SIZES):
            effects[effect] = text or "visible"
            continue
        pairs = [pair.partition(":") for pair in text.split(",")]
        if not any(separator for _, separator, _ in pairs):
            if len(SCALED[effect]) != 1:
                expected = ",".join(f"{name}:VALUE" for name in drawn) or "no value"
                raise InputError(f"{text!r} does not say of what", field=f"--hide {effect}", expected=expected)
            pairs = [(SCALED[effect][0], ":", text)]
        try:
            effects[effect] = drawn | {name: float(number) for name, _, number in pairs}
        except ValueError:
            raise InputError(f"{text!r} is not a number", field=f"--hide {effect}", expected="VALUE") from None
    return effects


def _write(recording: Recording, arguments: argparse.Namespace, out: Path, seed: int) -> None:
    """Write an import folder or an .rrd; with --video the midline becomes a rendered video."""
    import tempfile

    from tentacle.io.write_folder import write_folder

    with tempfile.TemporaryDirectory() as folder:
        if arguments.video is not None:
            from validation.film import filmed

            recording = filmed(recording, Path(folder) / "video.mp4", arguments.video, tuple(arguments.size), seed)
        if out.suffix == ".rrd":
            from tentacle.io.recording_rrd import write_rrd

            write_rrd(recording, out)
        else:
            write_folder(recording, out)


def _write_trials(plan: Plan, arguments: argparse.Namespace) -> int:
    """N blind recordings, and a baseline with nothing hidden; what stands already, answer and all, is not made
    again."""
    import json

    from rich.console import Console
    from rich.progress import track

    from mujoco_ref.undeclared import make, trial_name

    film = arguments.video is not None
    out, sealed = arguments.out, arguments.sealed
    lines = sealed.read_text(encoding="utf-8").splitlines() if sealed.exists() else []
    answered = {json.loads(line)["trial"] for line in lines}
    out.mkdir(parents=True, exist_ok=True)
    sealed.parent.mkdir(parents=True, exist_ok=True)
    if not (out / "baseline").exists():
        base, _ = make(
            {}, plan.model, plan.waveform, plan.seed, plan.duration, plan.fps, plan.noise,
            name="baseline", clean_midline=film,
        )  # fmt: skip
        _write(base, arguments, out / "baseline", plan.seed)
    for k in track(range(arguments.trials), "trials", console=Console(stderr=True)):
        folder = out / trial_name(k)
        if folder.exists() and k in answered:
            continue
        trial = plan.trial(k, clean_midline=film)
        if not folder.exists():
            _write(trial.recording, arguments, folder, trial.truth["seed"])
        if k not in answered:
            with sealed.open("a", encoding="utf-8") as file:
                file.write(json.dumps(trial.truth) + "\n")
    print(f"wrote {arguments.trials} trials and a baseline to {out}, their answers to {sealed}")
    return 0

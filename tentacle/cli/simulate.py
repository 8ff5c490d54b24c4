"""tentacle simulate: the MuJoCo reference makes a recording, on request with effects that its declaration leaves
out."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say
from tentacle.cli._simulate_arguments import base_motion_of, travel_of
from tentacle.cli._simulate_arguments import configure as configure

HELP = "make a recording with the high-order reference (MuJoCo): import folder or .rrd, midline or video"


def run(arguments: argparse.Namespace) -> int:
    """Read the model and the motion, simulate, write."""
    import json
    import os
    from contextlib import ExitStack

    if arguments.video == "mujoco":
        os.environ.setdefault("MUJOCO_GL", "egl")  # MuJoCo reads it when it is imported
    from rich.console import Console
    from rich.progress import track

    from mujoco_ref.undeclared import Noise, Scenario, SealedPlan, make_recording
    from tentacle.errors import InputError
    from tentacle.io.model_file import read_model
    from tentacle.io.written_file import written_file
    from tentacle.units import from_mm
    from validation.trials.blind_folder import FilmStyle, write_simulated, write_trials
    from validation.trials.hide_options import hidden_effects

    model, waveform = read_model(arguments.model), base_motion_of(arguments)
    noise, film = Noise(midline=from_mm(arguments.noise_mm)), FilmStyle(arguments.video, tuple(arguments.size))
    _check(arguments)
    if arguments.trials is not None:
        plan = SealedPlan(
            model, waveform, arguments.seed, arguments.duration, arguments.fps, noise, most=arguments.most
        )  # fmt: skip
        trials = write_trials(plan, arguments.trials, film, arguments.out, arguments.sealed)
        console = Console(stderr=True)
        for _ in track(trials, "trials", arguments.trials, console=console, disable=not console.is_terminal):
            pass
        answers = f"their answers to {arguments.sealed}"
        say(f"wrote {arguments.trials} trials and a baseline to {arguments.out}, {answers}")
        return 0
    truth_file = arguments.truth
    if truth_file is not None and _inside(truth_file, arguments.out):
        raise InputError("lies in the recording itself", file=truth_file, field="--truth", expected="a file elsewhere")
    recording, truth = make_recording(
        hidden_effects(arguments.hide, arguments.seed, model),
        Scenario(
            model, waveform, arguments.duration, arguments.fps, links=arguments.links, travel=travel_of(arguments)
        ),
        arguments.seed,
        noise,
        name=arguments.out.stem,
        clean_midline=arguments.video is not None,
    )
    with ExitStack() as both:  # the recording and its truth: both or none
        if truth_file is not None:
            both.enter_context(written_file(truth_file)).write_text(json.dumps(truth, indent=1) + "\n", "utf-8")
        write_simulated(recording, film, arguments.out, arguments.seed)
    say(f"wrote {arguments.out}: {arguments.duration:g} s, {arguments.fps:g} frames/s, {arguments.links} links")
    for effect, values in truth["effects"].items():
        say(f"hidden: {effect} " + ", ".join(f"{name} = {value:.4g}" for name, value in values.items()))
    if truth["effects"]:
        say(f"it moves the midline by {truth['moved_mm']:.3f} mm rms")
    return 0


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
    if arguments.travel is not None and (arguments.video is not None or arguments.trials is not None):
        other = "--video" if arguments.video is not None else "--trials"
        raise InputError("a film or a trial has a base that stands", field="--travel", expected=f"no {other} beside it")
    if arguments.servo_limits is not None:
        ServoLimits(*arguments.servo_limits).check(base_motion_of(arguments), arguments.duration)


def _inside(file: Path, folder: Path) -> bool:
    return file.resolve().is_relative_to(folder.resolve())

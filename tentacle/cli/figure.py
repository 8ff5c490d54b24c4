"""`tentacle figure`: the paper's figures, drawn from any recording."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tentacle.model import Model
    from tentacle.recording import Recording

HELP = "draw one of the paper's figures (3, 4, 5, 6, 8, 9, 10) from your own recordings"

FIGURES = {
    3: "the image processing of one frame, step by step",
    4: "the average period of q1, q2",
    5: "regression and simulation (needs --model)",
    6: "stills with what was seen, and with --model what it says",
    8: "the worst and the best of several recordings (needs --model)",
    9: "mean thrust over amplitude and frequency of a sine (needs --model; recordings give the measured side)",
    10: "swimming speeds: a CSV with the columns arm, motion, speed_m_s, one run a row",
}
SUFFIXES = (".svg", ".pdf", ".png")
STILLS = 4


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the verb."""
    words = "; ".join(f"{number}: {text}" for number, text in FIGURES.items())
    parser.add_argument("number", type=int, choices=tuple(FIGURES), metavar="NUMBER", help=words)
    parser.add_argument("inputs", nargs="*", type=Path, metavar="RECORDING", help="recordings (a CSV for figure 10)")
    parser.add_argument("--model", type=Path, metavar="model.toml", help="of identify or diagnose")
    parser.add_argument("--at", type=float, metavar="SECONDS", help="of figure 3 (default: a frame with much bend)")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="FILE.svg, FILE.pdf or FILE.png")


def run(arguments: argparse.Namespace) -> int:
    """Draw and write."""
    from tentacle.errors import InputError
    from viz.figures.style import save

    if arguments.out.suffix not in SUFFIXES:
        raise InputError("not a figure's name", file=arguments.out, field="--out", expected=" ".join(SUFFIXES))
    if not arguments.inputs and arguments.number != 9:
        raise InputError("nothing to draw", field="RECORDING", expected="at least one")
    if arguments.model is None and arguments.number in (5, 8, 9):
        raise InputError(f"figure {arguments.number} needs a model", field="--model", expected="--model model.toml")
    if arguments.at is not None and arguments.number != 3:
        raise InputError("only figure 3 is of one frame", field="--at", expected="figure 3")
    print(save(make_figure(arguments), arguments.out))
    return 0


def make_figure(arguments: argparse.Namespace) -> Figure:
    """The figure that was asked for."""
    if arguments.number == 10:
        return speeds(arguments.inputs[0])
    if arguments.number == 3:
        return pipeline(arguments.inputs[0], arguments.at)
    from tentacle.cli._progress import stages
    from tentacle.io.model_file import read_model
    from vision.tracked_recording import read_tracked

    with stages() as stage:
        recordings = [read_tracked(path, stage) for path in arguments.inputs]
        stage(f"drawing figure {arguments.number}")
        if arguments.number == 4:
            return period(recordings[0])
        if arguments.number == 6:
            return stills(recordings[0], None if arguments.model is None else read_model(arguments.model))
        model = read_model(arguments.model)
        if arguments.number == 5:
            return regression(recordings[0], model)
        return extremes(recordings, model) if arguments.number == 8 else thrust(recordings, model)


def pipeline(source: Path, at: float | None) -> Figure:
    """Figure 3: the frame, binarised, its largest contour, the mean axis, and the shape that fits it best."""
    from tentacle.errors import InputError
    from tentacle.io.reading import read_recording
    from vision.paper_pipeline import bent_instant, paper_steps
    from viz.figures.pipeline import Still, crop_around, pipeline_figure
    from viz.palette import AUGMENTED, BASE, MEASURED

    recording = read_recording(source)
    camera = recording.declaration.camera
    if recording.video is None or camera is None:
        raise InputError("has no video", file=source, expected="a recording with a video")
    seen = (recording.video.path, recording.declaration, recording.motor)
    steps = paper_steps(*seen, bent_instant(*seen) if at is None else at)
    axis, fitted = camera.to_pixels(steps.axis), camera.to_pixels(steps.fitted)
    stills = [
        Still("frame", steps.image),
        Still("binarised", steps.binary),
        Still("largest contour", steps.image, [(MEASURED, steps.contour)]),
        Still("mean axis", steps.image, [(MEASURED, steps.contour), (AUGMENTED, axis)]),
        Still(f"q = {steps.q[0]:.2f}, {steps.q[1]:.2f} rad", steps.image, [(AUGMENTED, axis), (BASE, fitted)]),
    ]
    return pipeline_figure(crop_around(stills, steps.contour))


def period(recording: Recording) -> Figure:
    """Figure 4."""
    from inference.measured_coordinates import coordinates
    from tentacle.errors import InputError
    from viz.figures.period import fundamental_period, period_figure

    if recording.motor is None:
        raise InputError("the base is clamped", file=recording.name, expected="a recording with motor.csv")
    t, q = coordinates(recording)
    return period_figure(t, q, fundamental_period(recording.motor.t, recording.motor.angle))


def regression(recording: Recording, model: Model) -> Figure:
    """Figure 5."""
    from inference.measured_coordinates import beside_model, regression_sides
    from viz.figures.regression import regression_figure
    from viz.scene import model_scene

    t, delta, prediction = regression_sides(recording, model)
    return regression_figure(t, delta, prediction, model_scene(beside_model(recording, model)))


def extremes(recordings: list[Recording], model: Model) -> Figure:
    """Figure 8."""
    from inference.measured_coordinates import beside_model
    from viz.figures.extremes import extremes_figure
    from viz.scene import model_scene

    for recording in recordings:
        _needs_shapes(recording)
    return extremes_figure([model_scene(beside_model(recording, model)) for recording in recordings])


def _needs_shapes(recording: Recording) -> None:
    """InputError where q was not measured: markers alone give points, no curvature coordinates."""
    from tentacle.errors import InputError

    if recording.video is None and recording.shape is None and recording.midline is None:
        raise InputError("has no shapes", file=recording.name, expected="a recording with a video or a midline")


def stills(recording: Recording, model: Model | None) -> Figure:
    """Figure 6: frames spread over the recording, above with the outline seen, below with the model's."""
    import numpy as np

    from inference.measured_coordinates import beside_model
    from tentacle.errors import InputError
    from viz.figures.pipeline import Still, crop_around, stills_figure
    from viz.midline import perimeter
    from viz.palette import BASE, MEASURED
    from viz.track import track_scene
    from viz.video import frames, upright

    camera, arm = recording.declaration.camera, recording.declaration.specimen
    if recording.video is None or camera is None or recording.shape is None:
        raise InputError("has no tracked video", file=recording.name, expected="a recording with a video")
    scene = track_scene(recording)
    accepted = scene.t[recording.shape.accepted]
    chosen = accepted[np.linspace(0, len(accepted) - 1, STILLS).round().astype(int)]
    run = beside_model(recording, model) if model is not None else None
    above, below = [], []
    for t, frame in frames(recording):
        if not np.any(np.abs(chosen - t) <= 0.5 / camera.fps):
            continue
        picture = upright(frame).to_ndarray(format="rgb24").astype(np.uint8)
        k = int(np.argmin(np.abs(scene.t - t)))
        seen = camera.to_pixels(perimeter(scene.subject.xy[k], scene.s, arm.section))
        above.append(Still(f"t = {t:.2f} s", picture, [(MEASURED, seen)]))
        if run is not None:
            k = int(np.argmin(np.abs(run.t - t)))
            below.append(
                Still("", picture, [(BASE, camera.to_pixels(perimeter(run.augmented[k], run.s, arm.section)))])
            )
    seen = camera.to_pixels(scene.subject.xy).reshape(-1, 2)
    return stills_figure([crop_around(row, seen) for row in ([above, below] if below else [above])])


def thrust(recordings: list[Recording], model: Model) -> Figure:
    """Figure 9: the model's map, and mean load-cell readings where recordings with a sine at the base give them.

    Forward is base first, against y: the signs of the fluid's force and of the load cell (tared) are turned.
    """
    import numpy as np

    from affine_model.arm import arm_of, parameter_vector
    from affine_model.simulate import simulate
    from tentacle.waveform import Sine
    from viz.figures.period import fundamental_period
    from viz.figures.thrust_map import ThrustMap, thrust_map_figure

    amplitude, frequency, measured = np.linspace(0.1, 0.7, 5), np.linspace(0.3, 1.8, 6), None
    wave = [r for r in recordings if r.motor is not None and r.load_cell is not None]
    if wave:
        motors = [r.motor for r in wave if r.motor is not None]
        tried = [(float(np.ptp(m.angle) / 2), 1.0 / fundamental_period(m.t, m.angle)) for m in motors]
        amplitude = np.unique(np.round(np.array([a for a, _ in tried], dtype=np.float64), 2)).astype(np.float64)
        frequency = np.unique(np.round(np.array([f for _, f in tried], dtype=np.float64), 2)).astype(np.float64)
        measured = np.full((len(amplitude), len(frequency)), np.nan)
        for (a, f), recording in zip(tried, wave, strict=True):
            assert recording.load_cell is not None
            place = int(np.argmin(np.abs(amplitude - a))), int(np.argmin(np.abs(frequency - f)))
            measured[place] = -recording.load_cell.thrust.mean()
    step, seconds = 1.0 / 300.0, 10.0  # the paper averages over 10 s
    middles = (np.arange(round(seconds / step)) + 0.5) * step
    grid = [(a, f) for a in amplitude for f in frequency]
    base = np.stack([Sine(a, f)(middles) for a, f in grid], axis=-1)
    parameters = np.repeat(parameter_vector(model)[:, None], len(grid), axis=1)
    batch = simulate(arm_of(model), parameters, base, step, stride=0)
    modelled = -batch.mean_thrust.reshape(len(amplitude), len(frequency))
    name = f"L = {1e3 * model.specimen.length:.0f} mm"
    return thrust_map_figure([ThrustMap(name, amplitude, frequency, modelled, measured)])


def speeds(file: Path) -> Figure:
    """Figure 10."""
    import csv

    import numpy as np

    from tentacle.errors import InputError
    from viz.figures.speeds import Swim, speeds_figure

    if not file.is_file():
        raise InputError("no such file", file=file, expected="a CSV with the columns arm, motion, speed_m_s")
    runs: dict[tuple[str, str], list[float]] = {}
    with file.open(newline="", encoding="utf-8") as opened:
        for number, row in enumerate(csv.DictReader(opened), start=2):
            for column in ("arm", "motion", "speed_m_s"):
                if not row.get(column):
                    raise InputError("missing", file=file, row=number, field=column, expected="a value")
            try:
                runs.setdefault((row["arm"], row["motion"]), []).append(float(row["speed_m_s"]))
            except ValueError:
                raise InputError(
                    f"{row['speed_m_s']!r} is no number", file=file, row=number, field="speed_m_s", expected="m/s"
                ) from None
    if not runs:
        raise InputError("has no row", file=file, expected="one run a row")
    return speeds_figure([Swim(arm, motion, np.array(values)) for (arm, motion), values in runs.items()], {})

"""The paper's figures 3, 4, 5, 6, 8, 9 and 10, drawn from recordings and models of one's own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from inference.measured_coordinates import beside_model, coordinates, regression_sides
from tentacle.errors import InputError
from tentacle.io.reading import read_recording
from tentacle.io.swim_table import read_swim_table
from tentacle.model import Model
from tentacle.recording import Recording
from validation.sine_thrust import sine_thrust
from vision.paper_pipeline import bent_instant, paper_steps
from viz.figures.extremes import extremes_figure
from viz.figures.period import fundamental_period, period_figure
from viz.figures.pipeline import PaperStill, crop_around, pipeline_figure, stills_figure
from viz.figures.regression import regression_figure
from viz.figures.speeds import Swim, speeds_figure
from viz.figures.thrust_map import ThrustMap, thrust_map_figure
from viz.midline import perimeter
from viz.palette import AUGMENTED, BASE, MEASURED
from viz.scene import model_scene
from viz.track import track_scene
from viz.video import frames, upright

STILLS = 4


def pipeline(source: Path, at: float | None) -> Figure:
    """Figure 3: the frame, binarised, its largest contour, the mean axis, and the shape that fits it best."""
    recording = read_recording(source)
    camera = recording.declaration.camera
    if recording.video is None or camera is None:
        raise InputError("has no video", file=source, expected="a recording with a video")
    seen = (recording.video.path, recording.declaration, recording.motor)
    steps = paper_steps(*seen, bent_instant(*seen) if at is None else at)
    axis, fitted = camera.to_pixels(steps.axis), camera.to_pixels(steps.fitted)
    stills = [
        PaperStill("frame", steps.image),
        PaperStill("binarised", steps.binary),
        PaperStill("largest contour", steps.image, [(MEASURED, steps.contour)]),
        PaperStill("mean axis", steps.image, [(MEASURED, steps.contour), (AUGMENTED, axis)]),
        PaperStill(f"q = {steps.q[0]:.2f}, {steps.q[1]:.2f} rad", steps.image, [(AUGMENTED, axis), (BASE, fitted)]),
    ]
    return pipeline_figure(crop_around(stills, steps.contour))


def period(recording: Recording) -> Figure:
    """Figure 4."""
    if recording.motor is None:
        raise InputError("the base is clamped", file=recording.name, expected="a recording with motor.csv")
    t, q = coordinates(recording)
    return period_figure(t, q, fundamental_period(recording.motor.t, recording.motor.angle))


def regression_page(recording: Recording, model: Model) -> Figure:
    """Figure 5."""
    t, delta, prediction = regression_sides(recording, model)
    return regression_figure(t, delta, prediction, model_scene(beside_model(recording, model)))


def extremes(recordings: list[Recording], model: Model) -> Figure:
    """Figure 8."""
    for recording in recordings:
        _needs_shapes(recording)
    return extremes_figure([model_scene(beside_model(recording, model)) for recording in recordings])


def _needs_shapes(recording: Recording) -> None:
    """InputError where q was not measured: markers alone give points, no curvature coordinates."""
    if recording.video is None and recording.shape is None and recording.midline is None:
        raise InputError("has no shapes", file=recording.name, expected="a recording with a video or a midline")


def stills(recording: Recording, model: Model | None) -> Figure:
    """Figure 6: frames spread over the recording, above with the outline seen, below with the model's."""
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
        above.append(PaperStill(f"t = {t:.2f} s", picture, [(MEASURED, seen)]))
        if run is not None:
            k = int(np.argmin(np.abs(run.t - t)))
            below.append(
                PaperStill("", picture, [(BASE, camera.to_pixels(perimeter(run.augmented[k], run.s, arm.section)))])
            )
    seen = camera.to_pixels(scene.subject.xy).reshape(-1, 2)
    return stills_figure([crop_around(row, seen) for row in ([above, below] if below else [above])])


def thrust(recordings: list[Recording], model: Model) -> Figure:
    """Figure 9: the model's map, and mean load-cell readings where recordings with a sine at the base give them."""
    wave = [
        (1.0 / fundamental_period(r.motor.t, r.motor.angle), r.motor, r.load_cell)
        for r in recordings
        if r.motor is not None and r.load_cell is not None
    ]
    found = sine_thrust(model, wave)
    name = f"L = {1e3 * model.specimen.length:.0f} mm"
    return thrust_map_figure([ThrustMap(name, found.amplitude, found.frequency, found.modelled, found.measured)])


def speeds(file: Path) -> Figure:
    """Figure 10."""
    runs = read_swim_table(file)
    return speeds_figure([Swim(arm, motion, values) for (arm, motion), values in runs.items()], {})

"""A blind trial's recording: hidden effects sized by what the data can show of them, then run, seen, maybe filmed."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from affine_model.arm import arm_of, neutral_parameters, parameter_index
from affine_model.curvature import Array, midline
from affine_model.identify.experiment import Experiment, predict
from affine_model.identify.observation import POSE, ShapeObservation, fit_shapes, from_track
from affine_model.identify.trajectory import Problem, evaluate, fit_multistart
from discovery.score import absorbed_basis
from discovery.trials.design import Design
from mujoco_ref.simulate import DEFAULT_LINKS
from mujoco_ref.undeclared.make import Noise, Scene, make, seen_midline
from mujoco_ref.undeclared.strength import LARGEST, SCALED, is_catalogued, scaled, typical
from tentacle.model import Model
from tentacle.recording import Camera, Recording
from tentacle.signals import Midline

SIZED_AT = 30.0  # frames/s: enough for rms values
SIZED_ORDER, SEEN_ORDER = 3, 5
STEP = 1.0 / 480.0  # s; a strong Maxwell branch on a stiff arm is unstable at 1/300
FACTORS = np.geomspace(3e-3, 300.0, 46)  # on a typical strength
VIDEO_NOISE = 2e-5  # m: a midline's noise that tells as little as the tracker's own covariance (some micrometres to 30)
PICTURE = (960, 540)
CORRECTIONS, CLOSE = 5, 0.05
FREE = (("elasticity", "E"), ("damping", "eta"), ("drag", "C_perp"))


def _bare_problem(model: Model, design: Design, noise: float, root: Array | None = None) -> tuple[Problem, Array]:
    """A trajectory problem at the truth without hidden effects, seen without noise, and its nuisances.

    What is seen is whitened as a midline with that noise [m], or by a track's own root (K, K).
    """
    order = SEEN_ORDER if root is None else root.shape[0] - POSE
    arm = arm_of(replace(model, order=SIZED_ORDER))
    parameters = neutral_parameters()
    for effect, name in FREE:
        parameters[parameter_index(effect, name)] = model.value(effect, name)
    t = np.arange(0.0, design.duration, 1.0 / SIZED_AT)
    base = design.waveform()
    theta, length = base(t)[0], model.specimen.length
    blank = np.zeros((t.size, POSE + order))
    unseen = np.zeros((t.size, blank.shape[1], blank.shape[1]))
    observation = ShapeObservation(t, theta, length, blank, unseen, np.zeros(t.size), np.zeros(t.size))
    used = t > 2.0  # the start from rest is not what a recording shows
    experiment = Experiment("sizing", observation, base, 0.0, float(t[-1]) + 0.2, None, used, np.ones(blank.shape[1]))
    nuisances = np.zeros(2 * SIZED_ORDER + 2)
    shown = predict(arm, experiment, parameters[:, None], nuisances[:, None], STEP)
    s = np.linspace(0.0, 1.0, 41)
    points = midline(shown.q[:, :, 0], shown.theta[:, 0], length, s)
    seen = fit_shapes(Midline(t, s, points, np.full(points.shape[:2], noise)), theta, length, order, noise)
    if root is not None:
        seen = replace(seen, root=np.repeat(root[None], t.size, axis=0))
    return Problem(arm, (replace(experiment, observation=seen),), FREE, parameters, STEP), nuisances


def visible_size(problem: Problem, nuisances: Array, effect: str, variants: list[dict[str, float]]) -> Array:
    """R (V,) of an effect at each set of parameters, to first order: rms of the whitened residual that is not within
    the base's columns.
    """
    state = evaluate(problem, (nuisances,))
    basis = absorbed_basis(state)
    columns = np.repeat(problem.parameters[:, None], len(variants), axis=1)
    for place, values in enumerate(variants):
        for name, value in values.items():
            columns[parameter_index(effect, name), place] = value
    unknowns = np.concatenate([state.values, nuisances])
    rows = problem.residuals_of(columns, np.repeat(unknowns[:, None], len(variants), axis=1))
    rows = rows - state.used_residuals[:, None]
    rows = rows - basis @ (basis.T @ rows)
    return np.sqrt(np.mean(rows**2, axis=0))


def refitted_size(problem: Problem, nuisances: Array, effect: str, values: dict[str, float]) -> float:
    """R of an effect: rms of the whitened residual of the base, fitted to what the arm with the effect does.

    A fit may end beside the best one: the first order's R, where it is smaller, stands instead.
    """
    parameters = problem.parameters.copy()
    for name, value in values.items():
        parameters[parameter_index(effect, name)] = value
    start = np.concatenate([problem.parameters[problem.rows()], nuisances])
    (experiment,) = problem.experiments
    observation = experiment.observation
    assert isinstance(observation, ShapeObservation)
    rows = replace(problem, parameters=parameters).residuals(start[:, None])[1][0][:, :, 0]
    # What the arm with the effect shows, as if it had been measured without noise.
    shown = observation.coefficients - np.einsum("tkl,tl->tk", np.linalg.pinv(observation.root), rows)
    measured = replace(experiment, observation=replace(observation, coefficients=shown))
    # From several starts: a large effect may be taken up by a base far from the true one.
    starts = (
        start[:3, None] * np.array([(E, eta, 1.0) for E in (0.6, 0.8, 1.0, 1.25, 1.6, 2.2) for eta in (1.0, 5.0)]).T
    )
    fitted = fit_multistart(replace(problem, experiments=(measured,)), (nuisances,), starts)
    left = float(np.sqrt(np.mean(fitted.residuals[0][experiment.used] ** 2)))
    return min(left, float(visible_size(problem, nuisances, effect, [values])[0]))


def sized(model: Model, design: Design, noise: float) -> tuple[dict[str, Any], list[float]]:
    """The hidden effects' parameters, and the R that each has [noise sigmas]; NaN for those outside the catalogue,
    which the maker sizes itself so that the midline moves by 6 to 15 sigmas."""
    random = np.random.default_rng([design.seed, 1])
    hidden: dict[str, Any] = {}
    reached: list[float] = []
    for effect, wanted in zip(design.effects, design.r, strict=True):
        if not is_catalogued(effect):
            hidden[effect] = "visible"
            reached.append(float("nan"))
            continue
        drawn = typical(effect, model, random)
        largest = max(abs(drawn[name]) for name in SCALED[effect])
        factors = FACTORS[FACTORS * largest <= LARGEST.get(effect, np.inf)]
        problem, nuisances = _bare_problem(model, design, noise)
        sizes = visible_size(problem, nuisances, effect, [scaled(effect, drawn, float(f)) for f in factors])
        usable = sizes < 1e3  # a simulation that ran away counts as 1e6
        factors, sizes = factors[usable], np.maximum.accumulate(np.maximum(sizes[usable], 1e-12))
        factor = float(np.exp(np.interp(np.log(wanted), np.log(sizes), np.log(factors))))
        # To first order the base absorbs too little of a large effect: correct by what a real refit leaves.
        for _ in range(CORRECTIONS):
            hidden[effect] = scaled(effect, drawn, factor)
            size = refitted_size(problem, nuisances, effect, hidden[effect])
            if abs(np.log(size / wanted)) < CLOSE:
                break
            factor = float(np.clip(factor * np.clip(wanted / size, 0.2, 5.0), factors[0], factors[-1]))
        hidden[effect] = scaled(effect, drawn, factor)
        reached.append(refitted_size(problem, nuisances, effect, hidden[effect]))
    return hidden, reached


def trial_recording(design: Design) -> tuple[Recording, dict[str, Any]]:
    """The recording, its name and declaration without a hint, and its sealed truth as plain data.

    InputError where the arm cannot follow the motion.
    """
    model = design.model()
    noise = VIDEO_NOISE if design.seen == "video" else design.noise
    hidden, reached = sized(model, design, noise)
    name = f"trial_{design.index:04d}"
    recording, truth = make(
        hidden, model, design.waveform(), design.seed, design.duration, design.fps, Noise(midline=noise), name=name
    )
    if design.seen == "video":
        recording = _filmed(recording, model, design, truth["effects"])
        reached = _tracked_size(recording, model, design, truth["effects"])
    return recording, {"kind": design.kind, "r": reached, **truth}


def _tracked_size(
    recording: Recording, model: Model, design: Design, hidden: dict[str, dict[str, float]]
) -> list[float]:
    """R of each effect by the covariance that the tracker states; NaN outside the catalogue."""
    track = recording.shape
    assert track is not None
    observation = from_track(track, design.waveform()(track.t)[0], model.specimen.length)
    seen = np.flatnonzero(observation.seen)
    if not seen.size:
        return [0.0 for _ in hidden]
    problem, nuisances = _bare_problem(model, design, VIDEO_NOISE, observation.root[seen[seen.size // 2]])
    sizes = []
    for effect, values in hidden.items():
        known = is_catalogued(effect)
        sizes.append(refitted_size(problem, nuisances, effect, values) if known else float("nan"))
    return sizes


def _filmed(recording: Recording, model: Model, design: Design, hidden: dict[str, dict[str, float]]) -> Recording:
    """The same run as a camera saw it: rendered without the midline's noise, tracked, the midline left out."""
    from vision.encode import write_video
    from vision.looks import LOOKS
    from vision.render import render
    from vision.track import track

    assert recording.midline is not None
    assert recording.motor is not None
    scene = Scene(model, design.waveform(), design.duration, design.fps, recording.midline.s, DEFAULT_LINKS, None, None)
    exact = replace(recording.midline, xy=seen_midline(scene, hidden))
    scale = model.specimen.length / (0.62 * PICTURE[1])
    camera = Camera(design.fps, scale, (0.5 * PICTURE[0], 0.16 * PICTURE[1]), (0.0, 1.0), exposure=0.002)
    declaration = replace(recording.declaration, camera=camera)
    look = LOOKS[("clean", "uneven", "bubbles")[design.index % 3]]
    frames = render(exact, model.specimen, camera, PICTURE, look, design.seed, recording.motor.angle)
    with tempfile.TemporaryDirectory(prefix="tentacle-trial-") as folder:
        file = Path(folder) / "video.mp4"
        write_video(file, frames, exact.t)
        shape = track(file, declaration, recording.motor)
    return replace(recording, declaration=declaration, midline=None, shape=shape)

"""A blind trial's recording in a plant, as points or as a tracked video, and the size R of its hidden effects."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from affine_model.curvature import Array
from inference.measured_shapes import Tracker, fit_shapes, from_track
from inference.observation import POSE
from inference.trajectory import Problem
from tentacle.io.model_file import model_tables
from tentacle.model import Estimate, Model
from tentacle.recording import Camera, Recording
from tentacle.signals import Midline
from validation.plants import PLANTS, Plant, Shown, Trial, recorded, shown, truth_of
from validation.plants.draw import SETTLED
from validation.plants.filmed import PLACES, declaration_of, film
from validation.plants.repeats import repeated, with_own_laws
from validation.trials.design import Design
from validation.trials.plant_design import FRAME_RATE, MOVES, PlantDesign
from validation.trials.sight import Measurement
from validation.trials.sizing import bare_problem, left_by_refit

PICTURE = (960, 540)
SAMPLED_AT = 100.0  # samples/s of the base motion
AFTER = 1.5  # s of it beyond the last frame


def plant_recording(design: PlantDesign) -> tuple[Recording, dict[str, Any]]:
    """The recording, its name and declaration without a hint, and its sealed truth as plain data.

    The truth has the R of each hidden effect by itself: rms of the whitened residual after refitting the base.
    FloatingPointError where the plant runs away.
    """
    trial, plant = arm_of_trial(design)
    run = shown(trial, plant)
    recording = _seen(design, trial, run)
    root = _middling_root(recording, run) if design.seen == "video" else None
    recording = replace(recording, name=f"trial_{design.index:04d}")
    unseen = design.seen == "video" and root is None
    reached = [0.0 for _ in run.hidden] if unseen else _sizes(design, trial, plant, run, root)
    truth = {"kind": design.kind, "r": reached, "plant": design.plant, **truth_of(trial, plant, run)}
    return recording, truth


def plant_baseline(design: PlantDesign) -> list[Recording]:
    """The recording of the same arm on another day, with nothing hidden; none where the arm has no own laws."""
    if not design.own:
        return []
    trial, plant = arm_of_trial(design)
    other = repeated(trial)
    recording = _seen(design, other, shown(other, plant))
    return [replace(recording, name=f"baseline_{design.index:04d}")]


@lru_cache(maxsize=1)  # of a trial's recording and its baseline: the sizes of own laws take several runs
def arm_of_trial(design: PlantDesign) -> tuple[Trial, Plant]:
    """The trial, with the arm's own laws, and its plant."""
    trial = design.trial()
    plant = PLANTS[design.plant](trial)
    return (with_own_laws(trial, plant, design.own, MOVES) if design.own else trial), plant


def _seen(design: PlantDesign, trial: Trial, run: Shown) -> Recording:
    """The run as the design has it: as points of the midline, or as a tracked video."""
    recording = recorded(trial, run)
    return _tracked(recording, run, design) if design.seen == "video" else recording


def _tracked(recording: Recording, run: Shown, design: PlantDesign) -> Recording:
    """The same run as a video: rendered without the midline's noise, tracked, and without the midline."""
    from vision.encode import write_video
    from vision.looks import LOOKS
    from vision.render import RenderSettings, render
    from vision.track import track

    assert recording.motor is not None
    specimen = recording.declaration.specimen
    exact = Midline(run.t, PLACES, run.xy, np.full(run.xy.shape[:2], np.nan))
    scale = specimen.length / (0.62 * PICTURE[1])
    camera = Camera(FRAME_RATE, scale, (0.5 * PICTURE[0], 0.16 * PICTURE[1]), (0.0, 1.0), exposure=0.002)
    declaration = replace(recording.declaration, camera=camera)
    look = LOOKS[("clean", "uneven", "bubbles")[design.index % 3]]
    frames = render(exact, specimen, camera, RenderSettings(PICTURE, look, design.seed), recording.motor.angle)
    with tempfile.TemporaryDirectory(prefix="tentacle-trial-") as folder:
        file = Path(folder) / "video.mp4"
        write_video(file, frames, exact.t)
        shape = track(file, declaration, recording.motor)
    return replace(recording, declaration=declaration, midline=None, shape=shape)


def _middling_root(recording: Recording, run: Shown) -> Array | None:
    """Root (K, K) that whitens the middle one of the accepted frames; None where none is accepted."""
    track = recording.shape
    assert track is not None
    theta = np.interp(track.t, run.t, run.command)
    observation = from_track(track, theta, recording.declaration.specimen.length)
    seen = np.flatnonzero(observation.seen)
    return observation.root[seen[seen.size // 2]] if seen.size else None


def _sizes(design: PlantDesign, trial: Trial, plant: Plant, run: Shown, root: Array | None) -> list[float]:
    """R of each hidden effect [noise sigmas]: the base is refitted to the change of the picture by this
    effect alone.
    """
    if not run.hidden:
        return []
    problem, nuisances = sizing_problem(design, trial, root)
    bare, sizes = whitened_shapes(problem, trial, run, run.bare), []
    for one in run.hidden:
        xy = run.xy if len(run.hidden) == 1 else film(trial, plant, (one,))[0]
        sizes.append(left_by_refit(problem, nuisances, bare - whitened_shapes(problem, trial, run, xy)))
    return sizes


def sizing_problem(design: PlantDesign, trial: Trial, root: Array | None = None) -> tuple[Problem, Array]:
    """The trial's bare arm in the reduced model, seen without noise, and its nuisances; root (K, K): of a track."""
    return bare_problem(_as_model(design, trial), root)


def whitened_shapes(problem: Problem, trial: Trial, run: Shown, xy: Array) -> Array:
    """Whitened shapes (T, K) of a midline (F, P, 2) [m] with the run's frames, at the problem's times."""
    (experiment,) = problem.experiments
    observation = experiment.observation.shapes
    assert observation is not None
    frames = np.rint(observation.t * FRAME_RATE).astype(int)
    theta, length, order = run.command[frames], trial.arm["length"], observation.coefficients.shape[1] - POSE
    tracker = Tracker(trial.sigma, by_edges=observation.tracked)
    points = Midline(observation.t, PLACES, xy[frames], np.full((frames.size, PLACES.size), trial.sigma))
    seen = fit_shapes(points, theta, length, order, tracker)
    return np.einsum("tkl,tl->tk", observation.root, seen.coefficients)


def _as_model(design: PlantDesign, trial: Trial) -> Design:
    """The plant's arm and motion in the reduced model, without hidden effects."""
    arm, declared = trial.arm, declaration_of(trial)
    parameters = {
        "elasticity": {"E": Estimate.exact(arm["E"], "Pa")},
        "damping": {"eta": Estimate.exact(arm["eta"], "Pa s")},
        "drag": {"C_perp": Estimate.exact(arm["C_perp"])},
    }
    model = Model(declared.specimen, declared.fluid, declared.gravity, parameters=parameters)
    t = np.arange(-SETTLED, design.seconds + AFTER, 1.0 / SAMPLED_AT)
    motion = {"kind": "samples", "t_s": t.tolist(), "angle_rad": trial.theta(t + SETTLED).tolist()}
    sight = Measurement(design.seen, design.sigma, s=tuple(PLACES.tolist()))
    head = (design.index, design.seed, design.kind, (), ())
    return Design(*head, sight, design.seconds, FRAME_RATE, model_tables(model), motion)

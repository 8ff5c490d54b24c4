"""A fitted model beside the measurement, point by point, and the errors that verdict.json states."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from affine_model.camera import sight_of
from affine_model.curvature import Array, angle_basis, legendre_to_monomial, midline
from affine_model.points_beside import points_beside
from inference.experiment import Experiment, predict
from inference.fit import Fit
from inference.measured_shapes import SHAPE_NODES, angle_sensitivity, basis_at_nodes
from inference.observation import POSE, Observation, ShapeObservation
from inference.prepare import Prepared
from inference.trajectory import Problem
from tentacle.diagnosis import ErrorMeasure, RunComparison, SensorComparison

ANGLE_ORDER = 3  # coordinates of the shape whose tangent angle is compared
COMPARED_PLACES = np.linspace(0.0, 1.0, 21)  # where a tracked video's midline is compared


@dataclass(frozen=True)
class ModelRun:
    """One model at one recording's frames: points (T, P, 2) [m], the paper's q (T, 2), tangent angle (T, P), load (T,)
    [N], and what sensors read, up to a constant (T, G).
    """

    points: Array
    q: Array
    angle: Array
    load: Array | None
    read: Array


def restricted(observation: ShapeObservation, coefficients: Array, order: int) -> Array:
    """z (T, order): the clamped shape of `order` coordinates that is nearest to the given coefficients (T, K).

    The distance is that of the measurement's covariance. With order 2 this is the paper's fit of (q1, q2) to a contour.
    Model and measurement are both reduced in this way, so a third coordinate adds the same bias to both (a small q3
    adds (-5/56, +3/4) q3).
    """
    root = observation.root
    columns = root[:, :, POSE : POSE + order]
    target = np.einsum("tkl,tl->tk", root, coefficients)
    normal = np.einsum("tkj,tkl->tjl", columns, columns)
    unseen = ~observation.seen
    normal[unseen] = np.eye(order)
    z = np.linalg.solve(normal, np.einsum("tkj,tk->tj", columns, target)[..., None])[..., 0]
    z[unseen] = np.nan
    return z


def _deviation(observation: ShapeObservation, gain: Array, order: int) -> Array:
    """Square root (T, order, order) of the covariance of `restricted`."""
    return _root_of_covariance(observation, gain, list(range(POSE, POSE + order)))


def _root_of_covariance(observation: ShapeObservation, gain: Array, kept: list[int]) -> Array:
    """Square root (T, k, k) of the covariance of k of the coefficients, the others held."""
    columns = observation.root[:, :, kept] / gain[:, None]
    normal = np.einsum("tkj,tkl->tjl", columns, columns)
    normal[~observation.seen] = np.eye(len(kept))
    return np.swapaxes(np.linalg.inv(np.linalg.cholesky(normal)), 1, 2)


def points_deviation(observation: ShapeObservation, frames: NDArray[np.intp], gain: Array, s: Array) -> Array:
    """How far (F, P) [m] a track's points err at these frames: across the arm by its root's angle and its shape, and
    along it by its one scale. Of the scale's difference from the declared one as much as its deviation is an error.
    """
    sparse = replace(observation, root=observation.root[frames])
    kept = [0, *range(POSE, POSE + observation.order)]
    shown, angle = observation.coefficients[frames], observation.theta[frames]
    q = shown[:, POSE:] @ legendre_to_monomial(observation.order).T
    # A frame knows its points far better than each coordinate: only the slopes at its own shape keep that.
    basis = np.column_stack([np.ones(SHAPE_NODES), basis_at_nodes(observation.order)])
    slopes = angle_sensitivity(q, angle + shown[:, 0], observation.length, s, basis)
    across = np.linalg.norm(slopes @ _root_of_covariance(sparse, gain, kept)[:, None], axis=(2, 3))
    told = float(np.sum(observation.root[:, 3, 3] ** 2))  # of the recording's one scale, spread over its frames
    apart = float(np.abs(observation.coefficients[observation.seen, 3]).max(initial=0.0))
    return np.hypot(across, observation.length * s * (min(apart, told**-0.5) if told > 0.0 else 0.0))


def measured_points(prepared: Prepared) -> tuple[Array, Array]:
    """s (P,) and measured points (T, P, 2) [m]; NaN where a frame or point was not seen."""
    observation, recording = prepared.experiment.observation, prepared.recording
    if recording.midline is not None and prepared.points is not None:
        return recording.midline.s, np.where(observation.seen[:, None, None], prepared.points, np.nan)
    return observation.points(COMPARED_PLACES)


def model_run(problem: Problem, fitted: Fit, place: int, s: Array, d: Array | None) -> ModelRun:
    """The run of a fitted model for recording number `place`."""
    problem, parameters = problem.known(fitted.parameters)
    experiment = problem.experiments[place]
    if experiment.observation.beside is not None:  # markers: where the fit finds them, not where they were declared
        s, d = experiment.observation.points(s)[0], experiment.observation.beside
    nuisances = fitted.nuisances[place][:, None]
    prediction = predict(problem.arm, experiment, parameters[:, None], nuisances, problem.step)
    sight = sight_of(parameters)
    scale = 1.0 + sight.excess
    q, theta = prediction.q[:, :, 0], prediction.theta[:, 0] + sight.roll
    length = experiment.arm(problem.arm).specimen.length
    shape = midline(q, theta, length, s) if d is None else points_beside(q, theta, length, s, d, prediction.shear)
    points = scale * shape + prediction.shift[:, 0]
    z = q @ problem.arm.from_monomial.T
    q_shown, angle = np.full((z.shape[0], 2), np.nan), np.full((z.shape[0], s.size), np.nan)
    observation = experiment.observation.shapes
    if observation is not None:
        coefficients = np.zeros_like(observation.coefficients)
        kept = min(problem.arm.order, observation.order)
        coefficients[:, 0] = theta - observation.theta
        coefficients[:, 1:3] = prediction.shift[:, 0]
        coefficients[:, 3] = np.log(scale)
        coefficients[:, POSE : POSE + kept] = z[:, :kept]
        q_shown, angle = reduced_shape(observation, coefficients, s)
    batch = prediction.batch
    load = np.interp(experiment.observation.t, batch.force_t, batch.load[:, 0])
    return ModelRun(points, q_shown, angle, load, experiment.observation.read(prediction)[:, :, 0])


def reduced_shape(observation: ShapeObservation, coefficients: Array, s: Array) -> tuple[Array, Array]:
    """The paper's q (T, 2) and the tangent angle (T, P) of coefficients, both by `restricted`."""
    q = restricted(observation, coefficients, 2) @ legendre_to_monomial(2).T
    order = min(ANGLE_ORDER, observation.order)
    return q, observation.theta[:, None] + restricted(observation, coefficients, order) @ angle_basis(order, s).T


def judged_frames(experiment: Experiment, held_out: bool) -> np.ndarray:
    """Frames on which errors are stated: the stretches that were not fitted (or, without any, all frames that were).

    A stretch without any seen frame is none: there are the frames that were left out of the fit as misread.
    """
    if not held_out:
        return experiment.used
    times = experiment.observation.t
    first = times[experiment.used].min() if experiment.used.any() else times[0]
    begin = experiment.t0 if experiment.release is None else experiment.release
    kept = (times >= first) & (times <= begin + experiment.duration) & ~experiment.used
    stretch = np.cumsum(np.diff(kept.astype(int), prepend=0) == 1)  # counted from 1
    shown = np.bincount(stretch, weights=kept & experiment.observation.seen) > 0
    return kept & shown[stretch]


def run_comparison(
    prepared: Prepared, place: int, base: tuple[Problem, Fit], final: tuple[Problem, Fit], held_out: bool
) -> tuple[RunComparison, ModelRun, ModelRun]:
    """One recording beside both models."""
    experiment = prepared.experiment
    observation = experiment.observation
    s, points = measured_points(prepared)
    d = observation.beside
    first, last = model_run(*base, place, s, d), model_run(*final, place, s, d)
    q = np.full((observation.t.size, 2), np.nan)
    if observation.shapes is not None:
        q, _ = reduced_shape(observation.shapes, observation.shapes.coefficients, s)
    run = RunComparison(
        name=experiment.name,
        t=observation.t,
        s=s,
        measured=points,
        base=first.points,
        augmented=last.points,
        q_measured=q,
        q_base=first.q,
        q_augmented=last.q,
        judged=judged_frames(experiment, held_out),
        theta=observation.theta,
        points="midline" if d is None else "markers",
        thrust_base=first.load,
        thrust_augmented=last.load,
        sensors=_sensors(observation, first, last),
    )
    return run, first, last


def _sensors(observation: Observation, first: ModelRun, last: ModelRun) -> tuple[SensorComparison, ...]:
    """What sensors read, and what two models say: each about its own mean, as a sensor's zero is not known.

    All three are NaN where no reading counts: a model's acceleration jumps at the ends of the log.
    """
    there = np.isfinite(observation.readings)
    counted = [np.where(there, values, np.nan) for values in (observation.readings, first.read, last.read)]
    read = [values - np.nanmean(values, axis=0) for values in counted]
    return tuple(
        SensorComparison(sensor.name, sensor.quantity, *(values[:, k] for values in read))
        for k, sensor in enumerate(observation.sensors)
    )


def _rms(parts: list[Array]) -> float | None:
    values = np.concatenate([part[np.isfinite(part)].ravel() for part in parts]) if parts else np.zeros(0)
    return float(np.sqrt(np.mean(values**2))) if values.size else None


def run_errors(
    runs: list[tuple[RunComparison, ModelRun, ModelRun]], prepared: list[Prepared], *, augmented: bool
) -> ErrorMeasure:
    """The rms errors of one model over the judged frames of all recordings."""
    distance, angle, first, second, thrust = [], [], [], [], []
    for (run, base, final), source in zip(runs, prepared, strict=True):
        model, points = (final, run.augmented) if augmented else (base, run.base)
        chosen = run.judged
        distance.append(1e3 * np.linalg.norm(run.measured - points, axis=2)[chosen])
        observation = source.experiment.observation.shapes
        if observation is not None:
            _, seen_angle = reduced_shape(observation, observation.coefficients, run.s)
            valid = chosen & observation.seen
            angle.append((seen_angle - model.angle)[valid])
            first.append((run.q_measured - model.q)[valid, 0])
            second.append((run.q_measured - model.q)[valid, 1])
        cell = source.recording.load_cell
        if cell is not None and model.load is not None:
            begin, end = run.t[chosen].min(initial=np.inf), run.t[chosen].max(initial=-np.inf)
            inside = (cell.t >= begin) & (cell.t <= end)
            if inside.sum() > 10:
                error = cell.thrust[inside] - np.interp(cell.t[inside], run.t, model.load)
                thrust.append(error - error.mean())  # the cell is tared: only changes count
    return ErrorMeasure(_rms(distance), _rms(angle), _rms(first), _rms(second), _rms(thrust))


def midline_error(prepared: list[Prepared], problem: Problem, fitted: Fit, held_out: bool) -> float | None:
    """rms distance [mm] of one model from what was measured, over the judged frames of all recordings."""
    distance = []
    for place, source in enumerate(prepared):
        s, points = measured_points(source)
        shown = model_run(problem, fitted, place, s, source.experiment.observation.beside)
        judged = judged_frames(source.experiment, held_out)
        distance.append(1e3 * np.linalg.norm(points - shown.points, axis=2)[judged])
    return _rms(distance)


def floor_errors(
    runs: list[tuple[RunComparison, ModelRun, ModelRun]], prepared: list[Prepared], reduction_mm: float
) -> ErrorMeasure:
    """The same measures for the noise that was found together with the error of the reduction."""
    distance, angle, first, second = [], [], [], []
    for (run, _, _), source in zip(runs, prepared, strict=True):
        experiment = source.experiment
        observation = experiment.observation.shapes
        gain = float(np.sqrt(np.mean(experiment.picture_gain**2)))
        if observation is None:
            distance.append(np.full(10, 1e3 * np.sqrt(2.0) * source.sigma * gain))
            continue
        frames = np.flatnonzero(run.judged & observation.seen)
        frames = frames[:: max(1, frames.size // 50)]
        data = source.recording.midline
        sparse = replace(observation, root=observation.root[frames])
        two = _deviation(sparse, experiment.picture_gain, 2)
        q = np.linalg.norm(legendre_to_monomial(2) @ two, axis=2)
        first.append(q[:, 0])
        second.append(q[:, 1])
        order = min(ANGLE_ORDER, observation.order)
        several = _deviation(sparse, experiment.picture_gain, order)
        angle.append(np.linalg.norm(angle_basis(order, run.s) @ several, axis=2))
        if data is not None:
            stated = data.sigma[frames]
            distance.append(1e3 * np.sqrt(2.0) * gain * np.where(np.isfinite(stated), stated, source.sigma))
        else:
            # The median frame's: a hidden tip may err without limit, and a mean would be of those frames alone.
            errs = points_deviation(observation, frames, experiment.picture_gain, run.s)
            distance.append(1e3 * (np.median(errs, axis=0) if frames.size else errs.ravel()))
    noise = _rms(distance)
    total = None if noise is None else float(np.hypot(noise, reduction_mm))
    return ErrorMeasure(total, _rms(angle), _rms(first), _rms(second), None)

"""The properties that blind trials share with a recording: arm, motion, frames, and the noise of the measurement."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from affine_model.curvature import Array, midline
from inference.base_fit import Setting, fit_base, needed_order
from inference.experiment import Experiment
from inference.fit import Fit
from inference.observation import ShapeObservation
from inference.prepare import CannotTellError, Prepared, prepare
from inference.trajectory import Problem
from tentacle.base_motion import HeldOutside
from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.recording import Recording
from tentacle.signals import ShapeTrack
from tentacle.waveform import Waveform
from validation.trials.own_errors import own_errors
from validation.trials.sight import EVERYWHERE, Measurement, track_noise

LEAST_BASE_TURN = 0.02  # rad: a base that turns by less counts as not moving
BEFORE, AFTER = 2.5, 1.5  # s of motion before the first and after the last frame: a run begins while the arm moves
SAMPLED_AT = 100.0  # samples/s of the base motion, about 20 a period of the fastest that a servo swings
DRAWS = 200  # random draws of a track's noise
UNITS = {"E": "Pa", "eta": "Pa s", "k0": "N m/rad", "k1": "N m/rad", "d0": "N m s/rad", "d1": "N m s/rad"}


@dataclass(frozen=True)
class RealParts:
    """Parts of trials that are real (paths of recordings): whose own errors are the noise, and the baseline."""

    errors_of: str = ""
    baseline: tuple[str, ...] = ()


@dataclass(frozen=True)
class Likeness:
    """A recording's arm with the base parameters that fit it best; motion of the base as a waveform's table; duration
    [s], fps [1/s], sight; and of a free decay the shape that it was let go from, initial_q [rad], and when, release_t
    [s]. real: what of its trials is not simulated.
    """

    model: Model
    motion: dict[str, Any]
    duration: float
    fps: float
    sight: Measurement
    initial_q: tuple[float, ...] | None = None
    release_t: float | None = None
    real: RealParts = RealParts()


def likeness(recording: Recording, with_own_errors: bool = False) -> Likeness:
    """The properties that trials like this recording share with it.

    The declared model is fitted without further effects; the noise is that of this fit, or, with its own errors, as
    large as they are. Raises InputError where the recording shows too little, or where neither the base moves nor a
    release is declared.
    """
    prepared, problem, fitted = declared_fit(recording)
    (experiment,) = problem.experiments
    seen = experiment.observation.t[experiment.used]
    first, last = float(seen[0]), float(seen[-1])
    interval = float(np.median(np.diff(experiment.observation.t)))
    arm, declared = problem.arm, recording.declaration
    parameters: dict[str, dict[str, Estimate]] = {}
    for (effect, name), value in zip(fitted.free, fitted.values, strict=True):
        parameters.setdefault(effect, {})[name] = Estimate.exact(float(value), UNITS.get(name, "1"))
    sight = measurement_of(prepared, experiment, interval)
    if with_own_errors:
        sight = replace(sight, noise=own_errors(prepared, problem, fitted).rms)
    found = Likeness(
        model=Model(declared.specimen, declared.fluid, declared.gravity, 2, parameters),
        motion={"kind": "rest", "angle_rad": float(experiment.base(seen)[0][0])}
        if experiment.release is not None
        else sampled_motion(experiment.base, first, last),
        duration=last - first,
        fps=1.0 / interval,
        sight=sight,
    )
    if experiment.release is None:
        return found
    start = arm.to_monomial @ experiment.parts(arm.order, fitted.nuisances[0])[0]
    return replace(found, initial_q=tuple(map(float, start)), release_t=experiment.release - first)


def declared_fit(recording: Recording) -> tuple[Prepared, Problem, Fit]:
    """The declared model, fitted to a recording that trials can be like; InputError where there can be none."""
    try:
        prepared = prepare(recording, hold_out=False)
    except CannotTellError as reason:
        raise InputError(str(reason), field="--like", expected="a recording that can be diagnosed") from None
    experiment = prepared.experiment
    seen = experiment.observation.t[experiment.used]
    theta = experiment.base(seen)[0]
    released = experiment.release is not None
    if not released and np.ptp(theta) < LEAST_BASE_TURN:
        raise InputError(
            f"the base of {recording.name} turns by {np.ptp(theta):.2g} rad, and no release is declared",
            field="--like",
            expected=f"a motor log that moves by {LEAST_BASE_TURN:g} rad, or release_t",
        )
    if released and np.ptp(theta) > LEAST_BASE_TURN:
        raise InputError(
            f"{recording.name} is let go on a base that turns by {np.ptp(theta):.2g} rad",
            field="--like",
            expected="a base that moves, or a release at rest",
        )
    setting = Setting(recording.declaration, (experiment,), 2)
    return prepared, *fit_base(setting, needed_order(setting))


def sampled_motion(base: Waveform, first: float, last: float) -> dict[str, Any]:
    """A base motion as samples whose time counts from the first frame.

    During the servo's log it is known. Before and after, it is the log's point reflection about its ends, so that angle
    and rate are continuous.
    """
    known = (base.first, base.last) if isinstance(base, HeldOutside) else (first, last)
    t = np.arange(first - BEFORE, last + AFTER, 1.0 / SAMPLED_AT)
    inside = np.clip(t, *known)
    mirrored = np.clip(2.0 * inside - t, *known)
    angle = 2.0 * base(inside)[0] - base(mirrored)[0]
    return {"kind": "samples", "t_s": (t - first).tolist(), "angle_rad": angle.tolist()}


def measurement_of(prepared: Prepared, experiment: Experiment, interval: float) -> Measurement:
    """The measurement of a recording: the noise that it states, and the noise that the fit found."""
    recording, observation = prepared.recording, experiment.observation
    gain = float(np.median(experiment.picture_gain))
    angle_noise = _angle_noise(recording, experiment, interval)
    if observation.beside is not None:
        places = tuple(observation.points(np.zeros(0))[0].tolist()), tuple(observation.beside.tolist())
        return Measurement("markers", gain * prepared.sigma, None, *places, angle_noise=angle_noise)
    if recording.midline is None:
        assert recording.shape is not None
        assert observation.shapes is not None
        return _track_sight(recording.shape, observation.shapes, experiment.picture_gain, angle_noise)
    stated = recording.midline.sigma[np.isfinite(recording.midline.sigma)]
    places = tuple(map(float, recording.midline.s))
    sigma = float(np.median(stated)) if stated.size else prepared.sigma
    return Measurement("midline", gain * sigma, sigma if stated.size else None, places, angle_noise=angle_noise)


def _angle_noise(recording: Recording, experiment: Experiment, interval: float) -> float:
    """Noise of the servo's log if it is sampled once a frame: smaller than that of one sample if there are more
    samples.
    """
    base = experiment.base
    if recording.motor is None or not isinstance(base, HeldOutside):
        return 0.0
    between = float(np.median(np.diff(recording.motor.t)))
    return base.motion.noise * float(np.sqrt(min(between / interval, 1.0)))


def _track_sight(track: ShapeTrack, observation: ShapeObservation, gain: Array, angle_noise: float) -> Measurement:
    """A track with the covariance of its median frame; shift and scale are stated once and have no gain."""
    stated = track.measured().covariance[observation.seen]
    covariance = stated[np.argsort(np.linalg.slogdet(stated)[1])[len(stated) // 2]]
    kept = np.array([0, *range(gain.size - covariance.shape[0] + 1, gain.size)])
    scale_sigma = float(track.scale_sigma)
    drawn = Measurement(
        "track",
        0.0,
        angle_noise=angle_noise,
        covariance=tuple(tuple(row) for row in covariance.tolist()),
        gain=tuple(gain[kept].tolist()),
        scale_sigma=scale_sigma if np.isfinite(scale_sigma) and scale_sigma > 0.0 else None,
    )
    s, random = np.array(EVERYWHERE), np.random.default_rng(0)
    errors = track_noise(drawn, DRAWS, random)
    points = midline(errors[:, 1:], errors[:, 0], observation.length, s)
    straight = midline(np.zeros((1, errors.shape[1] - 1)), np.zeros(1), observation.length, s)
    # A track has few coefficients, which follow only a part of the noise of many points.
    share = errors.shape[1] / s.size
    return replace(drawn, noise=float(np.sqrt(np.mean((points - straight)[..., 0] ** 2) / share)))

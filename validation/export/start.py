"""The reduced model beside a recording, and its initial state: least squares over initial shape, rates and the clamp's
shift.

    minimise sum_t,p |y(t, s_p) - x(t, s_p; q(0), q'(0)) - shift|^2 + sigma^2 sum_i (c(s_i)^2 / b^2 + c'(s_i)^2 / r^2)

with all other numbers from the model. The second sum is a Gaussian prior on the first curvature c and its rate c' at
the order's Gauss points: without it, the rates of shapes that die within a frame are free, and the fit of many
coordinates starts at 1e5 rad/s, which no other discretisation follows.

An export starts in the same state, so that the difference of the errors comes from the export alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from affine_model.arm import arm_of, parameter_vector
from affine_model.base_signal import Steps, base_table, has_servo_effects, step_middles
from affine_model.camera import sight_of
from affine_model.points_beside import points_beside
from affine_model.simulate import Start, Timing, simulate
from tentacle.base_motion import BaseMotion, fit_base_motion
from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.recording import Recording
from tentacle.signals import Array
from tentacle.waveform import Waveform
from validation.export.seen import ObservedPoints, observed_points

REDUCED_STEP = 1.0 / 600.0  # s, of ours
LAST_FRAME_MARGIN = 0.05  # s simulated beyond the last frame
NOISE_MM = 0.2  # sigma, of a usual camera: it says only how little the prior weighs
USUAL_BEND, USUAL_RATE = 1.0, 10.0  # rad, rad/s; b and r, of curvature over the whole arm
STATE_NUDGE = 1e-4  # rad, rad/s; of the differences that give the derivatives


@dataclass(frozen=True)
class Started:
    """A recording and the state in which its simulation starts.

    t (T,) [s]: times at which the arm is as the frames show it, after `start` [s]; q, q_rate (n,) [rad, rad/s]; shift
    (2,) [m]; base: the clamp's motion after servo lag and play; error_mm: of the reduced model, rms over points and
    frames; converged: whether the fit of the start converged.
    """

    seen: ObservedPoints
    t: Array
    start: float
    stop: float
    q: Array
    q_rate: Array
    shift: Array
    base: Waveform
    error_mm: float
    converged: bool


def as_camera_has_it(model: Model, xy: Array, shift: Array) -> Array:
    """Points (..., 2) [m] of the arm as the camera shows them: scaled, rolled, shifted."""
    sight = sight_of(parameter_vector(model))
    turn = np.array([[np.cos(sight.roll), -np.sin(sight.roll)], [np.sin(sight.roll), np.cos(sight.roll)]])
    return (1.0 + sight.excess) * xy @ turn.T + shift + model.specimen.length * np.array(sight.shift)


def distance_mm(shown: Array, points: Array) -> float:
    """Root mean square distance [mm] over the points that were seen."""
    squares = np.sum((shown - points) ** 2, axis=-1)
    return 1e3 * float(np.sqrt(np.nanmean(squares)))


def start_of(model: Model, recording: Recording) -> Started:
    """Fit the start of a recording under a model. InputError where it shows no arm, or the model cannot be run."""
    shown = observed_points(recording)
    parameters = parameter_vector(model)
    release = recording.declaration.release_t
    t = sight_of(parameters).shown_times(shown.t)
    start = float(t[0]) if release is None else release
    keep = (t >= start) & np.isfinite(shown.xy).any(axis=(1, 2))
    if keep.sum() < 3:
        raise InputError("shows the arm in fewer than 3 frames", field=recording.name)
    shown = replace(shown, t=shown.t[keep], xy=shown.xy[keep])
    t = t[keep]
    base = _clamp(recording, model, start, float(t[-1]))
    run = _Ours(model, shown, t, start, base, moving=release is None)
    unknowns = np.zeros(run.size)
    unknowns[: model.order] = _first_shape(model, shown, float(base(start)[0]))
    slope: Any = run.jacobian  # scipy's types know no function here
    found = least_squares(run.residuals, unknowns, jac=slope, x_scale=run.scales, method="trf", max_nfev=30)
    q, q_rate, shift = run.parts(found.x)
    error = distance_mm(shown.xy, run.points(found.x[:, None])[..., 0])
    return Started(shown, t, start, float(t[-1]), q, q_rate, shift, base, error, bool(found.success))


def _first_shape(model: Model, shown: ObservedPoints, theta: float) -> Array:
    """The shape of the first frame, fitted to its points alone: a start for the fit of the run."""
    first = shown.xy[0]
    usable, arm = np.isfinite(first).all(axis=1), arm_of(model)

    def miss(q: Array) -> Array:
        places = (shown.s[usable], shown.d[usable], arm.askew)
        at = points_beside(q, theta + arm.root_turn(q), model.specimen.length, *places)
        return np.concatenate([((at - first[usable]) / model.specimen.length).ravel(), 1e-3 * q])

    return np.asarray(least_squares(miss, np.zeros(model.order)).x, dtype=float)


def _clamp(recording: Recording, model: Model, start: float, stop: float) -> Waveform:
    """theta(t) at the clamp: the measured angle, behind the servo's lag and play if the model has them."""
    parameters = parameter_vector(model)[:, None]
    if recording.motor is None:
        still = np.zeros(8)
        return _Table(np.linspace(start - 1.0, stop + 1.0, 8, dtype=np.float64), np.stack([still, still, still]))
    motion: BaseMotion = fit_base_motion(recording.motor)
    if not has_servo_effects(parameters):
        return motion
    steps = int(np.ceil((stop + LAST_FRAME_MARGIN - start) / REDUCED_STEP)) + 2
    table = base_table(motion, Steps(start - REDUCED_STEP, REDUCED_STEP, steps), parameters)[:, :, 0]
    return _Table(step_middles(start - REDUCED_STEP, REDUCED_STEP, steps), table)


@dataclass(frozen=True)
class _Table:
    """A motion as samples: t (N,), values (3, N) of angle, rate, acceleration; straight between them."""

    t: Array
    values: Array

    def __call__(self, t: object) -> Array:
        return np.stack([np.interp(np.asarray(t, dtype=float), self.t, row) for row in self.values])


class _Ours:
    """The reduced model under a recording's base motion, for many starts at once; unknowns: q(0), q'(0) if moving,
    shift.
    """

    def __init__(
        self, model: Model, shown: ObservedPoints, t: Array, start: float, base: Waveform, moving: bool
    ) -> None:
        self.model, self.shown, self.t, self.start, self.moving = model, shown, t, start, moving
        self.arm, self.parameters = arm_of(model), parameter_vector(model)
        steps = int(np.ceil((t[-1] + LAST_FRAME_MARGIN - start) / REDUCED_STEP))
        self.table = base(step_middles(start, REDUCED_STEP, steps))[:, :, None]
        n = model.order
        self.size = n * (1 + moving) + 2 * shown.camera
        powers = (0.5 * (np.polynomial.legendre.leggauss(n)[0] + 1.0))[:, None] ** np.arange(n)
        self.prior = np.zeros((n * (1 + moving), self.size))
        self.prior[:n, :n] = NOISE_MM / USUAL_BEND * powers
        if moving:
            self.prior[n:, n : 2 * n] = NOISE_MM / USUAL_RATE * powers
        self.scales = np.concatenate([np.full(n, 0.1), np.full(n * moving, 1.0), np.full(2 * shown.camera, 1e-3)])

    def parts(self, unknowns: Array) -> tuple[Array, Array, Array]:
        """q (n, ...), q_rate (n, ...), shift (2, ...)."""
        n = self.model.order
        rate = unknowns[n : 2 * n] if self.moving else np.zeros_like(unknowns[:n])
        shift = unknowns[-2:] if self.shown.camera else np.zeros_like(unknowns[:2])
        return unknowns[:n], rate, shift

    def points(self, unknowns: Array) -> Array:
        """Points (T, P, 2, B) as the camera shows them, for unknowns (U, B)."""
        q, rate, shift = self.parts(unknowns)
        count = unknowns.shape[1]
        run = simulate(
            self.arm,
            np.repeat(self.parameters[:, None], count, axis=1),
            self.table,
            Timing(REDUCED_STEP, 1),
            start=Start(q=q, q_rate=rate, t0=self.start),
        )
        place = np.clip((self.t - run.t[0]) / REDUCED_STEP, 0.0, len(run.t) - 1.001)
        index, share = place.astype(int), (place - place.astype(int))[:, None, None]
        bend = (1.0 - share) * run.q[index] + share * run.q[index + 1]
        theta = (1.0 - share[..., 0]) * run.theta[index] + share[..., 0] * run.theta[index + 1]
        theta = theta + self.arm.root_turn(bend, 1)
        length, places = self.model.specimen.length, (self.shown.s, self.shown.d, self.arm.askew)
        shown = [
            as_camera_has_it(self.model, points_beside(bend[..., b], theta[:, b], length, *places), shift[:, b])
            for b in range(count)
        ]
        return np.stack(shown, axis=-1)

    def residuals(self, unknowns: Array) -> Array:
        """Distances [mm] in both directions, 0 for points that were not seen; then the prior's."""
        miss = 1e3 * (self.points(unknowns[:, None])[..., 0] - self.shown.xy)
        return np.concatenate([np.nan_to_num(miss).ravel(), self.prior @ unknowns])

    def jacobian(self, unknowns: Array) -> Array:
        """Its derivatives by one batch of differences; 0 for points that were not seen."""
        steps = STATE_NUDGE * self.scales / 0.1
        points = self.points(np.concatenate([unknowns[:, None], unknowns[:, None] + np.diag(steps)], axis=1))
        slope = 1e3 * (points[..., 1:] - points[..., :1]) / steps
        slope[~np.isfinite(self.shown.xy)] = 0.0
        return np.concatenate([slope.reshape(-1, self.size), self.prior])

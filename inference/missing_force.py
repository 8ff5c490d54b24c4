"""The force that a fitted model misses: from the latent force's smoother, and how any force would move what is seen.

    M(u) u'' = F(u, u', t; parameters) + Q(t)            (eq. 8 with the missing force Q)

A Rauch-Tung-Striebel smoother with the latent force of inference.latent_force gives the motion u(t) from the measured
shapes and the model's own run. Q(t) is the force that the full equations need for this motion. A law B(u, u', t) with
strength a explains the data if the small motions d about u, driven by a B - Q, bring the model onto the observation:

    M d'' + D d' + K d = a B(t) + (dF/dp) dp - Q(t),        K = d(M u'' - F)/du,  D = -dF/du'

If the law is right, d is as small as the noise. The equation is then exact to first order in d, however large the
missing force.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from affine_model.arm import Arm, active_effects, parameter_rows
from affine_model.camera import sight_of
from affine_model.curvature import Array
from affine_model.dynamics import Instant, balance
from inference.appearance import Appearance
from inference.experiment import SHIFT_PRIOR, ZERO_PRIOR, Experiment, predict, whitened_residuals
from inference.fit import Fit
from inference.latent_force import LatentForce
from inference.linearise import latent_forces
from inference.smoother import Smoothed, likeliest
from inference.trajectory import Problem

MOTION_STEP = 1.0 / 150.0  # s, of the small motions
STATE_DIFFERENCE = 1e-5  # rad, rad/s: slopes of the equations
END_MARGIN = 0.05  # s: frames nearer to the run's ends are left out


@dataclass(frozen=True)
class SeenMotion:
    """The smoothed motion of the arm, at the middles of T steps of MOTION_STEP [s].

    t (T,) [s]; u, rate and acceleration (T, n + 2); force (T, n) [N m]: the generalised force that the model misses;
    spread (T, n): its standard deviation; share: the most likely size of the latent force, as a share of the acting
    forces; instant: the same times, with the base's travel where it travels.
    """

    t: Array
    u: Array
    rate: Array
    acceleration: Array
    force: Array
    spread: Array
    share: float
    instant: Instant


def seen_motions(problem: Problem, fitted: Fit) -> tuple[SeenMotion | None, ...]:
    """The motion and the missing force of every recording; None for one that is complete."""
    problem, parameters = problem.known(fitted.parameters)
    forces = latent_forces(problem, parameters, fitted.nuisances)
    found: list[SeenMotion | None] = []
    for place, (experiment, force) in enumerate(zip(problem.experiments, forces, strict=True)):
        if experiment.complete:
            found.append(None)
            continue
        at, nuisances = parameters[:, None], fitted.nuisances[place][:, None]
        run = predict(problem.arm, experiment, at, nuisances, problem.step)
        given = _cells_of(problem.arm, experiment, force, whitened_residuals(experiment, run)[:, :, 0])
        found.append(
            _motion(problem, experiment, (parameters, fitted.nuisances[place]), force, likeliest(force, given))
        )
    return tuple(found)


def _cells_of(arm: Arm, experiment: Experiment, force: LatentForce, residuals: Array) -> tuple[Array, Array]:
    """Whitened residuals (C, K) in the cells, and how they see (C, K, n + O) the coordinates and the offsets.

    The offsets are in units of their prior. A model that lacks a force has an error in them too.
    """
    offsets = force.cells.averaged(_by_offsets(experiment, residuals.shape, arm.specimen.length))
    seen = np.concatenate([force.seen[:, :, : arm.order], offsets], axis=2)
    return force.cells.averaged(residuals[:, :, None])[:, :, 0], seen


def _by_offsets(experiment: Experiment, shape: tuple[int, ...], length: float) -> Array:
    """Derivatives (T, K, 2 + G) of what is seen by a shift of the clamp, 0 where it is known not to shift, and by the
    zeros of sensors; each in units of its prior.
    """
    observation, shapes = experiment.observation, experiment.observation.shapes
    sensors = len(observation.sensors)
    found = np.zeros((*shape, 2 + sensors))
    if shapes is not None and experiment.sees_shift:
        found[:, : shapes.channels, :2] = SHIFT_PRIOR * length * shapes.root[:, :, 1:3]
    by_zeros = ZERO_PRIOR * observation.zero_size * observation.zero_slopes()
    for k in range(sensors):
        found[:, shape[1] - sensors + k, 2 + k] = by_zeros[:, k]
    return found / experiment.noise_gain[:, None]


def _motion(
    problem: Problem, experiment: Experiment, fit: tuple[Array, Array], force: LatentForce, smooth: Smoothed
) -> SeenMotion:
    arm, (parameters, nuisances) = experiment.arm(problem.arm), fit
    n = arm.order
    own = experiment.own(parameters[:, None], nuisances[:, None])[:, 0]
    run = predict(arm, experiment, parameters[:, None], nuisances[:, None], problem.step).batch
    model = CubicSpline(run.t, run.q[:, :, 0] @ arm.from_monomial.T)
    base = CubicSpline(run.t, run.theta[:, 0])
    change = CubicSpline(force.cells.t, smooth.mean[:, :n])
    observation = experiment.observation
    shown = observation.t[experiment.used & observation.seen]
    first, last = max(run.t[0], force.cells.t[0]), min(run.t[-1], force.cells.t[-1], shown[-1])
    t: Array = np.arange(first, last - MOTION_STEP, MOTION_STEP) + 0.5 * MOTION_STEP
    parts = []
    for slope in range(3):
        shape = model(t, slope) + change(t, slope)
        parts.append(np.column_stack([shape, base(t, slope), np.zeros(t.size)]))
    u, rate, acceleration = parts
    missing = lacking(arm, own, (u, rate, acceleration), experiment.instant(t))
    root = smooth.share * force.linearised.force_root
    deviation = np.sqrt(smooth.deviation[:, 2 * n : 3 * n] ** 2 @ (root**2).T)
    spread = np.array([np.interp(t, force.cells.t, column) for column in deviation.T]).T
    return SeenMotion(t, u, rate, acceleration, missing, spread, smooth.share, experiment.instant(t))


def lacking(arm: Arm, parameters: Array, motion: tuple[Array, Array, Array], at: Instant) -> Array:
    """The generalised force (T, n) that the model's equations lack in that motion."""
    u, rate, acceleration = motion
    made = balance(arm, active_effects(parameters), parameters, u, rate, at)
    inertia = np.einsum("tjk,tk->tj", made.mass_matrix, acceleration)
    return np.asarray((inertia - made.force)[:, : arm.order])


@dataclass(frozen=True)
class SmallMotions:
    """How one recording's arm responds to small forces about its smoothed motion.

        (d, d')_k+1 = advance_k (d, d')_k + push_k force_k,        observation of frame f = rows_f d(place_f)

    advance (T, 2n, 2n); push (T, 2n, n); place (F,) [steps] of the frames; rows (F, K, n) in noise deviations. target
    (F K,): measured minus smoothed, minus the response to -Q. by_state (F K, S): responses to the initial state and to
    the clamp's shift; by_parameters (F K, P): to a change of each free parameter of the model by its scale.
    """

    motion: SeenMotion
    advance: Array
    push: Array
    place: Array
    rows: Array
    target: Array
    by_state: Array
    by_parameters: Array

    @cached_property
    def absorbed(self) -> Array:
        """Orthonormal basis (F K, P) of what a refit of the model's own unknowns can absorb."""
        return _basis(np.concatenate([self.by_state, self.by_parameters], axis=1))

    @cached_property
    def state_basis(self) -> Array:
        """The same of the initial state and the clamp's shift alone."""
        return _basis(self.by_state)

    @np.errstate(over="ignore", invalid="ignore")  # about a model that falls over they run away
    def answer(self, force: Array, start: Array | None = None) -> Array:
        """What is seen (F K, B) of small motions under generalised forces (T, n, B)."""
        steps, n, columns = force.shape
        state = np.zeros((2 * n, columns)) if start is None else start
        shape = np.zeros((steps + 1, n, columns))
        shape[0] = state[:n]
        for k in range(steps):
            state = self.advance[k] @ state + self.push[k] @ force[k]
            shape[k + 1] = state[:n]
        index = np.minimum(self.place.astype(int), steps - 1)
        part = (self.place - index)[:, None, None]
        at_frames = (1.0 - part) * shape[index] + part * shape[index + 1]
        return np.matmul(self.rows, at_frames).reshape(-1, columns)

    def freed(self, columns: Array) -> Array:
        """Columns (F K, B) without what the model's own unknowns can absorb."""
        return columns - self.absorbed @ (self.absorbed.T @ columns)


def _basis(columns: Array) -> Array:
    size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)  # a tracker that knows the base sees no shift of it
    left, singular, _ = np.linalg.svd(columns / size, full_matrices=False)
    return np.asarray(left[:, singular > 1e-8 * singular[0]])


def small_motions(problem: Problem, fitted: Fit, place: int, motion: SeenMotion) -> SmallMotions:
    """The small motions about the smoothed motion of one recording."""
    scales = law_scales(problem)
    problem, parameters = problem.known(fitted.parameters)
    experiment = problem.experiments[place]
    arm, observation = experiment.arm(problem.arm), experiment.observation
    n = arm.order
    own = experiment.own(parameters[:, None], fitted.nuisances[place][:, None])[:, 0]
    advance, push = _equations(arm, own, motion)
    begin = motion.t[0] - 0.5 * MOTION_STEP
    lasts = motion.t[-1] + 0.5 * MOTION_STEP
    sight = sight_of(parameters)
    t = sight.shown_times(observation.t)
    shown = np.flatnonzero(experiment.used & observation.seen & (t >= begin + END_MARGIN) & (t <= lasts - END_MARGIN))
    when = (t[shown] - begin) / MOTION_STEP
    smooth = CubicSpline(motion.t, motion.u[:, : n + 1])(np.clip(t, begin, lasts))
    residuals = _seen_of(arm, experiment, own, fitted.nuisances[place], smooth)
    left = residuals[shown, :, 0].reshape(-1)
    rows = (residuals[:, :, :1] - residuals[:, :, 1:])[shown] / STATE_DIFFERENCE
    none = np.zeros((left.size, 0))
    bare = SmallMotions(motion, advance, push, when, rows, left, none, none)
    still = np.zeros((motion.t.size, n, 2 * n))
    offsets = _by_offsets(experiment, residuals.shape[:2], arm.specimen.length)[shown]
    moved = offsets.reshape(-1, offsets.shape[2])
    return replace(
        bare,
        target=left + bare.answer(motion.force[:, :, None])[:, 0],
        by_state=np.concatenate([bare.answer(still, np.eye(2 * n)), moved], axis=1),
        by_parameters=bare.answer(_parameter_forces(scales, arm, own, motion)),
    )


def _seen_of(arm: Arm, experiment: Experiment, parameters: Array, nuisances: Array, smooth: Array) -> Array:
    """Whitened residuals (T, K, 1 + n) of the motion with z and theta = smooth (T, n + 1) at the frames, and of those
    with one coordinate larger by STATE_DIFFERENCE. What depends on the arm's acceleration is left out.
    """
    n = arm.order
    q = np.repeat((smooth[:, :n] @ arm.to_monomial.T)[:, :, None], 1 + n, axis=2)
    q[:, :, 1:] += STATE_DIFFERENCE * arm.to_monomial
    theta = smooth[:, n : n + 1] + arm.root_turn(q[:, 0])
    sight = sight_of(parameters)
    shift = arm.specimen.length * np.array(sight.shift, dtype=float) + experiment.shift(n, nuisances)
    none = np.zeros(1 + n)
    zeros = experiment.zeros(n, nuisances)[:, None]
    return whitened_residuals(
        experiment, Appearance(q, theta, sight.roll + none, sight.excess + none, shift[:, None], zeros)
    )


def _equations(arm: Arm, parameters: Array, motion: SeenMotion) -> tuple[Array, Array]:
    """One step of the implicit midpoint rule for small motions: transition (T, 2n, 2n) and answer to a force."""
    n, effects = arm.order, active_effects(parameters)
    at = motion.instant

    def lacks(du: Array, dv: Array) -> Array:
        made = balance(arm, effects, parameters, motion.u + du, motion.rate + dv, at)
        inertia = np.einsum("tjk,tk->tj", made.mass_matrix, motion.acceleration)
        return (inertia - made.force)[:, :n]

    none = np.zeros(n + 2)
    stiffness, damping = np.zeros((2, motion.t.size, n, n))
    for k in range(n):
        step = STATE_DIFFERENCE * np.eye(n + 2)[k]
        stiffness[:, :, k] = (lacks(step, none) - lacks(-step, none)) / (2.0 * STATE_DIFFERENCE)
        damping[:, :, k] = (lacks(none, step) - lacks(none, -step)) / (2.0 * STATE_DIFFERENCE)
    mass = balance(arm, effects, parameters, motion.u, motion.rate, at).mass_matrix[:, :n, :n]
    h, one = MOTION_STEP, np.broadcast_to(np.eye(n), mass.shape)
    # (M + h/2 D + h^2/4 K) dv = h (f - D v - K d - h/2 K v), d' = d + h v + h/2 dv
    matrix = mass + 0.5 * h * damping + 0.25 * h**2 * stiffness
    right = np.concatenate([-h * stiffness, -h * (damping + 0.5 * h * stiffness), h * one], axis=2)
    change = np.linalg.solve(matrix, right)
    by_shape, by_rate, by_force = np.split(change, 3, axis=2)
    top = np.concatenate([one + 0.5 * h * by_shape, h * one + 0.5 * h * by_rate], axis=2)
    advance = np.concatenate([top, np.concatenate([by_shape, one + by_rate], axis=2)], axis=1)
    return advance, np.concatenate([0.5 * h * by_force, by_force], axis=1)


def law_scales(problem: Problem) -> list[tuple[int, float]]:
    """Place in the vector and scale of each free parameter of the laws; declared numbers are not among them."""
    laws = {row.index for row in parameter_rows()}
    return [
        (int(row), float(scale)) for row, scale in zip(problem.rows(), problem.scales(), strict=False) if row in laws
    ]


def _parameter_forces(scales: list[tuple[int, float]], arm: Arm, parameters: Array, motion: SeenMotion) -> Array:
    """Derivatives (T, n, P) of the generalised forces by each free parameter of the laws, in units of its scale."""
    columns = []
    own = (motion.u, motion.rate, motion.acceleration)
    for row, scale in scales:
        pair = []
        for sign in (1.0, -1.0):
            moved = parameters.copy()
            moved[row] += sign * 1e-3 * scale
            pair.append(lacking(arm, moved, own, motion.instant))
        columns.append((pair[1] - pair[0]) / 2e-3)
    return np.stack(columns, axis=2) if columns else np.zeros((motion.t.size, arm.order, 0))

"""The small motions of an arm about its smoothed motion: how any force would move what is seen.

(d, d')_k+1 = advance_k (d, d')_k + push_k force_k        (one step of the implicit midpoint rule)
M d'' + D d' + K d = force,        K = d(M u'' - F)/du,  D = -dF/du'        (inference.missing_force)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from affine_model.arm import Arm, active_effects, parameter_rows
from affine_model.camera import sight_of
from affine_model.curvature import Array
from affine_model.dynamics import balance
from inference.appearance import Appearance
from inference.experiment import Experiment, whitened_residuals
from inference.fit import Fit
from inference.missing_force import MOTION_STEP, SeenMotion, by_offsets, lacking
from inference.trajectory import Problem
from tentacle.compiled import njit

STATE_DIFFERENCE = 1e-5  # rad, rad/s: slopes of the equations
END_MARGIN = 0.05  # s: frames nearer to the run's ends are left out


@njit(cache=True, nogil=True)
def shapes_along(advance, push, force, start):
    """The shapes d (T + 1, n, B) of B small motions: (d, d')_k+1 = advance_k (d, d')_k + push_k force_k.

    advance (T, 2n, 2n); push (T, 2n, n); force (T, n, B); start (2n, B).
    """
    steps, n, columns = force.shape
    state, then = start.copy(), np.empty_like(start)
    shape = np.empty((steps + 1, n, columns))
    shape[0] = state[:n]
    for k in range(steps):
        for i in range(2 * n):
            for b in range(columns):
                then[i, b] = 0.0
            for j in range(2 * n):
                for b in range(columns):
                    then[i, b] += advance[k, i, j] * state[j, b]
            for j in range(n):
                for b in range(columns):
                    then[i, b] += push[k, i, j] * force[k, j, b]
        state, then = then, state
        shape[k + 1] = state[:n]
    return shape


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
        begin = np.zeros((2 * n, columns)) if start is None else start
        shape = shapes_along(self.advance, self.push, np.ascontiguousarray(force), begin)
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
    offsets = by_offsets(experiment, residuals.shape[:2], arm.specimen.length)[shown]
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
    theta = smooth[:, n : n + 1] + arm.root_turn(q, 1)
    sight = sight_of(parameters)
    shift = arm.specimen.length * np.array(sight.shift, dtype=float) + experiment.shift(n, nuisances)
    none = np.zeros(1 + n)
    zeros = experiment.zeros(n, nuisances)[:, None]
    return whitened_residuals(
        experiment, Appearance(q, theta, sight.roll + none, sight.excess + none, shift[:, None], zeros, None, arm.askew)
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

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

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array
from affine_model.dynamics import Instant, balance
from inference.cells import CELLS, Cells
from inference.experiment import SHIFT_PRIOR, ZERO_PRIOR, Experiment, predict, whitened_residuals
from inference.fit import Fit
from inference.latent_force import LatentForce
from inference.linearise import latent_forces
from inference.smoother import Smoothed, likeliest
from inference.trajectory import Problem

FEWEST_SEEN = 0.25  # of the instants: a recording of which less is so far from its ends counts whole
MOTION_STEP = 1.0 / 150.0  # s, of the small motions


@dataclass(frozen=True)
class SeenMotion:
    """The smoothed motion of the arm, at the middles of T steps of MOTION_STEP [s].

    t (T,) [s]; u, rate and acceleration (T, n + 2); force (T, n) [N m]: the generalised force that the model misses;
    spread (T, n): its standard deviation; share: the most likely size of the latent force, as a share of the acting
    forces; instant: the same times, with the base's travel where it travels. seen (T,) bool: frames were used
    before and after; elsewhere the smoother returns to the model, and the force is the one that this takes.
    """

    t: Array
    u: Array
    rate: Array
    acceleration: Array
    force: Array
    spread: Array
    share: float
    instant: Instant
    seen: NDArray[np.bool_]


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
    offsets = force.cells.averaged(by_offsets(experiment, residuals.shape, arm.specimen.length))
    seen = np.concatenate([force.seen[:, :, : arm.order], offsets], axis=2)
    return force.cells.averaged(residuals[:, :, None])[:, :, 0], seen


def by_offsets(experiment: Experiment, shape: tuple[int, ...], length: float) -> Array:
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
    instant, seen = experiment.instant(t), _between_frames(force.cells, t)
    return SeenMotion(t, u, rate, acceleration, missing, spread, smooth.share, instant, seen)


def _between_frames(cells: Cells, t: Array) -> NDArray[np.bool_]:
    """Whether frames fill half of the cells or more within twice the latent force's time, before each time (T,) and
    after it: so it is farther than that force's time from an end and from a gap that is longer. All times where fewer
    than FEWEST_SEEN are.
    """
    reach = math.ceil(2.0 * CELLS)
    filled = np.zeros(cells.t.size + 2 * reach + 1)
    filled[cells.cell + reach + 1] = 1.0
    until = np.cumsum(filled)  # cell k is entry k + reach + 1
    k = np.clip(np.rint((t - cells.t[0]) / cells.interval).astype(np.intp), 0, cells.t.size - 1)
    before, after = until[k + reach] - until[k], until[k + 2 * reach + 1] - until[k + reach + 1]
    seen = np.minimum(before, after) >= 0.5 * reach
    return np.asarray(seen | (seen.mean() < FEWEST_SEEN))


def lacking(arm: Arm, parameters: Array, motion: tuple[Array, Array, Array], at: Instant) -> Array:
    """The generalised force (T, n) that the model's equations lack in that motion."""
    u, rate, acceleration = motion
    made = balance(arm, active_effects(parameters), parameters, u, rate, at)
    inertia = np.einsum("tjk,tk->tj", made.mass_matrix, acceleration)
    return np.asarray((inertia - made.force)[:, : arm.order])

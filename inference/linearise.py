"""The arm's small motions about a fitted run, as the latent force drives them (see inference.latent_force)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh
from scipy.ndimage import gaussian_filter1d

from affine_model.arm import Arm, active_effects, parameter_index
from affine_model.camera import sight_of
from affine_model.curvature import Array
from affine_model.dynamics import Balance, Instant, balance
from affine_model.effect import Effect, Law
from affine_model.statics import DIFFERENCE
from inference.appearance import Appearance
from inference.cells import Cells, cells_of
from inference.experiment import Experiment, Prediction, predict
from inference.latent_force import (
    CORRELATION_LENGTH,
    ELL,
    LAW_FOUND,
    LAW_KNOWN,
    SHAPE_SHARE,
    SHAPE_TIME,
    LatentForce,
    Linearised,
    SeenError,
    with_scaled_mass,
)
from inference.motion_time import motion_time
from inference.observation import TRACKER_ERROR
from inference.trajectory import Problem

STATES = 24  # of the run, over which the equations are averaged
WINDOW, LEAST = 6.0, 0.1  # times of the motion over which its size is taken; what counts at rest
ANGLE_STEP, PLACE_STEP = 1e-5, 1e-6  # rad, m: differences of what is seen
VARIED = (
    "stiffness", "stiffness_share", "natural_curvature", "bending_moment", "drag_coefficient", "line_inertia",
    "carried_water", "normal_inertia", "rotary_inertia", "weight", "couple",
)  # fmt: skip


def latent_forces(
    problem: Problem,
    parameters: Array,
    nuisances: tuple[Array, ...],
    added: tuple[str, ...] = (),
    declared: tuple[LatentForce, ...] = (),
) -> tuple[LatentForce, ...]:
    """The latent force of every recording about the run with these unknowns. added: effects with less certain laws.

    declared: the latent force about the declared model, whose size and envelope are kept (none: this run is that one).
    Otherwise a share of unknown forces would be another force in each hypothesis.
    """
    found = []
    problem, parameters = problem.known(parameters)
    for place, experiment in enumerate(problem.experiments):
        arm = experiment.arm(problem.arm)
        run = predict(arm, experiment, parameters[:, None], nuisances[place][:, None], problem.step)
        time = ELL * motion_time(experiment)
        cells = cells_of(experiment.observation.t, experiment.used, time)
        seen = cells.averaged(_seen(arm, experiment, parameters, run))
        linearised = _linearised(arm, parameters, run, (cells, time, experiment), added)
        if declared:
            same = declared[place].linearised
            linearised = replace(linearised, force_root=same.force_root, envelope=same.envelope)
        found.append(LatentForce(linearised, cells, seen, _error(arm, experiment, run, seen)))
    return tuple(found)


def _seen(arm: Arm, experiment: Experiment, parameters: Array, run: Prediction) -> Array:
    """Derivatives (T, K, n + 2 + P) of the observation by the coordinates, base angle, scale and P places.

    In the first of them the motion is not known, so that an accelerometer does not see them (inference.latent_force).
    """
    n, observation = arm.order, experiment.observation
    sight = sight_of(parameters)
    roll, excess = np.full(n + 3, sight.roll), np.full(n + 3, sight.excess)
    q, theta = np.repeat(run.q, n + 3, axis=2), np.repeat(run.theta, n + 3, axis=1)
    q[:, :, 1 : n + 1] += ANGLE_STEP * arm.to_monomial[None]
    theta[:, 1 : n + 1] += ANGLE_STEP * arm.root_turn(arm.to_monomial)
    theta[:, n + 1] += ANGLE_STEP
    excess[n + 2] += ANGLE_STEP
    shift, zeros = np.repeat(run.shift, n + 3, axis=1), np.zeros((1, n + 3))
    shown = Appearance(q, theta, roll, excess, shift, zeros, None, run.shear)
    rows = observation.predict(shown) / experiment.noise_gain[:, None]
    changes = [(rows[:, :, :1] - rows[:, :, 1:]) / ANGLE_STEP]
    moving = Appearance(run.q, run.theta, roll[:1], excess[:1], run.shift, np.zeros((1, 1)), run.motion, run.shear)
    here = rows[:, :, :1] if run.motion is None else observation.predict(moving) / experiment.noise_gain[:, None]
    for moved in observation.moved_places(PLACE_STEP):
        changes.append((here - moved.predict(moving) / experiment.noise_gain[:, None]) / PLACE_STEP)
    return np.concatenate(changes, axis=2)


def _error(arm: Arm, experiment: Experiment, run: Prediction, seen: Array) -> SeenError:
    """Slow errors of the shape and the base angle, or of every coordinate of every marker; and of every sensor."""
    n, observation = arm.order, experiment.observation
    shape = run.q[:, :, 0] @ arm.from_monomial.T
    size, of_sensors = observation.slow_errors(experiment.used, shape), observation.sensor_errors(experiment.used)
    live, floor = np.any(seen != 0.0, axis=2), 0.0
    alone = live[:, :, None] * np.diag(1.0 / experiment.noise_gain)
    rows = alone
    if observation.shapes is not None:
        rows = seen[:, :, : n + 1].copy()
        pictured = observation.channels - of_sensors.shape[1]
        rows[:, pictured:] = 0.0  # an error of the pictures
        if observation.tracked:
            information = np.einsum("ckj,ckl->jl", rows, rows) / max(int(np.any(rows != 0.0, axis=(1, 2)).sum()), 1)
            basis, size = _as_noise_errs(size, information)
            rows, floor = rows @ basis, TRACKER_ERROR
        rows = np.concatenate([rows, alone[:, :, pictured:]], axis=2)
    of_shape = np.stack([size, *(np.full(size.size, value) for value in (floor, SHAPE_SHARE, SHAPE_TIME))])
    return SeenError(rows, *np.concatenate([of_shape, of_sensors], axis=1))


def _as_noise_errs(size: Array, information: Array) -> tuple[Array, Array]:
    """A basis W (n, r) of errors, and their sizes s (r,): W'(information) W = 1, and W s^2 W' = diag(size)^2.

    In this basis a tracker's noise has unit size, and its slow errors are alike. Its coordinates err together. What all
    of them know together would be lost beside a slow error of each alone.
    """
    values, vectors = eigh(information)
    known = values > values.size * np.finfo(float).eps * values[-1]
    root, vectors = np.sqrt(values[known]), vectors[:, known]
    across = root[:, None] * vectors.T
    squares, turned = eigh(across @ np.diag(size**2) @ across.T)
    return (vectors / root) @ turned, np.sqrt(np.maximum(squares, 0.0))


def _linearised(
    arm: Arm,
    parameters: Array,
    run: Prediction,
    sampled: tuple[Cells, float, Experiment],
    added: tuple[str, ...],
) -> Linearised:
    """The equations averaged over states of the run, and the sizes of its forces and motion."""
    n, batch, (cells, time, experiment) = arm.order, run.batch, sampled
    u = np.concatenate([arm.from_monomial @ batch.q[:, :, 0].T, batch.theta[None, :, 0], 0.0 * batch.theta[None, :, 0]])
    rate = np.concatenate([arm.from_monomial @ batch.q_rate[:, :, 0].T, batch.theta_rate[None, :, 0], 0.0 * u[:1]])
    acceleration = np.gradient(rate, batch.t, axis=1)
    chosen = np.linspace(0, u.shape[1] - 1, STATES).astype(int)
    effects = active_effects(parameters)
    states, rates = u.T[chosen], rate.T[chosen]
    at = replace(experiment.instant(batch.t[chosen]), t=0.0)  # the equations' slopes hold at any time
    mass = balance(arm, effects, parameters, states, rates, at).mass_matrix[:, :n, : n + 1].mean(axis=0)

    def slope(of_rate: bool) -> Array:
        columns = []
        for k in range(n + 1):
            step = DIFFERENCE * np.eye(n + 2)[k]
            pair = [
                balance(
                    arm, effects, parameters, states + sign * step * (not of_rate), rates + sign * step * of_rate, at
                ).force[:, :n]
                for sign in (1.0, -1.0)
            ]
            columns.append((pair[0] - pair[1]).mean(axis=0) / (2.0 * DIFFERENCE))
        return np.array(columns).T

    index = np.clip(np.searchsorted(batch.t, cells.t), 0, batch.t.size - 1)
    there, turning = u.T[index], rate.T[index]
    then = replace(experiment.instant(batch.t[index]), t=0.0)
    moving = States(
        there, turning, acceleration.T[index], balance(arm, effects, parameters, there, turning, then), then
    )
    laws = [
        (LAW_FOUND if effect.name in added else LAW_KNOWN)
        * varied_force(arm, effects, effect, parameters, moving, factor)
        for effect in effects
        for factor in (lambda s: 2.0 * s - 1.0, lambda s: 6.0 * s**2 - 6.0 * s + 1.0)
    ]
    laws = [law for law in laws if np.any(law != 0.0)]
    stiffness = _passive(-slope(False))
    return Linearised(
        mass=with_scaled_mass(mass, stiffness, time),
        damping=_passive(-slope(True)),
        stiffness=stiffness,
        time=time,
        force_root=_force_root(arm, parameters, acceleration, u),
        laws=np.stack(laws, axis=2),
        envelope=_envelope(u[:n] - u[:n].mean(axis=1, keepdims=True), batch.t, cells.t, time),
        base_rms=float(np.std(u[n])),
    )


def _envelope(motion: Array, t: Array, at: Array, time: float) -> Array:
    """Size of a motion (n, T) about instants `at` (C,), over its rms along the run; LEAST at least."""
    square = np.sum(motion**2, axis=0)
    width = WINDOW * time / float(np.median(np.diff(t)))
    smooth = gaussian_filter1d(square, width, mode="nearest")
    return np.asarray(np.maximum(np.sqrt(np.interp(at, t, smooth) / np.mean(square)), LEAST))


def _passive(columns: Array) -> Array:
    """Damping or stiffness (n, n + 1) with a positive semidefinite symmetric part (n, n).

    The average along a poorly fitted run can be unstable. The unknown force would then grow without bound.
    """
    n = columns.shape[0]
    values, vectors = np.linalg.eigh(0.5 * (columns[:, :n] + columns[:, :n].T))
    return np.concatenate([(vectors * np.maximum(values, 0.0)) @ vectors.T, columns[:, n:]], axis=1)


@dataclass(frozen=True)
class States:
    """States of a run: u, u', u'' (C, n + 2) in Legendre coordinates, the equations' balance in them, and when."""

    u: Array
    rate: Array
    acceleration: Array
    balance: Balance
    instant: Instant


def varied_force(
    arm: Arm,
    effects: tuple[Effect, ...],
    effect: Effect,
    parameters: Array,
    states: States,
    factor: Callable[[Array], Array],
) -> Array:
    """Generalised force (C, n) of one effect's laws, each taken times factor(s), in given states."""
    changes: dict[str, object] = {
        name: _times(law, factor) for name in VARIED if (law := getattr(effect, name)) is not None
    }
    if effect.force is not None:
        law = effect.force
        changes["force"] = lambda x, p: tuple(factor(x.s) * part for part in law(x, p))
    nothing = dict.fromkeys(("hung_mass", "payload_shift", "gravity_tilt", "water_velocity", "tip_force"))
    more = replace(effect, **(nothing | changes))  # type: ignore[arg-type]
    with_it, without = balance(arm, (*effects, more), parameters, states.u, states.rate, states.instant), states.balance
    inertia = np.einsum("cij,cj->ci", with_it.mass_matrix - without.mass_matrix, states.acceleration)
    return np.asarray((with_it.force - without.force - inertia)[:, : arm.order])


def _times(law: Law, factor: Callable[[Array], Array]) -> Law:
    return lambda x, p: factor(x.s) * law(x, p)


def _force_root(arm: Arm, parameters: Array, acceleration: Array, u: Array) -> Array:
    """Root (n, n) of the covariance of generalised forces from line forces and bending moments that are, everywhere
    along the arm, as large as those of inertia and elasticity (rms over the run).
    """
    n, rule, length = arm.order, arm.rule, arm.specimen.length
    node = arm.node_quantities
    across = -length * rule.integration @ np.concatenate([arm.angle_basis, np.ones((arm.node_count, 1))], axis=1)
    inertia = arm.specimen.density * node["area"] * np.sqrt(np.mean((across @ acceleration[: n + 1]) ** 2, axis=1))
    E, k0, k1 = (parameters[parameter_index("elasticity", name)] for name in ("E", "k0", "k1"))
    stiffness = E * node["second_moment"] / length + k0 + k1 * node["s"]
    moment = stiffness * np.sqrt(np.mean((arm.curvature_basis @ u[:n]) ** 2, axis=1))
    alike = np.exp(-0.5 * ((node["s"][:, None] - node["s"]) / CORRELATION_LENGTH) ** 2)
    pushed = (length * rule.weights * inertia)[:, None] * across[:, :n]
    bent = (arm.bending_weights * moment)[:, None] * arm.curvature_basis
    covariance = pushed.T @ alike @ pushed + bent.T @ alike @ bent
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))

"""Strengths of a blind trial's hidden effects, found from the change of the data that refitting cannot absorb."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from affine_model.arm import arm_of, declared_parameters, parameter_index
from affine_model.curvature import Array, legendre_to_monomial, midline
from affine_model.points_beside import points_beside
from inference.experiment import Experiment, predict
from inference.fit import unfitted
from inference.marker_observation import MarkerObservation
from inference.measured_shapes import Tracker, fit_shapes, from_track
from inference.multistart import fit_multistart
from inference.observation import POSE, Observation, ShapeObservation
from inference.trajectory import Problem
from inference.whitened_fit import tangent_basis
from mujoco_ref.simulate import DEFAULT_LINKS
from mujoco_ref.undeclared.make import Scenario, seen_midline, shown_mm
from mujoco_ref.undeclared.strength import (
    LARGEST_STRENGTH,
    SCALED_TOGETHER,
    STRENGTH_SIZES,
    is_catalogued,
    scaled,
    typical,
)
from tentacle.errors import InputError
from tentacle.signals import Midline
from validation.trials.design import Design, designs
from validation.trials.likeness import Likeness
from validation.trials.sight import EVERYWHERE, Measurement, track_of

SIZED_AT = 30.0  # frames/s: enough for rms values
SIZED_ORDER, SEEN_ORDER = 3, 5
SIZING_STEP = 1.0 / 480.0  # s; a strong Maxwell branch on a stiff arm is unstable at 1/300
SETTLING_TIME = 2.0  # s: the start from rest is left out
FACTORS = np.geomspace(3e-3, 300.0, 46)  # on a typical strength
CORRECTIONS, CLOSE = 5, 0.05
LEAST_SHOWN, SHOWN_BY_FAR = 1.0, 5.0  # R
STRONGER = (1.0, 10.0, 100.0)  # times a typical strength
SEEN_FOR = 8.0  # s
# Starts of a refit, times the true values: with a large effect the best base can be far from the true one.
STIFFER, MORE_DAMPED = (0.6, 0.8, 1.0, 1.25, 1.6, 2.2), (1.0, 5.0)


def bare_problem(design: Design, root: Array | None = None) -> tuple[Problem, Array]:
    """A trajectory problem at a trial's truth without hidden effects and without noise, and its nuisances.

    The data are whitened by the measurement's noise or, for a track, by a root (K, K). A baseline shows the arm's own
    parameters, so that beside one none of them is free: only the pose that the arm is let go from is.
    """
    model = design.model()
    arm = arm_of(replace(model, order=SIZED_ORDER))
    own = tuple((effect, name) for effect, values in model.parameters.items() for name in values)
    parameters = declared_parameters(model.specimen, model.fluid)
    for effect, name in own:
        parameters[parameter_index(effect, name)] = model.value(effect, name)
    free = () if design.baseline else own
    t = np.arange(0.0, design.duration, 1.0 / SIZED_AT)
    base = design.waveform()
    theta, release = base(t)[0], design.release_t
    duration = float(t[-1]) + 0.2 - (release or 0.0)
    used, unseen = t > (SETTLING_TIME if release is None else release), _unseen(t, theta, model.specimen.length)
    experiment = Experiment("sizing", unseen, base, 0.0, duration, release, used, np.ones(POSE))
    nuisances = np.zeros(len(experiment.nuisance_names(SIZED_ORDER)))
    if design.initial_q is not None:
        q = np.array([*design.initial_q, *np.zeros(SIZED_ORDER)][:SIZED_ORDER])
        nuisances[:SIZED_ORDER] = np.linalg.solve(legendre_to_monomial(SIZED_ORDER), q)
    shown = predict(arm, experiment, parameters[:, None], nuisances[:, None], SIZING_STEP)
    seen = _observation(design.sight, t, shown.q[:, :, 0], shown.theta[:, 0], model.specimen.length, root)
    experiment = replace(experiment, observation=seen, noise_gain=np.ones(seen.channels))
    nuisances = nuisances[: len(experiment.nuisance_names(SIZED_ORDER))]  # markers have no shift, which is the last
    return Problem(arm, (experiment,), free, parameters, SIZING_STEP), nuisances


def _unseen(t: Array, theta: Array, length: float) -> ShapeObservation:
    """An observation of zeros at those times."""
    nothing = np.zeros(t.size)
    blank = np.zeros((t.size, POSE))
    return ShapeObservation(t, theta, length, blank, np.zeros((t.size, POSE, POSE)), nothing, nothing)


def _observation(
    sight: Measurement, t: Array, q: Array, theta: Array, length: float, root: Array | None
) -> Observation:
    """Shapes q (T, n) as they would be seen without noise."""
    s = np.array(sight.s)
    if sight.kind == "markers":
        d = np.array(sight.d)
        return MarkerObservation(t, theta, length, s, d, points_beside(q, theta, length, s, d), sight.noise)
    order = min(SEEN_ORDER, s.size - POSE) if root is None else root.shape[0] - POSE
    points = midline(q, theta, length, s)
    seen = fit_shapes(
        Midline(t, s, points, np.full(points.shape[:2], sight.noise)), theta, length, order, Tracker(sight.noise)
    )
    return seen if root is None else replace(seen, root=np.repeat(root[None], t.size, axis=0))


def visible_size(problem: Problem, nuisances: Array, effect: str, variants: list[dict[str, float]]) -> Array:
    """R (V,) of an effect at each set of parameters, to first order: rms of the whitened residual that is not within
    the base's columns.
    """
    state = unfitted(problem, (nuisances,))
    basis = tangent_basis(state.jacobian)
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
    """R of an effect: rms of the whitened residual of the base, fitted to the motion with the effect.

    A fit may miss the best minimum; if the R to first order is smaller, it is taken instead.
    """
    parameters = problem.parameters.copy()
    for name, value in values.items():
        parameters[parameter_index(effect, name)] = value
    base = problem.parameters[problem.rows()]
    start = np.concatenate([base, nuisances])
    rows = replace(problem, parameters=parameters).residuals(start[:, None])[1][0][:, :, 0]
    left = left_by_refit(problem, nuisances, rows)
    return min(left, float(visible_size(problem, nuisances, effect, [values])[0]))


def left_by_refit(problem: Problem, nuisances: Array, rows: Array) -> float:
    """Residual of a change of the data after refitting the base: rms of the whitened residual [noise sigmas].

    rows (T, K): whitened, the bare arm minus the changed one.
    """
    base = problem.parameters[problem.rows()]
    (experiment,) = problem.experiments
    measured = replace(experiment, observation=experiment.observation.subtract_residual(rows))
    stiff, damped = (np.array([name == wanted for name, _ in problem.free]) for wanted in ("elasticity", "damping"))
    starts = np.stack(
        [base * np.where(stiff, E, np.where(damped, eta, 1.0)) for E in STIFFER for eta in MORE_DAMPED], axis=1
    )
    fitted = fit_multistart(replace(problem, experiments=(measured,)), (nuisances,), starts)
    return float(np.sqrt(np.mean(fitted.residuals[0][experiment.used] ** 2)))


def sized(design: Design, root: Array | None = None) -> tuple[dict[str, Any], list[float]]:
    """The hidden effects' parameters, and the R that each has [noise sigmas]; NaN for those outside the catalogue,
    which are scaled elsewhere so that the midline moves by 6 to 15 sigmas. root (K, K): of a track.
    """
    random = np.random.default_rng([design.seed, 1])
    hidden: dict[str, Any] = {}
    reached: list[float] = []
    for effect, wanted in zip(design.effects, design.r, strict=True):
        if not is_catalogued(effect):
            hidden[effect] = "visible"
            reached.append(float("nan"))
            continue
        drawn = typical(effect, design.model(), random)
        problem, nuisances = bare_problem(design, root)
        factors, sizes = strength_factors(problem, nuisances, effect, drawn)
        factor = float(np.exp(np.interp(np.log(wanted), np.log(sizes), np.log(factors))))
        # To first order the base absorbs too little of a large effect: correct by the residual of a real refit.
        for _ in range(CORRECTIONS):
            hidden[effect] = scaled(effect, drawn, factor)
            size = refitted_size(problem, nuisances, effect, hidden[effect])
            if abs(np.log(size / wanted)) < CLOSE:
                break
            factor = float(np.clip(factor * np.clip(wanted / size, 0.2, 5.0), factors[0], factors[-1]))
        hidden[effect] = scaled(effect, drawn, factor)
        reached.append(refitted_size(problem, nuisances, effect, hidden[effect]))
    return hidden, reached


def strength_factors(problem: Problem, nuisances: Array, effect: str, drawn: dict[str, float]) -> tuple[Array, Array]:
    """Factors (V,) on an effect's typical strength, and R (V,) at each to first order, rising."""
    largest = max(abs(drawn[name]) for name in SCALED_TOGETHER[effect])
    factors = FACTORS[FACTORS * largest <= LARGEST_STRENGTH.get(effect, np.inf)]
    sizes = visible_size(problem, nuisances, effect, [scaled(effect, drawn, float(f)) for f in factors])
    usable = sizes < 1e3  # a simulation that ran away counts as 1e6
    return factors[usable], np.maximum.accumulate(np.maximum(sizes[usable], 1e-12))


def shown_effects(
    like: Likeness, catalogued: Sequence[str], outside: Sequence[str]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The effects that can be detected in such a recording: R >= 1 after a refit, at a strength with a far larger R to
    first order; for those outside the catalogue, the midline must move by the size required of a trial.

    InputError where none can.
    """
    (null,) = designs(1, 0, catalogued, outside, like, ["null"])
    model = like.model
    problem, nuisances = bare_problem(null, track_root(null) if like.sight.kind == "track" else None)
    random = np.random.default_rng(0)

    def remains(effect: str) -> bool:
        drawn = typical(effect, model, random)
        factors, sizes = strength_factors(problem, nuisances, effect, drawn)
        if sizes.max(initial=0.0) < LEAST_SHOWN:
            return False
        factor = float(factors[min(np.searchsorted(sizes, SHOWN_BY_FAR), factors.size - 1)])
        return refitted_size(problem, nuisances, effect, scaled(effect, drawn, factor)) >= LEAST_SHOWN

    shown = tuple(effect for effect in catalogued if remains(effect))
    initial = None if like.initial_q is None else np.array(like.initial_q)
    seconds = min(like.duration, SEEN_FOR + (like.release_t or 0.0))
    places = np.array(EVERYWHERE)
    scene = Scenario(model, null.waveform(), seconds, like.fps, places, DEFAULT_LINKS, initial, like.release_t)
    bare = seen_midline(scene, {})
    wanted = 1e3 * STRENGTH_SIZES["visible"][0] * like.sight.noise

    def moves(effect: str) -> bool:
        drawn = typical(effect, model, random)
        strengths = (scaled(effect, drawn, factor) for factor in STRONGER)
        try:
            return any(shown_mm(scene, {effect: values}, bare, seconds) >= wanted for values in strengths)
        except InputError:  # it is hardly visible at any strength with a bounded simulation
            return False

    beyond = tuple(effect for effect in outside if moves(effect))
    if not shown or not beyond:
        raise InputError(
            "no effect could show in such a recording", field="--like", expected="a motion that shows some"
        )
    return shown, beyond


def track_root(design: Design) -> Array:
    """Root (K, K) that whitens a track's true noise, as inference.observation orders it."""
    sight, frames = design.sight, int(design.duration * design.fps) + 1
    times, nothing = np.arange(frames) / design.fps, np.zeros((frames, len(design.sight.covariance)))
    root = from_track(track_of(sight, times, nothing, 1.0), np.zeros(frames), design.model().specimen.length).root[0]
    root[[0, *range(POSE, root.shape[0])]] /= np.array(sight.gain)[:, None]
    return root

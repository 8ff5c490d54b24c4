"""Joint estimate from all frames: the recording's parameters, a common base angle offset, the order that the data need.

Each accepted frame gives x = x_f + dx_dg (g - g0) with covariance C_f, and its information on g. The base angle offset
is modelled as mean + random deviation of variance tau^2, estimated from the frames (empirical Bayes). A rigid mounting
gives tau = 0, and all frames share one offset. A base with an unmeasured motion gives a large tau, and each frame keeps
its own offset. To drop a coordinate is to hold its value at zero, so both are the same linear update.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from tentacle.signals import Array, FrameShapes
from vision.held_coordinates import held_covariance, left_out
from vision.kinematics import SHARED
from vision.settle import PRIOR
from vision.slow_waves import inflation
from vision.tracked_frame import TrackedFrame

LEAST_SPREAD = 3e-4  # rad, below the resolution of servo encoders: a smaller apparent motion is an error of edges
MOVED = 16.3  # chi-square of three degrees of freedom that .1 % exceed: base and length are moved
MOUNTING = 12.0  # gain in -2 log likelihood below which the base angle offset is held to be constant
CONTRADICTION = 9.0  # chi-square above which two places of the tip contradict each other
TURNS_FREELY = 3.0  # rad, prior spread of an unknown base angle
COORDINATE_PENALTY = 5.0  # per coordinate and frame; with Akaike's 2 a bubble on the arm would give a false coordinate
MOST_TURNS = 30  # rounds of g and tau


class PoolResult(Enum):
    """How the joint estimate ended; `message` is its sentence."""

    SETTLED = "The frames' joint estimate settled."
    MAX_TURNS = f"The spread of the base angle's offset had not settled after {MOST_TURNS} rounds."
    NOTHING_SEEN = "No frame was accepted, so there is no joint estimate."

    @property
    def message(self) -> str:
        """One sentence in plain words."""
        return self.value


@dataclass(frozen=True)
class Pooled:
    """x (T, K) and covariance (T, K, K) of the accepted frames, K = order + 1; NaN rows elsewhere.

    by_frames: what each frame tells by itself, with g put in. shared (G,) with shared_covariance (G, G). evidence[n]:
    chi-square per frame of the coordinates above order n (about their number if they are noise). inflation, staying:
    factors from the slow waves in the edges' errors, on the variance of a frame's x, and further on that of the shared
    parameters. result: how the estimate ended.
    """

    x: Array
    covariance: Array
    by_frames: FrameShapes
    order: int
    shared: Array
    shared_covariance: Array
    evidence: dict[int, float]
    inflation: float
    staying: float
    result: PoolResult


@dataclass(frozen=True)
class KnownBefore:
    """Knowledge besides the frames: information (G, G) and gradient (G,) on g at the g that the frames used, and
    whether the mounting is rigid. It is not rigid if no log gives the base's rotation.
    """

    information: Array
    gradient: Array
    rigid: bool = True


NOTHING_KNOWN = KnownBefore(np.zeros((SHARED, SHARED)), np.zeros(SHARED))


@dataclass(frozen=True)
class _Stack:
    """The accepted frames. told (T, K, G): dx_dg of the coordinates whose known values tell of g."""

    x: Array
    covariance: Array
    dx_dg: Array
    told: Array
    information: Array
    gradient: Array
    rigid: bool


@dataclass(frozen=True)
class _Solution:
    shared: Array
    covariance: Array
    mean: float
    tau: float
    objective: float
    result: PoolResult


def pool(
    seen: list[TrackedFrame],
    start: Array,
    order: int | None,
    prior: Array = PRIOR,
    known: KnownBefore = NOTHING_KNOWN,
) -> Pooled:
    """Join the frames; order None lets the data choose from 2 up to what was fitted. start (G,): the g they used;
    prior (G,): follow.prior_of."""
    accepted = np.array([frame.accepted for frame in seen])
    fitted = len(seen[0].x) - 1
    if not accepted.any():
        chosen = order or min(2, fitted)
        nan = np.full((len(seen), chosen + 1), np.nan)
        nans, spread, ended = nan[:, :, None] * nan[:, None, :], np.diag(prior**2), PoolResult.NOTHING_SEEN
        return Pooled(nan, nans, FrameShapes(nan, nans), chosen, start, spread, {}, 1.0, 1.0, ended)
    good = [frame for frame in seen if frame.accepted]
    power, staying = inflation(np.array([frame.waves for frame in good]))
    # Without a log of the base's rotation only the sides tell g: then the whole persistent error counts.
    common = power if known.rigid else power * staying
    stack = _Stack(
        x=np.array([frame.x for frame in good]),
        covariance=power * np.array([frame.covariance for frame in good]),
        dx_dg=np.array([frame.dx_dg for frame in good]),
        told=np.array([frame.dx_dg for frame in good]),
        information=sum((frame.shared_information for frame in good), np.zeros((SHARED, SHARED))) / common,
        gradient=sum((frame.shared_gradient for frame in good), np.zeros(SHARED)) / common,
        rigid=known.rigid,
    )
    evidence, solutions, chosen = _orders(stack, order, start, prior)
    if not known.rigid and chosen < fitted:  # the sides alone tell g
        free = replace(stack, told=stack.told * (np.arange(fitted + 1) == 0)[:, None])
        if _moves(solutions[chosen], _solve(free, chosen, start, prior)):
            stack = free
            evidence, solutions, chosen = _orders(stack, order, start, prior)
    # do not hold coordinates at zero if this needs another length
    while order is None and chosen < fitted and _believed(solutions[chosen], known) < 1.0:
        chosen += 1
    believed = _believed(solutions[chosen], known)
    stack = replace(
        stack,
        information=believed * stack.information + known.information,
        gradient=believed * stack.gradient + known.gradient,
    )
    solution = _solve(stack, chosen, start, prior)
    if known.rigid:
        # A persistent error is common to all x and acts only in part on parameters that the arm's rotation shows. In
        # rendered tanks the full factor gave stated errors 1.8 times too large, no factor up to 1.7 times too small:
        # so its root is used.
        solution = replace(solution, covariance=np.sqrt(staying) * solution.covariance)
    x, held = _update(stack, solution, chosen)
    return Pooled(
        x=_in_all(x, accepted),
        covariance=_in_all(held * left_out(evidence, fitted, chosen), accepted),
        by_frames=FrameShapes(*(_in_all(values, accepted) for values in _alone(stack, solution))),
        order=chosen,
        shared=start + solution.shared,
        shared_covariance=solution.covariance[:SHARED, :SHARED],
        evidence=evidence,
        inflation=power,
        staying=staying,
        result=solution.result,
    )


def _in_all(values: Array, accepted: NDArray[np.bool_]) -> Array:
    """Values of the accepted frames (A, ...) as values of all frames (T, ...), NaN where none was accepted."""
    found = np.full((len(accepted), *values.shape[1:]), np.nan)
    found[accepted] = values
    return found


def _orders(
    stack: _Stack, order: int | None, start: Array, prior: Array
) -> tuple[dict[int, float], dict[int, _Solution], int]:
    """Pooled.evidence, the solutions by order, and the order that the data choose, or the given one."""
    fitted = stack.x.shape[1] - 1
    solutions = {n: _solve(stack, n, start, prior) for n in range(min(2, fitted), fitted + 1)}
    full = solutions[fitted].objective
    evidence = {n: (solution.objective - full) / len(stack.x) for n, solution in solutions.items()}
    chosen = order or min(evidence, key=lambda n: evidence[n] + COORDINATE_PENALTY * n)
    if chosen not in solutions:
        solutions[chosen] = _solve(stack, chosen, start, prior)
    return evidence, solutions, chosen


def _moves(held: _Solution, free: _Solution) -> bool:
    """Whether coordinates that are held at zero move the base or the length away from what all else says (Hausman).

    A polynomial counted from another place, or over another length, is another one of the same order. If the
    coordinates above the order are not zero, to hold them there moves base and length; then they may say nothing of g.
    """
    apart = (held.shared - free.shared)[:3]
    return float(apart @ np.linalg.solve(free.covariance[:3, :3], apart)) > MOVED


def _believed(solution: _Solution, known: KnownBefore) -> float:
    """Weight of the frames' information: 1 if their length agrees with the known one.

    Otherwise their unstated error is assumed to explain the difference: v / (d^2 - r^2), with d the difference of the
    tip's places along the arm, v and r^2 their variances.
    """
    information = float(known.information[2, 2])
    if not information > 0.0:
        return 1.0
    towards = known.information[2] / information  # change of the tip's place with g; that with the length is 1
    stated = float(towards @ solution.covariance[:SHARED, :SHARED] @ towards)
    apart = float(towards @ solution.shared - known.gradient[2] / information) ** 2
    return stated / (apart - 1.0 / information) if apart > CONTRADICTION * (stated + 1.0 / information) else 1.0


def _rows(stack: _Stack, order: int) -> list[int]:
    """The coordinates that the pooling changes: the offset, and those above the order."""
    return [0, *range(order + 1, stack.x.shape[1])]


def _weights(stack: _Stack, rows: list[int], tau: float) -> tuple[Array, Array]:
    spread = stack.covariance[:, rows][:, :, rows].copy()
    spread[:, 0, 0] += tau**2
    return np.asarray(np.linalg.inv(spread), dtype=float), np.asarray(np.linalg.slogdet(spread)[1])


def _solve(stack: _Stack, order: int, start: Array, prior: Array) -> _Solution:
    """g, the mean offset and tau for one order: generalised least squares and a likelihood step for tau, in turns."""
    rows = _rows(stack, order)
    tau = float(np.std(stack.x[:, 0])) if len(stack.x) > 1 else 0.5
    design = np.concatenate([stack.told[:, rows], np.zeros((len(stack.x), len(rows), 1))], axis=2)
    design[:, 0, -1] = -1.0  # the unknowns are (g, mean): residual = x + dx_dg g - mean
    target = stack.x[:, rows]
    solution = np.zeros(SHARED + 1)
    covariance, result = np.eye(SHARED + 1), PoolResult.MAX_TURNS
    for _ in range(MOST_TURNS):
        weight, _ = _weights(stack, rows, tau)
        normal = np.einsum("tri,trs,tsj->ij", design, weight, design)
        right = -np.einsum("tri,trs,ts->i", design, weight, target)
        normal[:SHARED, :SHARED] += stack.information + np.diag(prior**-2)
        right[:SHARED] += stack.gradient - start / prior**2
        normal[-1, -1] += 1e-6
        covariance = np.linalg.inv(normal)
        solution = covariance @ right
        residual = target + design @ solution
        updated = _likeliest_tau(stack, rows, residual)
        if abs(updated - tau) < 1e-6 + 1e-3 * tau:
            tau, result = updated, PoolResult.SETTLED
            break
        tau = updated
    weight, _ = _weights(stack, rows, tau)
    residual = target + design @ solution
    chi_square = float(np.einsum("tr,trs,ts->", residual, weight, residual))
    g = solution[:SHARED]
    shared_cost = float(g @ stack.information @ g - 2.0 * g @ stack.gradient)
    # the likelihood of the offset is common to all orders up to tau: compare the coordinates held at zero beyond it
    alone = stack.covariance[:, 0, 0] + tau**2
    objective = chi_square - float(np.sum(residual[:, 0] ** 2 / alone)) + shared_cost
    return _Solution(g, covariance, float(solution[-1]), tau, objective, result)


def _likeliest_tau(stack: _Stack, rows: list[int], residual: Array) -> float:
    """The offset's spread [rad]: the most likely on a grid, given the residuals (T, R)."""
    if not stack.rigid:
        return TURNS_FREELY
    grid = np.concatenate([[0.0], np.geomspace(1e-5, 3.0, 56)])
    cost = []
    for tau in grid:
        weight, log_size = _weights(stack, rows, float(tau))
        cost.append(np.einsum("tr,trs,ts->", residual, weight, residual) + log_size.sum())
    best = int(np.argmin(cost))
    # prefer a rigid mounting: a spread from noise alone would make q1 and q2 much less accurate
    real = grid[best] > LEAST_SPREAD and cost[0] - cost[best] > MOUNTING
    return float(grid[best]) if real else 0.0


def _alone(stack: _Stack, solution: _Solution) -> tuple[Array, Array]:
    """x and covariance of each frame with g put in, and nothing held: what the frame tells by itself."""
    told = stack.dx_dg @ solution.covariance[:SHARED, :SHARED] @ np.swapaxes(stack.dx_dg, 1, 2)
    covariance = stack.covariance + told
    return stack.x + stack.dx_dg @ solution.shared, 0.5 * (covariance + np.swapaxes(covariance, 1, 2))


def _update(stack: _Stack, solution: _Solution, order: int) -> tuple[Array, Array]:
    """x and covariance with g, mean and tau put in, and the coordinates above the order held at zero."""
    rows = _rows(stack, order)
    weight, _ = _weights(stack, rows, solution.tau)
    gain = stack.covariance[:, :, rows] @ weight
    free = stack.x + stack.dx_dg @ solution.shared
    innovation = -free[:, rows]
    innovation[:, 0] += solution.mean
    x = free + np.einsum("tkr,tr->tk", gain, innovation)
    covariance = held_covariance(stack.covariance, rows, gain, solution.tau)
    # derivative of x by the common unknowns (g, mean), whose covariance adds to every frame
    common = np.zeros((*stack.x.shape, SHARED + 1))
    common[:, :, :SHARED] = stack.dx_dg - gain @ stack.dx_dg[:, rows]
    common[:, :, SHARED] = gain[:, :, 0]
    covariance = covariance + common @ solution.covariance @ np.swapaxes(common, 1, 2)
    keep = slice(0, order + 1)
    return x[:, keep], 0.5 * (covariance + np.swapaxes(covariance, 1, 2))[:, keep, keep]

"""What all frames say together: the recording's parameters, a common base angle offset, the order that the data need.

Each accepted frame gives x = x_f + dx_dg (g - g0) with covariance C_f, and what it says about g. The base angle offset
is modelled as mean + random deviation of variance tau^2, estimated from the frames (empirical Bayes): a rigid mounting
gives tau = 0, and then the offset is known from all frames; a base that moves unseen gives a large tau, and each frame
keeps its own. A coordinate that is dropped is one whose value is held at zero. So both are the same linear update.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tentacle.signals import Array
from vision.kinematics import SHARED
from vision.settle import PRIOR
from vision.tracked_frame import TrackedFrame

LEAST_SPREAD = 3e-4  # rad: a base angle that moves by less than any servo's encoder resolves is an error of the edges
MOUNTING = 12.0  # gain in -2 log likelihood below which the base angle offset is held to be constant
CONTRADICTION = 9.0  # chi-square: a length that far off the one that is seen is none
TURNS_FREELY = 3.0  # rad, spread of a base angle of which nothing is known
COORDINATE_PENALTY = 5.0  # per coordinate and frame; Akaike's 2 takes a bubble that sits on the arm for a coordinate


@dataclass(frozen=True)
class Pooled:
    """x (T, K) and covariance (T, K, K) of the accepted frames, K = order + 1; NaN rows elsewhere.

    shared (G,) with shared_covariance (G, G). offset_mean, offset_spread [rad]: mean and tau of the base angle offset.
    evidence[n]: chi-square per frame that order n leaves in the coordinates above it (about their number when they are
    noise). inflation, staying: by how much the slow waves in the edges' errors widen the variance of a frame's x, and
    by how much more that of what all frames share.
    """

    x: Array
    covariance: Array
    order: int
    shared: Array
    shared_covariance: Array
    offset_mean: float
    offset_spread: float
    evidence: dict[int, float]
    inflation: float
    staying: float


@dataclass(frozen=True)
class KnownBefore:
    """What is known beside the frames: information (G, G) and gradient (G,) on g at the g that they used, and whether
    the base angle offset is one of a rigid mounting: where no log tells the base's own turning, it is not."""

    information: Array
    gradient: Array
    rigid: bool = True


NOTHING_KNOWN = KnownBefore(np.zeros((SHARED, SHARED)), np.zeros(SHARED))


@dataclass(frozen=True)
class _Stack:
    x: Array
    covariance: Array
    dx_dg: Array
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
        spread = np.diag(prior**2)
        return Pooled(nan, nan[:, :, None] * nan[:, None, :], chosen, start, spread, np.nan, np.nan, {}, 1.0, 1.0)
    good = [frame for frame in seen if frame.accepted]
    inflation, staying = _inflation(good)
    stack = _Stack(
        x=np.array([frame.x for frame in good]),
        covariance=inflation * np.array([frame.covariance for frame in good]),
        dx_dg=np.array([frame.dx_dg for frame in good]),
        information=sum((frame.shared_information for frame in good), np.zeros((SHARED, SHARED))) / inflation,
        gradient=sum((frame.shared_gradient for frame in good), np.zeros(SHARED)) / inflation,
        rigid=known.rigid,
    )
    evidence: dict[int, float] = {}
    solutions = {n: _solve(stack, n, start, prior) for n in range(min(2, fitted), fitted + 1)}
    full = solutions[fitted].objective
    for n, solution in solutions.items():
        evidence[n] = (solution.objective - full) / len(good)
    chosen = order or min(evidence, key=lambda n: evidence[n] + COORDINATE_PENALTY * n)
    if chosen not in solutions:
        solutions[chosen] = _solve(stack, chosen, start, prior)
    # coordinates held at zero that only another length bears are none to hold
    while order is None and chosen < fitted and _believed(solutions[chosen], known) < 1.0:
        chosen += 1
    believed = _believed(solutions[chosen], known)
    stack = replace(
        stack,
        information=believed * stack.information + known.information,
        gradient=believed * stack.gradient + known.gradient,
    )
    solution = _solve(stack, chosen, start, prior)
    solution = replace(solution, covariance=np.sqrt(staying) * solution.covariance)
    x, covariance = _update(stack, solution, chosen)
    # what the coordinates above hold beyond their noise is error, in a coordinate left out or in the edges: state it
    dropped = fitted - chosen
    if dropped:
        covariance = covariance * max(evidence.get(chosen, 0.0) / dropped, 1.0)
    result_x = np.full((len(seen), chosen + 1), np.nan)
    result_covariance = np.full((len(seen), chosen + 1, chosen + 1), np.nan)
    result_x[accepted], result_covariance[accepted] = x, covariance
    return Pooled(
        x=result_x,
        covariance=result_covariance,
        order=chosen,
        shared=start + solution.shared,
        shared_covariance=solution.covariance[:SHARED, :SHARED],
        offset_mean=solution.mean,
        offset_spread=solution.tau,
        evidence=evidence,
        inflation=inflation,
        staying=staying,
    )


def _believed(solution: _Solution, known: KnownBefore) -> float:
    """Share of the frames' information that is believed: 1 where their length agrees with the one known beside them.

    Else the error that they do not state is what makes both agree: v / (d^2 - r^2), with d the lengths' difference, v
    and r^2 their variances.
    """
    information = known.information[2, 2]
    if not information > 0.0:
        return 1.0
    stated = solution.covariance[2, 2]
    apart = float(solution.shared[2] - known.gradient[2] / information) ** 2
    return stated / (apart - 1.0 / information) if apart > CONTRADICTION * (stated + 1.0 / information) else 1.0


def _inflation(good: list[TrackedFrame]) -> tuple[float, float]:
    """How much wider the variance of q, and then that of what all frames share, is than independent edges make it.

    Both at least 1, both from the slow waves in the edges' errors: their power over all frames, and the share of it
    that stays from frame to frame (a bubble that sits, a mirror image that stands), which no number of frames averages.
    Of the latter the root is used: what stays with the arm errs in every x alike, and reaches what is told by the arm's
    turning in part only. In rendered tanks the whole of it stated errors 1.8 times too large, none of it up to 1.7
    times too small.
    """
    waves = np.array([frame.waves for frame in good])
    power = float(np.mean(waves**2))
    staying = len(waves) * float(np.mean(waves.mean(axis=0) ** 2)) / max(power, 1e-12)
    return max(power, 1.0), max(staying, 1.0)


def _rows(stack: _Stack, order: int) -> list[int]:
    """The coordinates that the pooling acts on: the offset, and those above the order."""
    return [0, *range(order + 1, stack.x.shape[1])]


def _weights(stack: _Stack, rows: list[int], tau: float) -> tuple[Array, Array]:
    spread = stack.covariance[:, rows][:, :, rows].copy()
    spread[:, 0, 0] += tau**2
    return np.asarray(np.linalg.inv(spread), dtype=float), np.asarray(np.linalg.slogdet(spread)[1])


def _solve(stack: _Stack, order: int, start: Array, prior: Array) -> _Solution:
    """g, the mean offset and tau for one order: generalised least squares and a likelihood step for tau, in turns."""
    rows = _rows(stack, order)
    tau = float(np.std(stack.x[:, 0])) if len(stack.x) > 1 else 0.5
    design = np.concatenate([stack.dx_dg[:, rows], np.zeros((len(stack.x), len(rows), 1))], axis=2)
    design[:, 0, -1] = -1.0  # the unknowns are (g, mean): residual = x + dx_dg g - mean
    target = stack.x[:, rows]
    solution = np.zeros(SHARED + 1)
    covariance = np.eye(SHARED + 1)
    for _ in range(30):
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
            tau = updated
            break
        tau = updated
    weight, _ = _weights(stack, rows, tau)
    residual = target + design @ solution
    chi_square = float(np.einsum("tr,trs,ts->", residual, weight, residual))
    g = solution[:SHARED]
    shared_cost = float(g @ stack.information @ g - 2.0 * g @ stack.gradient)
    # the likelihood of the offset alone is common to all orders up to tau: compare what is held at zero beyond it
    alone = stack.covariance[:, 0, 0] + tau**2
    objective = chi_square - float(np.sum(residual[:, 0] ** 2 / alone)) + shared_cost
    return _Solution(g, covariance, float(solution[-1]), tau, objective)


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
    # a rigid mounting is the simpler reading, and a spread that noise alone feigns would cost q1 and q2 dearly
    real = grid[best] > LEAST_SPREAD and cost[0] - cost[best] > MOUNTING
    return float(grid[best]) if real else 0.0


def _update(stack: _Stack, solution: _Solution, order: int) -> tuple[Array, Array]:
    """x and covariance with g, mean and tau put in, and the coordinates above the order held at zero."""
    rows = _rows(stack, order)
    weight, _ = _weights(stack, rows, solution.tau)
    gain = stack.covariance[:, :, rows] @ weight
    free = stack.x + stack.dx_dg @ solution.shared
    innovation = -free[:, rows]
    innovation[:, 0] += solution.mean
    x = free + np.einsum("tkr,tr->tk", gain, innovation)
    covariance = stack.covariance - gain @ np.swapaxes(stack.covariance[:, :, rows], 1, 2)
    # how x leans on the common unknowns (g, mean), whose own covariance adds to every frame
    common = np.zeros((*stack.x.shape, SHARED + 1))
    common[:, :, :SHARED] = stack.dx_dg - gain @ stack.dx_dg[:, rows]
    common[:, :, SHARED] = gain[:, :, 0]
    covariance = covariance + common @ solution.covariance @ np.swapaxes(common, 1, 2)
    keep = slice(0, order + 1)
    return x[:, keep], 0.5 * (covariance + np.swapaxes(covariance, 1, 2))[:, keep, keep]

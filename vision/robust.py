"""Robust least squares on edges, compiled: Tukey's biweight, edges that a bubble disturbs, means along the arm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tentacle.compiled import njit
from tentacle.signals import Array

TUKEY = 4.685  # 95 % efficiency for normal noise (Beaton and Tukey 1974)
MISFIT = 2.5  # times the usual profile residual: no plain step
PLAIN = 0.015  # of the contrast: least roughness of an edge if a codec has removed the noise
LEAP = 0.2  # of the contrast around: a larger difference is another object
TOGETHER = 3  # strange profiles among five neighbours that make a disturbance
STATION_NEIGHBOURS = 8  # stations beside a disturbed edge that count as disturbed
AROUND = 30  # stations to either side for the usual value
STRIDE = 15  # stations between two computations of the usual value


@njit(cache=True, nogil=True)
def robust_step(
    jacobian: Array, offset: Array, base: Array, sweeps: int, floor: float, held: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Step (K,) and weights (E,) of offset ~ jacobian step, iteratively reweighted; base (E,) >= 0 are prior weights.

    floor [px]: smallest scale of the residuals. held: prior of the step: information (K, K), and its product with the
    expected step (K,).
    """
    size = jacobian.shape[1]
    information, expected = held
    used = np.flatnonzero(base > 0)
    weight = base.copy()
    step = np.zeros(size)
    residual = np.empty(len(used))
    for _ in range(sweeps):
        normal, right = information.copy(), expected.copy()
        for e in used:
            for i in range(size):
                leaned = weight[e] * jacobian[e, i]
                right[i] += leaned * offset[e]
                for j in range(i + 1):
                    normal[i, j] += leaned * jacobian[e, j]
        for i in range(size):
            normal[i, i] = normal[i, i] * (1.0 + 1e-9) + 1e-12
            for j in range(i):
                normal[j, i] = normal[i, j]
        step = np.linalg.solve(normal, right)
        for k, e in enumerate(used):
            value = offset[e]
            for i in range(size):
                value -= jacobian[e, i] * step[i]
            residual[k] = np.sqrt(base[e]) * value
        scale = max(1.4826 * np.median(np.abs(residual)), floor)
        for k, e in enumerate(used):
            ratio = residual[k] / (TUKEY * scale)
            weight[e] = base[e] * (1.0 - ratio * ratio) ** 2 if abs(ratio) < 1.0 else 0.0
    return step, weight  # pyright: ignore[reportReturnType]


@njit(cache=True, nogil=True)
def disturbed(
    kind: Array, contrast: Array, course: Array, misfit: Array, usable: NDArray[np.bool_], floor: float
) -> NDArray[np.bool_]:
    """Edges (E,) whose profile is no plain step, or whose contrast jumps, with their neighbours: a bubble is there.

    The usual value is the local median along the same side, because light and smear change along the arm. course (E,)
    [grey]: the usual contrast of the edges. floor [grey]: a profile's residual below twice this value is never a
    disturbance.
    """
    odd = np.zeros(len(kind), dtype=np.bool_)
    for side in (0, 1):
        index = np.flatnonzero((kind == side) & usable)
        count = len(index)
        usual_share, usual_misfit = 0.0, 0.0
        strange = np.zeros(count, dtype=np.bool_)
        for k in range(count):
            if k % STRIDE == 0:
                around = index[max(k - AROUND, 0) : min(k + AROUND + STRIDE, count) : 2]
                usual_share = np.median(np.abs(contrast[around]) / course[around])
                usual_misfit = max(np.median(misfit[around]), floor)
            e = index[k]
            # a profile's contrast scatters by about its residual: a change by noise is no jump
            usual = usual_share * course[e]
            leaps = abs(abs(contrast[e]) - usual) > max(LEAP * usual, 4.0 * usual_misfit)
            strange[k] = leaps or misfit[e] > MISFIT * usual_misfit
        for k in range(count):  # a bubble is wider than one profile: a lone strange one is noise
            if strange[k] and np.count_nonzero(strange[max(k - 2, 0) : k + 3]) >= TOGETHER:
                e = index[k]
                for neighbour in range(max(e - STATION_NEIGHBOURS, 0), min(e + STATION_NEIGHBOURS + 1, len(kind))):
                    odd[neighbour] = odd[neighbour] or kind[neighbour] == side
    return odd


@njit(cache=True, nogil=True)
def neighbours_mean(kind: Array, values: Array, weight: Array, reach: int) -> tuple[Array, Array]:
    """Running weighted mean (E,) of values along each side, and its total weight."""
    smooth, support = np.zeros(len(kind)), np.zeros(len(kind))
    for side in (0, 1):
        index = np.flatnonzero(kind == side)
        count = len(index)
        total, share = 0.0, 0.0
        for k in range(-reach, count):
            enters, leaves = k + reach, k - reach - 1
            if enters < count:
                total += weight[index[enters]] * values[index[enters]]
                share += weight[index[enters]]
            if leaves >= 0:
                total -= weight[index[leaves]] * values[index[leaves]]
                share -= weight[index[leaves]]
            if k >= 0:
                smooth[index[k]] = total / max(share, 1e-6)
                support[index[k]] = share
    return smooth, support


@njit(cache=True, nogil=True)
def normal_matrix(jacobian: Array, weight: Array, residual: Array) -> tuple[Array, Array]:
    """J' W J (P, P) and J' W r (P,)."""
    size = jacobian.shape[1]
    normal, right = np.zeros((size, size)), np.zeros(size)
    for e in range(jacobian.shape[0]):
        if weight[e] <= 0:
            continue
        for i in range(size):
            leaned = weight[e] * jacobian[e, i]
            right[i] += leaned * residual[e]
            for j in range(i + 1):
                normal[i, j] += leaned * jacobian[e, j]
    for i in range(size):
        for j in range(i):
            normal[j, i] = normal[i, j]
    return normal, right

"""One frame's shape: Gauss-Newton on the edges' offsets, robust, first wide and then narrow."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import medfilt

from tentacle.signals import Array
from vision.edges import Edges, find_edges
from vision.kinematics import SHARED, Geometry, Outline, outline

TUKEY = 4.685  # 95 % efficiency for normal noise (Beaton and Tukey 1974)
BIWEIGHT = 1.17  # what the biweight takes from the variance of normal residuals, and adds to the estimate's own
LEAST_CONTRAST = 0.35  # of the median contrast: a fainter edge is another edge
MISFIT = 2.5  # times the usual profile residual
LEAP = 0.3  # of the contrast around
NEIGHBOURS = 4  # stations beside a disturbed edge that go with it
SLOPE_WINDOW = 31  # stations
LAGS = 24  # stations over which neighbouring edges' errors are watched for correlation
NARROW = 2.5  # px
FINAL = 1.2  # px: a short profile sees least of what else is near
ENDS = 14.0  # px along the arm within which its ends are looked for


@dataclass(frozen=True)
class Sight:
    """What stays the same from frame to frame: how edges look. blur [px], polarity (+1 dark arm), contrast [grey]."""

    blur: float
    polarity: float
    contrast: float


@dataclass(frozen=True)
class FrameFit:
    """A frame's fit about its working point, before the frames are pooled.

    x (K,): offset and q at the working g. information (K + G, K + G): normal matrix in edge noise units. sigma: standard
    deviation of an edge of unit weight. correlation (LAGS,): products of neighbouring residuals, by lag, over their
    variance. edges and expected stay for the judge.
    """

    x: Array
    information: Array
    gradient: Array
    sigma: float
    correlation: Array
    edges: Edges
    expected: Outline
    weight: Array


def refine(
    image: NDArray[np.uint8],
    geometry: Geometry,
    theta: float,
    x: Array,
    shared: Array,
    sight: Sight,
    rate: Array,
    exposure: float,
    reaches: tuple[float, ...] = (10.0, 5.0),
) -> FrameFit | None:
    """Fit x from a start that is within about the first reach [px]; None where too few edges are found.

    rate (K,) [rad/s] is the predicted speed of x (with that of theta added to its first entry): over the exposure [s] it
    smears the edge, which widens the profile that is looked for.
    """
    x = np.array(x, dtype=float)
    steps = [(reach, False) for reach in reaches] + [(NARROW, True), (FINAL, True)]
    ground: Array | float = 0.0
    for index, (reach, sharp) in enumerate(steps):
        final = index == len(steps) - 1
        expected = outline(geometry, theta, x, shared, stride=1 if sharp else 4)
        order = len(x)
        smear = np.abs(expected.jacobian[:, :order] @ rate) * exposure
        edges = find_edges(
            image, expected, geometry.lens, reach, sight.polarity, sharp, blur=sight.blur, smear=smear, ground=ground
        )
        usable = edges.found & (sight.polarity * edges.contrast > LEAST_CONTRAST * sight.contrast)
        usable &= expected.kind < 2  # the ends move with the recording's parameters, hardly with x
        if np.count_nonzero(usable) < 4 * order:
            return None
        if sharp:
            usable &= ~_disturbed(expected, edges, usable)
            if np.count_nonzero(usable) < 4 * order:
                return None
        step, weight, scale = _robust_step(expected.jacobian[:, :order], edges, usable, reach, sharp)
        if final:
            return _summary(image, geometry, x, expected, edges, usable, sight)
        if sharp:
            ground = _smooth_slope(expected, edges, weight)
        x = x + step
    return None


def _robust_step(jacobian: Array, edges: Edges, usable: NDArray[np.bool_], reach: float, sharp: bool) -> tuple[Array, Array, float]:
    """Iteratively reweighted least squares (Tukey's biweight): step (K,), weights (E,), scale [px]."""
    base = _trust(edges, usable) if sharp else usable.astype(float)
    weight, step, scale = base, np.zeros(jacobian.shape[1]), reach
    for sweep in range(4 if sharp else 6):
        normal = jacobian.T @ (weight[:, None] * jacobian)
        normal[np.diag_indices_from(normal)] *= 1.0 + 1e-9
        step = np.linalg.lstsq(normal, jacobian.T @ (weight * edges.offset), rcond=None)[0]
        residual = np.sqrt(base) * (edges.offset - jacobian @ step)
        scale = max(1.4826 * float(np.median(np.abs(residual[usable]))), 0.02 if sharp else 0.4)
        weight = base * np.clip(1.0 - (residual / (TUKEY * scale)) ** 2, 0.0, 1.0) ** 2
    return step, weight, scale


def _disturbed(expected: Outline, edges: Edges, usable: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Edges (E,) whose profile is no plain step, or whose contrast leaps: a bubble sits there. Its neighbours go with it."""
    ordinary = max(float(np.median(edges.misfit[usable])), 0.3)
    odd = np.zeros(len(usable), dtype=np.bool_)
    for side in (0, 1):
        index = np.flatnonzero(expected.kind == side)
        window = min(2 * (len(index) // 16) + 1, 61)
        contrast = np.abs(edges.contrast[index])
        around = medfilt(contrast, window)
        usual = MISFIT * np.maximum(medfilt(edges.misfit[index], window), 0.5 * ordinary)
        strange = (edges.misfit[index] > usual) | (np.abs(contrast - around) > LEAP * around)
        odd[index] = np.convolve(strange & usable[index], np.ones(2 * NEIGHBOURS + 1), mode="same") > 0.5
    return odd


def _smooth_slope(expected: Outline, edges: Edges, weight: Array) -> Array:
    """The ground's slope (E,) [grey/px], a running mean over each side's sound edges: single profiles are too noisy."""
    smooth = np.zeros(len(weight))
    window = np.ones(SLOPE_WINDOW)
    for side in (0, 1):
        index = np.flatnonzero(expected.kind == side)
        share = weight[index]
        total = np.convolve(share * edges.slope[index], window, mode="same")
        smooth[index] = total / np.maximum(np.convolve(share, window, mode="same"), 1.0)
    return smooth


def _trust(edges: Edges, usable: NDArray[np.bool_]) -> Array:
    """Weights (E,) in 0 to 1 by what each profile tells; the clearest quarter counts alike, as noise is not all its error."""
    top = max(float(np.quantile(edges.information[usable], 0.75)), 1e-12)
    return np.where(usable, np.minimum(edges.information / top, 1.0), 0.0)


def _summary(
    image: NDArray[np.uint8],
    geometry: Geometry,
    x: Array,
    expected: Outline,
    edges: Edges,
    usable: NDArray[np.bool_],
    sight: Sight,
) -> FrameFit:
    """Last step and normal equations in (x, g), with weights by what each profile tells and by how well it fits."""
    order = len(x)
    step, weight, scale = _robust_step(expected.jacobian[:, :order], edges, usable, NARROW, True)
    for kind in (2, 3):
        end, offset = _end(image, geometry, expected, kind, sight)
        weight[end], edges.offset[end] = _trust(edges, usable).max() * (offset != 0.0), offset
    full = expected.jacobian
    residual = edges.offset - full[:, :order] @ step
    information = full.T @ (weight[:, None] * full)
    gradient = full.T @ (weight * residual)
    sway = _sway(np.sqrt(weight) * residual, weight, expected.kind)
    used = np.count_nonzero(sway)
    variance = BIWEIGHT * float(sway @ sway) / max(used - order - SHARED, 1)
    return FrameFit(
        x=x + step,
        information=information,
        gradient=gradient,
        sigma=float(np.sqrt(variance)),
        correlation=_correlation(sway),
        edges=edges,
        expected=expected,
        weight=weight,
    )


def _end(image: NDArray[np.uint8], geometry: Geometry, expected: Outline, kind: int, sight: Sight) -> tuple[Array, Array]:
    """Indices of an end's edges, and their offsets [px]; 0 where the end is not seen as the sides are (a clamp hides it)."""
    index = np.flatnonzero(expected.kind == kind)
    rows = Outline(*(getattr(expected, name)[index] for name in ("points", "normals", "depth", "jacobian", "s", "kind")))
    nothing = np.zeros(len(index))
    coarse = find_edges(image, rows, geometry.lens, ENDS, sight.polarity, sharp=False)
    like = sight.polarity * coarse.contrast
    alike = coarse.found & (like > 0.5 * sight.contrast) & (like < 1.6 * sight.contrast)
    if np.count_nonzero(alike) < max(0.7 * len(index), 1):
        return index, nothing
    shift = float(np.median(coarse.offset[alike]))
    rows = replace(rows, points=rows.points + shift * rows.normals)
    sharp = find_edges(image, rows, geometry.lens, NARROW, sight.polarity, sharp=True, blur=sight.blur)
    middle = float(np.median(sharp.offset[sharp.found])) if sharp.found.any() else 0.0
    agree = sharp.found & (np.abs(sharp.offset - middle) < 1.0)
    if np.count_nonzero(agree) < max(0.7 * len(index), 1):
        return index, nothing
    return index, np.where(agree, shift + sharp.offset, 0.0)


def _sway(whitened: Array, weight: Array, kind: Array) -> Array:
    """Where both sides of a station are seen: what their residuals say about its centre (S,), 0 elsewhere.

    What widens both sides alike (a wrong blur, a shadow) does not move the centre, so it is no part of the noise in q.
    """
    left, right = kind == 0, kind == 1
    both = (weight[left] > 0) & (weight[right] > 0)
    return np.where(both, (whitened[left] - whitened[right]) / np.sqrt(2.0), 0.0)


def _correlation(sway: Array) -> Array:
    """Autocorrelation (LAGS,) of the weighted residuals along the arm; a lost edge counts as zero."""
    power = max(float(sway @ sway), 1e-12)
    return np.array([float(sway[lag:] @ sway[:-lag]) / power for lag in range(1, LAGS + 1)])

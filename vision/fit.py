"""One frame's shape: Gauss-Newton on the edges' offsets, robust, first wide and then narrow."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tentacle.signals import Array
from vision.edges import Edges, find_edges
from vision.kinematics import SHARED, Geometry, Outline, outline

TUKEY = 4.685  # 95 % efficiency for normal noise (Beaton and Tukey 1974)
BIWEIGHT = 1.17  # what the biweight takes from the variance of normal residuals, and adds to the estimate's own
LEAST_CONTRAST = 0.35  # of the median contrast: a fainter edge is another edge
LAGS = 24  # stations over which neighbouring edges' errors are watched for correlation
NARROW = 2.5  # px
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
    steps = [(reach, False) for reach in reaches] + [(NARROW, True), (NARROW, True)]
    for index, (reach, sharp) in enumerate(steps):
        final = index == len(steps) - 1
        expected = outline(geometry, theta, x, shared, stride=1 if sharp else 4)
        order = len(x)
        smear = np.abs(expected.jacobian[:, :order] @ rate) * exposure
        blur = np.sqrt(sight.blur**2 + smear**2 / 12.0)  # the variance of a box is its width squared over 12
        edges = find_edges(image, expected, geometry.lens, reach + 0.5 * smear.max(initial=0.0), blur, sight.polarity, sharp)
        usable = edges.found & (sight.polarity * edges.contrast > LEAST_CONTRAST * sight.contrast)
        usable &= expected.kind < 2  # the ends move with the recording's parameters, hardly with x
        if np.count_nonzero(usable) < 4 * order:
            return None
        step, weight, scale = _robust_step(expected.jacobian[:, :order], edges, usable, reach, sharp)
        if final:
            return _summary(image, geometry, x, expected, edges, usable, sight)
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
    sides = weight * (expected.kind < 2)
    used = np.count_nonzero(sides > 0)
    variance = BIWEIGHT * float(np.sum(sides * residual**2)) / max(used - order - SHARED, 1)
    return FrameFit(
        x=x + step,
        information=information,
        gradient=gradient,
        sigma=float(np.sqrt(variance)),
        correlation=_correlation(np.sqrt(sides) * residual, expected.kind),
        edges=edges,
        expected=expected,
        weight=weight,
    )


def _end(image: NDArray[np.uint8], geometry: Geometry, expected: Outline, kind: int, sight: Sight) -> tuple[Array, Array]:
    """Indices of an end's edges, and their offsets [px]; 0 where the end is not seen as the sides are (a clamp hides it)."""
    index = np.flatnonzero(expected.kind == kind)
    rows = Outline(*(getattr(expected, name)[index] for name in ("points", "normals", "depth", "jacobian", "s", "kind")))
    nothing = np.zeros(len(index))
    coarse = find_edges(image, rows, geometry.lens, ENDS, 1.0, sight.polarity, False)
    like = sight.polarity * coarse.contrast
    alike = coarse.found & (like > 0.5 * sight.contrast) & (like < 1.6 * sight.contrast)
    if np.count_nonzero(alike) < max(0.7 * len(index), 1):
        return index, nothing
    shift = float(np.median(coarse.offset[alike]))
    rows = replace(rows, points=rows.points + shift * rows.normals)
    sharp = find_edges(image, rows, geometry.lens, NARROW, sight.blur, sight.polarity, True)
    middle = float(np.median(sharp.offset[sharp.found])) if sharp.found.any() else 0.0
    agree = sharp.found & (np.abs(sharp.offset - middle) < 1.0)
    if np.count_nonzero(agree) < max(0.7 * len(index), 1):
        return index, nothing
    return index, np.where(agree, shift + sharp.offset, 0.0)


def _correlation(whitened: Array, kind: Array) -> Array:
    """Autocorrelation (LAGS,) of the weighted residuals along both sides; a lost edge counts as zero."""
    total, power = np.zeros(LAGS), 0.0
    for side in (0, 1):
        row = whitened[kind == side]
        power += float(row @ row)
        for lag in range(1, min(LAGS + 1, len(row))):
            total[lag - 1] += float(row[lag:] @ row[:-lag])
    return total / max(power, 1e-12)

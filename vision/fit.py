"""One frame's shape: robust Gauss-Newton on the edges' offsets, first with long profiles, then with short ones."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct

from tentacle.signals import Array
from vision.arm_end import EndSearch, agrees_with_sides, arm_end
from vision.edge_look import EdgeLook
from vision.edges import Before, Edges, Optics, fit_edges, measure_edges, search_edges
from vision.kinematics import CORNER_PIXELS, SHARED, Geometry, Outline, outline
from vision.light import Light
from vision.motion import ShapeMotion, Sweep, sweep
from vision.robust import PLAIN, disturbed, neighbours_mean, normal_matrix, robust_step
from vision.usual_bend import usual_bend
from vision.width import another_width

BIWEIGHT = 1.27  # factors of the biweight on the variance of normal residuals (.758), and on the estimate's variance
LEAST_EDGE_CONTRAST = 0.35  # of the median contrast: a fainter edge is another edge
NARROW = 2.5  # px
FINAL = 1.2  # px: a short profile contains the fewest other objects
END_PIXELS = 8.0  # px along the arm: range of the search for its ends, once the recording's scale is known
TRUST_STRETCH = 10  # stations to either side over which the information is averaged and limited
END_ERROR = 1.0  # variance of an end's common error, over that of one edge
SIDE_ERROR = 0.3  # px: typical error of an edge, for the prior on the usual bend
COARSE_STEP = np.array([1.0, 3.0, 8.0, 20.0, 20.0, 20.0])  # rad: prior size of the first step, if few edges are found
MOST_TURN = 3.0 * np.pi  # rad from base to tip
MOST_BEND = 2.5  # curvature times the half thickness
SLOW = slice(8, 25)  # cosine orders along the arm: longer than a profile's surroundings, shorter than the shapes of q


@dataclass(frozen=True)
class FrameFit:
    """A frame's fit about its working point, before the frames are pooled.

    x (K,): offset and q at the working g. information (K + G, K + G), gradient (K + G,): the edges' normal equations
    for a noise of 1 px. held (K, K): information of the arm's usual bend on x, in the same units. sigma [px]: standard
    deviation of an edge of unit weight. waves (W,): the residuals' slow waves along the arm; edges that err
    independently have a variance of 1 in each. edges, expected and weight (E,) stay for the judge, own_contrast (E,)
    [grey], of each edge by itself and 0 where none was found, and own_light (E,) [grey], the lighter side of it, for
    the sight.
    """

    x: Array
    information: Array
    gradient: Array
    held: Array
    sigma: float
    waves: Array
    edges: Edges
    expected: Outline
    weight: Array
    own_contrast: Array
    own_light: Array


@dataclass(frozen=True)
class Exposure:
    """A picture with the middle of its exposure at t [s]. Over span [s] the motion smears the edges, and the expected
    profile is smeared too. light: from earlier frames.
    """

    image: NDArray[np.uint8]
    t: float
    span: float
    motion: ShapeMotion
    light: Light | None = None


@dataclass(frozen=True)
class TrackedArm:
    """The declared arm at the motor's angle theta [rad], with what all frames share (G,)."""

    geometry: Geometry
    theta: float
    shared: Array

    def outline(self, x: Array, stride: int = 1) -> Outline:
        """The expected edges of a shape."""
        return outline(self.geometry, self.theta, x, self.shared, stride)


def refine(
    picture: Exposure,
    arm: TrackedArm,
    x: Array,
    sight: EdgeLook,
    reaches: tuple[float, ...] = (10.0, 5.0),
    ends: float = END_PIXELS,
) -> FrameFit | None:
    """Fit x from a start that is within about the first reach [px]; None where too few edges are found.

    ends [px]: range of the search for the two ends along the arm.
    """
    image, geometry = picture.image, arm.geometry
    optics = Optics(geometry.lens, sight.blur, sight.polarity)
    x = np.array(x, dtype=float)
    order = len(x)
    for reach in reaches:
        expected = arm.outline(x, stride=4)
        edges = search_edges(image, expected, geometry.lens, reach, sight.polarity)
        base = _usable(edges, expected, sight).astype(float)
        if np.count_nonzero(base) < 4 * order:
            return None
        jacobian = np.ascontiguousarray(expected.jacobian[:, :order])
        information, expects = usual_bend(x, 1.0)
        held = (information + np.diag(1.0 / COARSE_STEP[:order] ** 2), expects)
        x = x + robust_step(jacobian, edges.offset, base, 6, 0.4, held)[0]
        if _wild(geometry, x):
            return None
    sound, first = np.zeros(0, dtype=np.bool_), None
    total = x + arm.theta * (np.arange(order) == 0)
    expected = arm.outline(x)
    # the sweep is computed once: the later change of place is too small to change it
    swept = sweep(geometry, total, arm.shared, expected, picture.motion.at(picture.t, total), picture.span)
    for reach in (NARROW, FINAL):
        expected = expected if first is None else arm.outline(x)
        jacobian = np.ascontiguousarray(expected.jacobian[:, :order])
        place = (image, expected, optics, reach, swept)
        if first is None:
            edges = fit_edges(*place)
        else:
            edges = measure_edges(*place, Before(first, sound, picture.light, sight.fade_at(expected.s)))
        usable = _usable(edges, expected, sight) & _clear_of_ends(geometry, arm.shared, expected, swept)
        floor = max(0.5 * ordinary_misfit(edges, usable), PLAIN * sight.contrast)
        course = sight.contrast_at(expected.s)
        usable &= ~disturbed(expected.kind, edges.contrast, course, edges.misfit, usable, floor)
        usable &= ~another_width(expected, edges, usable, sight.wider)
        usable &= True if first is None else sound
        if np.count_nonzero(usable) < 4 * order:
            return None
        base = _trust(edges, expected.kind, usable)
        step, weight = robust_step(jacobian, edges.offset, base, 4, 0.02, usual_bend(x, SIDE_ERROR))
        if first is not None:
            most, find = base.max(), EndSearch(optics, sight, ends, ordinary_misfit(edges, weight > 0))
            for kind in (2, 3):
                end, offset = arm_end(image, expected, kind, find, swept)
                if not agrees_with_sides(expected, end, offset, weight > 0):
                    offset = np.zeros(len(end))
                # A real end is not a perfect cut: the common error of its edges limits their total weight.
                weight[end] = most * (offset != 0.0) / (1.0 + np.count_nonzero(offset) * END_ERROR)
                edges.offset[end] = offset
            fit = _summary(x + step, expected, edges, weight, step)
            light = np.maximum(first.level, first.level + first.contrast)
            return replace(fit, own_contrast=np.where(first.found, first.contrast, 0.0), own_light=light)
        x, first, sound = x + step, edges, weight > 0
        if _wild(geometry, x):
            return None
    return None


def _wild(geometry: Geometry, x: Array) -> bool:
    """Whether a step has reached a shape that an arm cannot have: it turns too far, or bends into its own thickness.

    On the inside of such a bend an edge would stand for an unbounded stretch, and so would the work on it.
    """
    s = np.linspace(0.0, 1.0, 41)
    bend = sum((x[k] * s ** (k - 1) for k in range(1, len(x))), np.zeros(len(s)))
    turned = np.concatenate([[0.0], np.cumsum(0.5 * (bend[1:] + bend[:-1]))]) / (len(s) - 1)
    thick = float(geometry.radius.max()) / geometry.length
    return not (np.ptp(turned) < MOST_TURN and np.abs(bend).max() * thick < MOST_BEND)


def _usable(edges: Edges, expected: Outline, sight: EdgeLook) -> NDArray[np.bool_]:
    """Side edges (E,) that were found with enough contrast. (The ends depend on the recording's parameters, hardly on
    x.)
    """
    return (
        edges.found
        & (sight.polarity * edges.contrast > LEAST_EDGE_CONTRAST * sight.contrast_at(expected.s))
        & (expected.kind < 2)
    )


def _clear_of_ends(geometry: Geometry, shared: Array, expected: Outline, swept: Sweep) -> NDArray[np.bool_]:
    """Edges (E,) over which no end of the arm moves during the exposure."""
    away = np.minimum(expected.s, 1.0 - expected.s) * geometry.length * (1.0 + shared[2])
    return away > CORNER_PIXELS - 1.0 + 0.5 * swept.slip


def ordinary_misfit(edges: Edges, usable: NDArray[np.bool_]) -> float:
    """The usual rms of a profile's residual [grey]."""
    return max(float(np.median(edges.misfit[usable])), 0.3) if usable.any() else 0.3


def _trust(edges: Edges, kind: Array, usable: NDArray[np.bool_]) -> Array:
    """Weights (E,) by the information of each profile, limited to that of the best quarter, because noise is not the
    only error.
    """
    around, _ = neighbours_mean(kind, edges.information, usable.astype(float), TRUST_STRETCH)
    told = around[usable]
    top = max(float(np.partition(told, (3 * len(told)) // 4)[(3 * len(told)) // 4]), 1e-12)
    return np.where(usable, edges.information / np.maximum(around, top), 0.0)


def _summary(x: Array, expected: Outline, edges: Edges, weight: Array, step: Array) -> FrameFit:
    """Normal equations in (x, g), with weights by the information and the misfit of each profile."""
    order = len(x)
    residual = edges.offset - expected.jacobian[:, :order] @ step
    information, gradient = normal_matrix(expected.jacobian, weight, residual)
    sway = _sway(np.sqrt(weight) * residual, weight, expected.kind)
    used = np.count_nonzero(sway)
    variance = BIWEIGHT * float(sway @ sway) / max(used - order - SHARED, 1)
    sigma = max(float(np.sqrt(variance)), 1e-3)
    held, _ = usual_bend(x, sigma)
    return FrameFit(
        x=x,
        information=information,
        gradient=gradient,
        held=held,
        sigma=sigma,
        waves=_waves(sway),
        edges=edges,
        expected=expected,
        weight=weight,
        own_contrast=edges.contrast,
        own_light=edges.level,
    )


def _sway(whitened: Array, weight: Array, kind: Array) -> Array:
    """Residual of a station's centre (S,) from its two sides, 0 if a side is not seen.

    An error that widens both sides alike (a wrong blur, a shadow) does not move the centre, so it does not act on q.
    """
    left, right = kind == 0, kind == 1
    both = (weight[left] > 0) & (weight[right] > 0)
    return np.where(both, (whitened[left] - whitened[right]) / np.sqrt(2.0), 0.0)


def _waves(sway: Array) -> Array:
    """Slow waves of the sway (cosine orders 8 to 24) over the root of its mean power.

    Slower waves are absorbed by the fit. Smooth errors of light, or bubbles, show in these orders, and add to the error
    of q.
    """
    waves = np.asarray(dct(sway, norm="ortho"), dtype=float)
    return waves[SLOW] / np.sqrt(max(float(np.mean(waves**2)), 1e-12))


def fit_outline(fit: FrameFit) -> Array:
    """The fitted outline, base to tip and back, some 80 points (N, 2) [px]."""
    sides = [fit.expected.points[fit.expected.kind == side] for side in (0, 1)]
    step = max(len(sides[0]) // 40, 1)
    return np.concatenate([sides[0][::step], sides[1][::-1][::step]])

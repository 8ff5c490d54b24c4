"""The observed shape of the arm, as numbers with a covariance, to be compared with a model's prediction.

    R (measured - predicted) ~ N(0, 1)

Each frame's midline is reduced by least squares to shape coefficients [base angle offset, shift x, shift y, log scale,
z_1 .. z_m]. R is the root of their information matrix. In this order the last rows of R belong to the highest curvature
coordinates alone, so they show directly whether a further coordinate is needed. Markers are compared as points.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import (
    Array,
    angle_basis,
    integration_to,
    legendre_to_monomial,
    midline,
    monomial_angle,
    points_beside,
    quadrature,
)
from tentacle.signals import Markers, Midline, ShapeTrack

SHAPE_NODES = 16
# Noise deviations: a tracker states its noise to 30 % (benchmarks/vision.py), and the rest of its error is slow.
TRACKER_ERROR = 0.83
POSE = 4  # base angle offset [rad], shift x, shift y [m], log of the apparent scale


@dataclass(frozen=True)
class ShapeObservation:
    """Shape coefficients of T frames in the order [offset, shift x, shift y, log scale, z_1 .. z_m] (Legendre z).

    t (T,) [s]; theta (T,) [rad] the recorded base angle that the offset is counted from; coefficients (T, K); length
    [m] of the arm; root (T, K, K) upper triangular whitening; residual_chi2 (T,) and residual_count (T,): the
    chi-square of the frame's points about the fitted shape, and its degrees of freedom (0, 0 where unknown).
    """

    t: Array
    theta: Array
    length: float
    coefficients: Array
    root: Array
    residual_chi2: Array
    residual_count: Array

    @property
    def order(self) -> int:
        """How many curvature coordinates were measured."""
        return self.coefficients.shape[1] - POSE

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Frames (T,) with weight: the shape was found and accepted."""
        return self.root[:, -1, -1] > 0

    @property
    def tracked(self) -> bool:
        """Whether this is a video's track: its base is known, so that a frame has no unknown shift."""
        return bool(np.all(self.root[self.seen][:, 1, 1] == 0.0))

    def predict(self, q: Array, theta: Array, roll: Array, scale: Array, shift: Array) -> Array:
        """Whitened residuals (T, K, B) of q (T, n, B), theta (T, B), camera roll (B,), excess scale (B,), shift (2,
        B).
        """
        n = q.shape[1]
        z = np.linalg.solve(legendre_to_monomial(n), q)
        error = np.repeat(self.coefficients[:, :, None], q.shape[2], axis=2)
        error[:, 0] -= theta - self.theta[:, None] + roll
        error[:, 1:3] -= shift
        error[:, 3] -= np.log1p(scale)
        kept = min(n, self.order)
        error[:, POSE : POSE + kept] -= z[:, :kept]
        return np.matmul(self.root, error)

    def first(self, count: int) -> ShapeObservation:
        """The first frames alone."""
        frames = ("t", "theta", "coefficients", "root", "residual_chi2", "residual_count")
        return replace(self, **{name: getattr(self, name)[:count] for name in frames})

    def subtract_residual(self, rows: Array) -> ShapeObservation:
        """The observation minus whitened residuals (T, K): the shapes of the model that has these residuals."""
        change = np.einsum("tkl,tl->tk", np.linalg.pinv(self.root), rows)
        return replace(self, coefficients=self.coefficients - change)


@dataclass(frozen=True)
class MarkerObservation:
    """Markers as points: t (T,), s (M,), d (M,) [m], xy (T, M, 2) [m], sigma [m] of each coordinate, names (M) where
    they have any; NaN rows count nothing.
    """

    t: Array
    theta: Array
    length: float
    s: Array
    d: Array
    xy: Array
    sigma: float
    names: tuple[str, ...] = ()

    def predict(self, q: Array, theta: Array, roll: Array, scale: Array, shift: Array) -> Array:
        """Whitened residuals (T, 2 M, B); 0 where a marker was not seen."""
        shape = np.moveaxis(q, 1, -1)  # (T, B, n)
        points = points_beside(shape, theta + roll, self.length, self.s, self.d) * (1.0 + scale)[:, None, None]
        points = points + shift.T[:, None, :]
        error = (self.xy[:, None] - points) / self.sigma
        return np.nan_to_num(np.moveaxis(error.reshape(*error.shape[:2], -1), 1, -1))

    def first(self, count: int) -> MarkerObservation:
        """The first frames alone."""
        return replace(self, t=self.t[:count], theta=self.theta[:count], xy=self.xy[:count])

    def subtract_residual(self, rows: Array) -> MarkerObservation:
        """The observation minus whitened residuals (T, 2 M): the markers of the model that has these residuals."""
        return replace(self, xy=self.xy - self.sigma * rows.reshape(self.xy.shape))


@dataclass(frozen=True)
class Tracker:
    """How a midline was measured. sigma [m]: its standard deviation if the data state none.

    by_edges: a tracker followed the arm's edges from a known base at a known scale. Shift and scale then stay 0, and
    only the distance along the normals counts. rigid: the base angle is the recorded one in every frame, as the
    mounting does not give.
    """

    sigma: float
    by_edges: bool = False
    rigid: bool = False


def fit_shapes(data: Midline, theta: Array, length: float, order: int, tracker: Tracker) -> ShapeObservation:
    """Least-squares shape coefficients of every frame of a midline.

    theta (T,) recorded base angle. Frames with too few points get root 0 and have no weight. Gauss-Newton from the
    straight arm along the points' mean direction; all frames at once.
    """
    frames, points = data.xy.shape[:2]
    stated = np.where(np.isfinite(data.sigma) & (data.sigma > 0), data.sigma, tracker.sigma)
    seen = np.isfinite(data.xy).all(axis=2)
    weight = np.where(seen, 1.0 / stated, 0.0)
    xy = np.nan_to_num(data.xy)
    to_monomial = legendre_to_monomial(order)
    count = POSE + order
    known = [*([0] if tracker.rigid else []), *(range(1, POSE) if tracker.by_edges else [])]
    usable = seen.sum(axis=1) * 2 >= count + 2
    coefficients = np.zeros((frames, count))
    steps = 12
    jacobian = np.zeros((frames, points, 2, count))
    normal, error = np.zeros((frames, count, count)), np.zeros_like(xy)
    for _ in range(steps):
        q, angle = coefficients[:, POSE:] @ to_monomial.T, theta + coefficients[:, 0]
        shape = midline(q, angle, length, data.s)
        size = np.exp(coefficients[:, 3])[:, None, None]
        predicted = size * shape + coefficients[:, None, 1:3]
        jacobian[..., 0] = size * np.stack([-shape[..., 1], shape[..., 0]], axis=-1)
        jacobian[..., 0, 1] = 1.0
        jacobian[..., 1, 2] = 1.0
        jacobian[..., 3] = size * shape
        jacobian[..., POSE:] = size[..., None] * _angle_sensitivity(q, angle, length, data.s, order)
        error = (xy - predicted) * weight[..., None]
        if tracker.by_edges:
            phi = angle[:, None] + monomial_angle(q, data.s)
            across = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
            error = np.sum(error * across, axis=2, keepdims=True) * across
            jacobian[:] = np.einsum("tpx,tpxk->tpk", across, jacobian)[:, :, None] * across[..., None]
        jacobian[..., known] = 0.0
        weighted = (jacobian * weight[..., None, None]).reshape(frames, 2 * points, count)
        normal = np.einsum("tpk,tpl->tkl", weighted, weighted)
        normal[:, known, known] = 1.0
        normal[~usable] = np.eye(count)
        # Levenberg's share keeps the first steps of strongly bent frames from overshooting.
        gradient = np.einsum("tpk,tp->tk", weighted, error.reshape(frames, -1))
        update = np.linalg.solve(normal, gradient[..., None])[..., 0]
        limit = np.minimum(1.0, 1.5 / np.maximum(np.abs(update).max(axis=1), 1e-12))
        coefficients = coefficients + update * limit[:, None] * usable[:, None]
        if np.abs(update[usable]).max(initial=0.0) < 1e-10:
            break
    root = np.swapaxes(np.linalg.cholesky(normal), 1, 2) * usable[:, None, None]
    chi2 = np.where(usable, np.einsum("tpx,tpx->t", error, error), 0.0)
    left = np.where(usable, 2 * seen.sum(axis=1) - count, 0)
    return ShapeObservation(data.t, theta, length, coefficients, root, chi2, left.astype(float))


def _angle_sensitivity(q: Array, angle: Array, length: float, s: Array, order: int) -> Array:
    """d r(s) / dz = -L int_0^s n(v) beta(v) dv (T, P, 2, order), beta = d alpha / dz (derivative of eq. 3)."""
    rule = quadrature(SHAPE_NODES)
    phi = angle[:, None] + monomial_angle(q, rule.s)
    weights = length * integration_to(SHAPE_NODES, s)
    beta = angle_basis(order, rule.s)
    normal = np.stack([np.cos(phi), np.sin(phi)], axis=1)  # (T, 2, N)
    turned = normal[:, :, :, None] * beta
    return -np.moveaxis(np.tensordot(turned, weights, axes=([2], [1])), (1, 2, 3), (2, 3, 1))


def from_track(track: ShapeTrack, theta: Array, length: float) -> ShapeObservation:
    """A video's shape track as an observation. The recording has one scale and one shift, with their own sigma.

    theta (T,) is the recorded base angle at the frames. Rejected frames have no weight.
    """
    order = track.coefficients.shape[1] - 1
    count = POSE + order
    frames = track.t.size
    coefficients = np.zeros((frames, count))
    root = np.zeros((frames, count, count))
    from_monomial = np.linalg.inv(legendre_to_monomial(order))
    accepted = track.accepted & np.isfinite(track.coefficients).all(axis=1)
    good = np.flatnonzero(accepted)
    coefficients[good, 0] = track.coefficients[good, 0]
    coefficients[good, POSE:] = track.coefficients[good, 1:] @ from_monomial.T
    transform = np.zeros((1 + order, 1 + order))
    transform[0, 0] = 1.0
    transform[1:, 1:] = from_monomial
    covariance = transform @ track.covariance[good] @ transform.T
    inner = np.swapaxes(np.linalg.cholesky(np.linalg.inv(covariance)), 1, 2)
    kept = np.array([0, *range(POSE, count)])
    root[np.ix_(good, kept, kept)] = inner
    # The recording has one scale: its information is spread evenly over the frames, so that the sum is right.
    coefficients[good, 3] = np.log(track.scale)
    if good.size and np.isfinite(track.scale_sigma) and track.scale_sigma > 0:
        root[good, 3, 3] = 1.0 / (track.scale_sigma * np.sqrt(good.size))
    nothing = np.zeros(frames)
    return ShapeObservation(track.t, theta, length, coefficients, root, nothing, nothing)


def from_markers(markers: Markers, theta: Array, length: float, sigma: float) -> MarkerObservation:
    """Markers as an observation, with the noise sigma [m] of each coordinate."""
    return MarkerObservation(markers.t, theta, length, markers.s, markers.d, markers.xy, sigma, markers.names)

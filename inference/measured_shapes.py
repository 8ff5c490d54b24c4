"""From what was measured to an observation: the least-squares shape of every frame's midline, tracks, markers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.curvature import (
    Array,
    angle_basis,
    integration_to,
    legendre_to_monomial,
    midline,
    monomial_angle,
    quadrature,
)
from inference.observation import POSE, MarkerObservation, ShapeObservation
from tentacle.signals import Markers, Midline, ShapeTrack

SHAPE_NODES = 16
SETTLED = 1e-4  # rad, m and 1: last step of a frame that has converged, a hundredth of what a camera resolves


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

    theta (T,) recorded base angle. Frames with too few points, and frames whose fit does not converge, get root 0 and
    have no weight. Gauss-Newton from the straight arm along the points' mean direction; all frames at once.
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
    steps, last = 12, np.zeros(frames)
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
        last = np.abs(update).max(axis=1)
        if last[usable].max(initial=0.0) < 1e-10:
            break
    usable &= last < SETTLED
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

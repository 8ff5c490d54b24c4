"""From what was measured to an observation: the least-squares shape of every frame's midline, tracks, markers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import (
    Array,
    angle_basis,
    integration_to,
    legendre_to_monomial,
    midline,
    monomial_angle,
    quadrature,
)
from inference.marker_observation import MarkerObservation
from inference.observation import POSE, ShapeObservation
from tentacle.signals import Markers, Midline, ShapeTrack

SHAPE_NODES = 16
SETTLED = 1e-4  # rad, m and 1: last step of a frame that has converged, a hundredth of what a camera resolves
WIDENING, STEPS = 8, 20  # steps in which the shapes' spread is estimated, and in all


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
    """Shape coefficients z of every frame of a midline, linearised about its likeliest shape z_0.

        z = z_0 + N^-1 J' W (xy - f(z_0)),   N = J' W J = root' root,   J = df/dz at z_0
        z_0 = argmin |xy - f(z)|^2_W + sum_k z_k^2 / tau_k^2

    tau_k is the spread of curvature coordinate k over the frames, found by expectation and maximisation (Dempster,
    Laird and Rubin 1977). A frame alone leaves its high coordinates open by a radian where the noise is a hundredth of
    the length. Linearised about such a shape, the frame would be judged wrongly; about z_0, noise of any size does
    not matter.

    theta (T,) recorded base angle. Frames with too few points, and frames whose fit does not converge, get root 0 and
    have no weight. Gauss-Newton from the straight arm along the points' mean direction; all frames at once.
    """
    frames = data.xy.shape[0]
    stated = np.where(np.isfinite(data.sigma) & (data.sigma > 0), data.sigma, tracker.sigma)
    seen = np.isfinite(data.xy).all(axis=2)
    points = _Points(data, theta, length, np.where(seen, 1.0 / stated, 0.0), tracker)
    count = POSE + order
    usable = seen.sum(axis=1) * 2 >= count + 2
    coefficients, precision = np.zeros((frames, count)), np.zeros(count)
    precision[POSE:] = 1.0
    last = np.zeros(frames)
    for step in range(STEPS):
        normal, gradient, _ = points.linearised(coefficients, usable)
        stiff = normal + np.diag(precision)
        update = np.linalg.solve(stiff, (gradient - precision * coefficients)[..., None])[..., 0]
        # A limit keeps the first steps of strongly bent frames from overshooting.
        limit = np.minimum(1.0, 1.5 / np.maximum(np.abs(update).max(axis=1), 1e-12))
        coefficients = coefficients + update * limit[:, None] * usable[:, None]
        last = np.abs(update).max(axis=1)
        if step < WIDENING and usable.any():
            open_left = np.diagonal(np.linalg.inv(stiff[usable]), axis1=1, axis2=2)
            precision[POSE:] = 1.0 / np.mean(coefficients[usable] ** 2 + open_left, axis=0)[POSE:]
        elif last[usable].max(initial=0.0) < 1e-10:
            break
    usable &= last < SETTLED
    normal, gradient, misfit = points.linearised(coefficients, usable)
    update = np.linalg.solve(normal, gradient[..., None])[..., 0]
    root = np.swapaxes(np.linalg.cholesky(normal), 1, 2) * usable[:, None, None]
    chi2 = np.where(usable, misfit - np.einsum("tk,tk->t", update, gradient), 0.0)
    left = np.where(usable, 2 * seen.sum(axis=1) - count, 0)
    return ShapeObservation(data.t, theta, length, coefficients + update, root, chi2, left.astype(float))


@dataclass(frozen=True)
class _Points:
    """A midline's points xy (T, P, 2) with their weight (T, P), 1 over the standard deviation; 0 where unseen."""

    data: Midline
    theta: Array
    length: float
    weight: Array
    tracker: Tracker

    def linearised(self, coefficients: Array, usable: NDArray[np.bool_]) -> tuple[Array, Array, Array]:
        """Normal matrices (T, K, K), gradients (T, K) and |xy - f|^2_W (T,) at coefficients (T, K).

        Frames that are not usable get the unit matrix and no gradient.
        """
        order, s = coefficients.shape[1] - POSE, self.data.s
        frames, points = self.data.xy.shape[:2]
        q, angle = coefficients[:, POSE:] @ legendre_to_monomial(order).T, self.theta + coefficients[:, 0]
        shape = midline(q, angle, self.length, s)
        size = np.exp(coefficients[:, 3])[:, None, None]
        jacobian = np.zeros((frames, points, 2, POSE + order))
        jacobian[..., 0] = size * np.stack([-shape[..., 1], shape[..., 0]], axis=-1)
        jacobian[..., 0, 1] = 1.0
        jacobian[..., 1, 2] = 1.0
        jacobian[..., 3] = size * shape
        jacobian[..., POSE:] = size[..., None] * angle_sensitivity(q, angle, self.length, s, basis_at_nodes(order))
        error = np.nan_to_num(self.data.xy) - size * shape - coefficients[:, None, 1:3]
        error = error * self.weight[..., None]
        if self.tracker.by_edges:
            phi = angle[:, None] + monomial_angle(q, s)
            across = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
            error = np.sum(error * across, axis=2, keepdims=True) * across
            jacobian[:] = np.einsum("tpx,tpxk->tpk", across, jacobian)[:, :, None] * across[..., None]
        known = [*([0] if self.tracker.rigid else []), *(range(1, POSE) if self.tracker.by_edges else [])]
        jacobian[..., known] = 0.0
        weighted = (jacobian * self.weight[..., None, None] * usable[:, None, None, None]).reshape(
            frames, 2 * points, POSE + order
        )
        normal = np.einsum("tpk,tpl->tkl", weighted, weighted)
        normal[:, known, known] = 1.0
        normal[~usable] = np.eye(POSE + order)
        gradient = np.einsum("tpk,tp->tk", weighted, error.reshape(frames, -1))
        return normal, gradient, np.einsum("tpx,tpx->t", error, error)


def angle_sensitivity(q: Array, angle: Array, length: float, s: Array, basis: Array) -> Array:
    """d r(s) / dz = -L int_0^s n(v) beta(v) dv (T, P, 2, J), beta = d alpha / dz (derivative of eq. 3).

    q (T, order) and base angle (T,) of the shapes; basis (SHAPE_NODES, J): beta at the nodes of the quadrature.
    """
    rule = quadrature(SHAPE_NODES)
    phi = angle[:, None] + monomial_angle(q, rule.s)
    weights = length * integration_to(SHAPE_NODES, s)
    normal = np.stack([np.cos(phi), np.sin(phi)], axis=1)  # (T, 2, N)
    turned = normal[:, :, :, None] * basis
    return -np.moveaxis(np.tensordot(turned, weights, axes=([2], [1])), (1, 2, 3), (2, 3, 1))


def basis_at_nodes(order: int) -> Array:
    """d alpha / dz (SHAPE_NODES, order) at the nodes of the quadrature of `angle_sensitivity`."""
    return angle_basis(order, quadrature(SHAPE_NODES).s)


def from_track(track: ShapeTrack, theta: Array, length: float) -> ShapeObservation:
    """A video's shape track as an observation. The recording has one scale and one shift, with their own sigma.

    Each frame counts as what it tells by itself: how its root turns and which coordinates it has is the model's to say.
    theta (T,) is the recorded base angle at the frames. Rejected frames have no weight.
    """
    track = track.measured()
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
    inner = information_root(covariance)
    kept = np.array([0, *range(POSE, count)])
    root[np.ix_(good, kept, kept)] = inner
    # The recording has one scale: its information is spread evenly over the frames, so that the sum is right.
    coefficients[good, 3] = np.log(track.scale)
    if good.size and np.isfinite(track.scale_sigma) and track.scale_sigma > 0:
        root[good, 3, 3] = 1.0 / (track.scale_sigma * np.sqrt(good.size))
    nothing = np.zeros(frames)
    return ShapeObservation(track.t, theta, length, coefficients, root, nothing, nothing)


def information_root(covariance: Array) -> Array:
    """The upper triangular R (..., K, K) with R'R the inverse of a covariance, without that inverse.

    A shape whose tip is hidden has variances of 1e5 beside others of 1e-9: its inverse is not positive to rounding.
    """
    lower = np.linalg.cholesky(covariance[..., ::-1, ::-1])
    return np.asarray(np.triu(np.linalg.inv(lower)[..., ::-1, ::-1]), dtype=np.float64)


def from_markers(markers: Markers, theta: Array, length: float, sigma: float) -> MarkerObservation:
    """Markers as an observation, with the noise sigma [m] of each coordinate."""
    return MarkerObservation(markers.t, theta, length, markers.s, markers.d, markers.xy, sigma, markers.names)

"""Shape coefficients of a midline: as points show it, and as a tracker of edges does."""

import numpy as np

from affine_model.curvature import Array, legendre_to_monomial, midline
from inference.measured_shapes import Tracker, fit_shapes, information_root
from inference.observation import POSE
from tentacle.signals import Midline

LENGTH, SIGMA = 0.14, 1e-6
S = np.linspace(0.0, 1.0, 41)
THETA = np.array([0.2])


def seen(points: Array) -> Midline:
    return Midline(np.zeros(1), S, points, np.full(points.shape[:2], SIGMA))


def shape(q: list[float]) -> Array:
    return midline(np.array([q]), THETA, LENGTH, S)


def test_along_their_tangents_points_may_lie_anywhere_for_edges():
    """Edges do not show where along the arm a point lies: 1 um that way, which the points' own fit takes for a shift or
    a scale, changes nothing but what the arc's bend turns into the normal: 1 um / radius of curvature (rad), of 1e-5.
    """
    q = [1.0, -0.5, 0.3]
    s, phi = S, THETA[:, None] + (np.array([q]) @ np.stack([S, S**2 / 2.0, S**3 / 3.0]))
    tangent = np.stack([-np.sin(phi), np.cos(phi)], axis=-1)
    moved = seen(shape(q) + 1e-6 * np.cos(3.0 * s)[None, :, None] * tangent)
    by_points, by_edges = (fit_shapes(moved, THETA, LENGTH, 3, Tracker(SIGMA, edges)) for edges in (False, True))
    truth = np.linalg.solve(legendre_to_monomial(3), np.array(q))
    assert np.all(by_edges.coefficients[:, 1:POSE] == 0.0)
    np.testing.assert_allclose(by_edges.coefficients[0, POSE:], truth, atol=1e-7)
    assert np.abs(by_points.coefficients[0, 1:POSE]).max() > 1e-7


def test_a_coordinate_too_many_is_bent_into_the_others_as_edges_from_a_known_base_bend_it():
    """Of a nearly straight arm the displacement is L int alpha ds, and with the base known its least squares by the
    kept coordinates is a polynomial regression through the origin, which numpy can do: q3 small, second order 1e-6.
    """
    small = 1e-3
    bent = seen(shape([0.0, 0.0, small]))
    kept = np.stack([S, S**2 / 2.0, S**3 / 6.0], axis=1)  # what offset, q1 and q2 displace, over L
    for rigid in (False, True):  # the base angle told by each frame, or known
        found = fit_shapes(bent, THETA, LENGTH, 2, Tracker(SIGMA, True, rigid)).coefficients[0]
        expected = np.linalg.lstsq(kept[:, int(rigid) :], small * S**4 / 12.0, rcond=None)[0]
        q = legendre_to_monomial(2) @ found[POSE:]
        np.testing.assert_allclose([*([] if rigid else [found[0]]), *q], expected, rtol=5e-3)
    assert found[0] == 0.0


def test_however_large_the_noise_a_frame_is_kept_and_judges_the_true_shape_by_its_noise_alone():
    """r = root (z - z_true) is unit noise for every coordinate, at 0.1 mm as at 2 mm, where one frame alone leaves the
    eighth coordinate open by 9 rad. Mean squares over 300 frames scatter by sqrt(2 / 300) = 0.08; 5 of these are asked.
    """
    random, frames, order = np.random.default_rng(3), 300, 8
    q = random.normal(0.0, 1.0, (frames, 3)) * [0.8, 0.5, 0.3]
    theta = random.normal(0.0, 0.4, frames)
    exact = midline(q, theta, LENGTH, S)
    truth = np.zeros((frames, POSE + order))
    truth[:, POSE : POSE + 3] = np.linalg.solve(legendre_to_monomial(3), q.T).T
    for sigma in (1e-4, 5e-4, 2e-3):
        noisy = exact + random.normal(0.0, sigma, exact.shape)
        data = Midline(np.arange(frames) / 30.0, S, noisy, np.full(noisy.shape[:2], sigma))
        found = fit_shapes(data, theta, LENGTH, order, Tracker(sigma))
        assert found.seen.all()
        rest = np.einsum("tkl,tl->tk", found.root, found.coefficients - truth)
        np.testing.assert_allclose(np.mean(rest**2, axis=0), 1.0, atol=5.0 * np.sqrt(2.0 / frames))


def test_the_root_of_the_information_is_right_where_a_tip_is_hidden():
    """Standard deviations from 1e-3 to 300 rad, mixed by a rotation: the smallest variance keeps five digits."""
    random = np.random.default_rng(1)
    turned = np.linalg.qr(random.standard_normal((40, 6, 6)))[0]
    sizes = np.geomspace(1e-6, 1e5, 6)
    covariance = np.einsum("tik,k,tjk->tij", turned, sizes, turned)
    root = information_root(covariance)
    assert not np.tril(root, -1).any()
    white = root @ covariance @ np.swapaxes(root, 1, 2)
    np.testing.assert_allclose(white, np.broadcast_to(np.eye(6), white.shape), atol=1e-3)
    sound = np.diag([1.0, 4.0])
    np.testing.assert_allclose(information_root(sound), np.diag([1.0, 0.5]), rtol=1e-12)

"""Holding coordinates at zero is a linear update of normal variables."""

import numpy as np

from vision.held_coordinates import held_covariance, left_out


def test_the_covariance_is_that_of_the_conditional_distribution():
    rng = np.random.default_rng(0)
    root = rng.standard_normal((5, 6, 6))
    before, rows, tau = root @ np.swapaxes(root, 1, 2), [0, 4, 5], 0.3
    seen = before[:, rows][:, :, rows].copy()
    seen[:, 0, 0] += tau**2
    gain = before[:, :, rows] @ np.linalg.inv(seen)
    after = held_covariance(before, rows, gain, tau)
    np.testing.assert_allclose(after, before - gain @ np.swapaxes(before[:, :, rows], 1, 2), atol=1e-12)


def test_a_coordinate_that_is_hardly_seen_leaves_no_negative_variance():
    """A variance of 1e6 beside one of 1e-8: the plain difference loses all digits."""
    lean = np.array([1.0, 1.0, 1.0])
    before = (np.diag([1e-8, 1e-8, 1e-8]) + 1e6 * np.outer(lean, lean))[None]
    gain = before[:, :, [0, 2]] @ np.linalg.inv(before[:, [0, 2]][:, :, [0, 2]] + 1e-12 * np.eye(2))
    assert np.diagonal(held_covariance(before, [0, 2], gain, 0.0)[0]).min() >= 0.0


def test_above_the_highest_coordinate_the_next_is_as_large_as_the_last():
    evidence = {2: 90.0, 3: 8.0, 4: 6.0, 5: 0.0}
    assert left_out(evidence, 5, 3) == 4.0  # 8 of two coordinates, whose noise alone gives 2
    assert left_out(evidence, 5, 5) == 6.0
    assert left_out({2: 1.0, 3: 0.2}, 3, 3) == 1.0

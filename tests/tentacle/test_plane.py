"""The plane of motion of a spatial arm."""

from __future__ import annotations

import numpy as np

from tentacle.plane import plane_of_motion


def swing(turn: float, aside: float) -> np.ndarray:
    """Displacements of a tip that swings at `turn` rad in the horizontal plane, with a share out of that plane."""
    t = np.linspace(0.0, 5.0, 500)
    along, across = np.cos(7.0 * t), aside * np.sin(7.0 * t)
    x, z = np.cos(turn) * along - np.sin(turn) * across, np.sin(turn) * along + np.cos(turn) * across
    return np.stack([x, 0.1 * along**2, z], axis=-1)


def test_a_swing_in_one_plane_has_nothing_out_of_it() -> None:
    plane = plane_of_motion(swing(0.7, 0.0), np.array([0.0, -2.0, 0.0]))
    np.testing.assert_allclose(plane.normal, [np.cos(0.7), 0.0, np.sin(0.7)], atol=1e-12)
    assert plane.out_of_plane < 1e-12
    points = swing(0.7, 0.0)
    np.testing.assert_allclose(plane.aside(points), 0.0, atol=1e-12)
    np.testing.assert_allclose(plane.coordinates(points)[:, 1], -points[:, 1], atol=1e-12)


def test_an_elliptic_swing_says_how_much_is_out_of_the_plane() -> None:
    plane = plane_of_motion(swing(-0.3, 0.25), np.array([0.0, -1.0, 0.0]))
    # cos and sin have equal rms over many periods: .25 / sqrt(1 + .25^2); 5 s hold 5.6 periods, hence the tolerance
    assert abs(plane.out_of_plane - 0.25 / np.hypot(1.0, 0.25)) < 0.02
    assert np.isclose(plane.normal @ plane.along, 0.0, atol=1e-12)
    assert np.isclose(np.linalg.norm(plane.across), 1.0)

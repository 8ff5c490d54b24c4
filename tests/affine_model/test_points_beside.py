"""Points beside the axis: the compiled sums against the midline's quadrature and the normal there."""

import numpy as np

from affine_model.curvature import midline, monomial_angle
from affine_model.points_beside import CHUNK, points_beside

S, D = np.array([0.2, 0.9, 1.0]), np.array([0.003, 0.0, -0.012])


def test_a_point_lies_its_distance_from_the_axis_along_the_normal() -> None:
    rng = np.random.default_rng(3)
    q, theta = rng.normal(0.0, 1.5, (3, CHUNK // 2 + 7, 4)), rng.normal(0.0, 2.0, (3, CHUNK // 2 + 7))
    phi = theta[..., None] + monomial_angle(q, S)
    normal = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    there = midline(q, theta, 0.14, S) + D[:, None] * normal
    # The same quadrature, summed in another order: rounding alone may differ.
    np.testing.assert_allclose(points_beside(q, theta, 0.14, S, D), there, atol=1e-15)


def test_a_straight_arm_and_a_quarter_circle_have_their_points_where_geometry_says() -> None:
    straight = points_beside(np.zeros(2), 0.0, 0.1, [1.0], [0.01])
    np.testing.assert_allclose(straight, [[0.01, 0.1]], atol=1e-15)
    bend = np.pi / 2.0
    radius = 0.1 / bend  # of the circle; its centre lies on the side to which the arm bends
    quarter = points_beside(np.array([bend]), 0.0, 0.1, [1.0], [0.01])
    np.testing.assert_allclose(quarter, [[-radius, radius + 0.01]], atol=1e-12)  # the quadrature's error


def test_one_shape_and_a_population_of_one_base_angle_have_the_same_points() -> None:
    q = np.linspace(-1.0, 1.0, 40).reshape(10, 4)
    together = points_beside(q, 0.3, 0.14, S, D)
    alone = np.stack([points_beside(one, 0.3, 0.14, S, D) for one in q])
    np.testing.assert_allclose(together, alone, atol=1e-16)

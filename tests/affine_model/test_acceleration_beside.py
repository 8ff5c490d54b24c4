"""What an accelerometer on the arm measures: against differences of positions, and against geometry at rest."""

from __future__ import annotations

import numpy as np
import pytest

from affine_model.acceleration_beside import Turning, gravity_of, specific_force
from affine_model.arm import Arm, neutral_parameters, parameter_index
from affine_model.curvature import Array, monomial_angle
from affine_model.points_beside import points_beside
from tentacle.specimen import AIR, Cone, Gravity, Specimen

LENGTH, G = 0.14, 9.81
SPECIMEN = Specimen(Cone(0.0125, 0.005), LENGTH, 1070.0)


def motion(t: Array) -> tuple[Turning, Array, Array]:
    """Three coordinates and a base angle that swing at 1 to 3 Hz; and the positions' own q (T, 3) and theta (T,)."""
    size, omega = np.array([0.8, -0.5, 0.3, 0.4]), 2.0 * np.pi * np.array([1.1, 1.9, 2.7, 0.9])
    phase = omega * t[:, None] + np.arange(4)
    table = np.stack([np.sin(phase), omega * np.cos(phase), -(omega**2) * np.sin(phase)]) * size
    return Turning(table[:, :, :3, None], table[:, :, 3:]), table[0, :, :3], table[0, :, 3]


@pytest.mark.parametrize("place", [(1.0, 0.0), (0.6, -0.012), (0.0, 0.01)])
def test_the_specific_force_is_the_second_difference_of_the_places_less_gravity(place: tuple[float, float]) -> None:
    t, step = np.linspace(0.1, 0.9, 9), 1e-4
    turning, q, theta = motion(t)
    gravity, pushed = np.array([2.0, 9.0]), np.array([0.7, -0.4])  # the base is accelerated, too
    before, here, after = (
        points_beside(*motion(t + k * step)[1:], LENGTH, [place[0]], [place[1]])[:, 0] for k in (-1, 0, 1)
    )
    felt = (before - 2.0 * here + after) / step**2 + pushed - gravity
    phi = theta + monomial_angle(q, np.array([place[0]]))[:, 0]
    normal, tangent = np.stack([np.cos(phi), np.sin(phi)], -1), np.stack([-np.sin(phi), np.cos(phi)], -1)
    pull = np.broadcast_to((gravity - pushed)[:, None], (t.size, 2, 1))
    found = specific_force(turning, pull, LENGTH, place)
    # Second differences at 1e-4 s: 1e-7 of their size by truncation, 1e-8 m/s^2 by rounding of 0.1 m.
    np.testing.assert_allclose(found[0][:, 0], np.sum(felt * normal, axis=1), atol=2e-5)
    np.testing.assert_allclose(found[1][:, 0], np.sum(felt * tangent, axis=1), atol=2e-5)


def at_rest(gravity: Gravity, theta: float, bend: float = 0.0, tilt: float = 0.0) -> tuple[float, float]:
    """What a tip at rest feels along the normal and the tangent; the arm is bent by that angle from clamp to tip."""
    parameters = neutral_parameters()
    parameters[parameter_index("gravity_tilt", "tilt")] = tilt
    pull = gravity_of(Arm(SPECIMEN, AIR, gravity), parameters[:, None])[None]
    turning = Turning(np.array([bend, 0.0, 0.0]).reshape(3, 1, 1, 1), np.array([theta, 0.0, 0.0]).reshape(3, 1, 1))
    normal, tangent = specific_force(turning, pull, LENGTH, (1.0, 0.004))
    return float(normal[0, 0]), float(tangent[0, 0])


def test_an_arm_that_hangs_at_rest_is_held_up_along_its_tangent() -> None:
    """y points down along a hanging arm; the clamp pulls upwards, towards -y."""
    assert at_rest(Gravity(0.0, G), 0.0) == pytest.approx((0.0, -G), abs=1e-12)
    assert at_rest(Gravity(np.pi, G), 0.0) == pytest.approx((0.0, G), abs=1e-12)  # it stands: pushed up, along +y
    # Held horizontally with gravity along +x, the normal of the straight arm: pushed towards -x.
    assert at_rest(Gravity(np.pi / 2.0, G), 0.0) == pytest.approx((-G, 0.0), abs=1e-12)


def test_the_axes_turn_with_base_and_arm_and_gravity_with_its_tilt() -> None:
    """Turned by a quarter from y towards -x, the normal points along +y, down: it is pushed against its normal."""
    quarter = np.pi / 2.0
    turned = (-G, 0.0)
    assert at_rest(Gravity(0.0, G), quarter) == pytest.approx(turned, abs=1e-12)
    assert at_rest(Gravity(0.0, G), 0.0, bend=quarter) == pytest.approx(turned, abs=1e-12)
    assert at_rest(Gravity(0.0, G), 0.0, tilt=quarter) == pytest.approx(turned, abs=1e-12)


def test_a_stiff_arm_on_a_turning_base_feels_the_centre_and_the_turn() -> None:
    """A point at radius r on a rod that turns with rate w and acceleration a: -w^2 r along the rod, -a r along n."""
    turning = Turning(np.zeros((3, 1, 1, 1)), np.array([0.3, 2.0, 5.0]).reshape(3, 1, 1))
    normal, tangent = specific_force(turning, np.zeros((1, 2, 1)), LENGTH, (0.5, 0.0))
    assert normal[0, 0] == pytest.approx(-5.0 * 0.5 * LENGTH, rel=1e-12)  # n points against a positive turn
    assert tangent[0, 0] == pytest.approx(-4.0 * 0.5 * LENGTH, rel=1e-12)

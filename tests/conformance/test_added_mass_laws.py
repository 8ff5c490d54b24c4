"""Added mass by Kirchhoff's law and by Morison's, each against its own statement; both models."""

import numpy as np
import pytest

from affine_model.curvature import legendre_to_monomial, midline, monomial_angle
from tentacle.specimen import WATER
from tests.conformance.both_models import ARM, ORDER, Motion, bent, model_with, reduced

FALL = np.array([3.0, -8.0, 20.0, -15.0])  # curvatures' accelerations [rad/s^2]
TURN = 6.0  # the base angle's [rad/s^2]
CARRIED = 0.7  # C_a


def place_and_angle(u, s):
    """Midline points (P, 2) [m] and angles (P,) of Legendre coordinates and base angle u, the clamp at the origin."""
    q = legendre_to_monomial(ORDER) @ u[:ORDER]
    return midline(q, u[ORDER], ARM.length, s, nodes=40), u[ORDER] + monomial_angle(q, s)


def morison(motion):
    """Generalised force (ORDER + 1,) of -m_a (a n) n: accelerations and virtual displacements by differences of the
    midline alone.
    """
    s, weight = np.polynomial.legendre.leggauss(40)
    s, weight = 0.5 * (s + 1.0), 0.5 * ARM.length * weight
    u = np.append(motion.z, motion.theta)
    rate, turn = np.append(motion.z_rate, motion.theta_rate), np.append(FALL, TURN)

    def at(t):
        return place_and_angle(u + t * rate + 0.5 * t**2 * turn, s)[0]

    step = 1e-4
    acceleration = (at(step) - 2.0 * at(0.0) + at(-step)) / step**2
    angle = place_and_angle(u, s)[1]
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    mass = CARRIED * WATER.density * 0.25 * np.pi * ARM.section.width(s) ** 2
    force = -(weight * mass * np.sum(acceleration * normal, axis=1))[:, None] * normal
    moves = 1e-6 * np.eye(ORDER + 1)
    moved = [(place_and_angle(u + d, s)[0] - place_and_angle(u - d, s)[0]) / 2e-6 for d in moves]
    return np.array([np.sum(force * way) for way in moved])


def inertial(equations):
    """Force minus M u'' (ORDER + 1,)."""
    mass, force = equations[:2]
    return (force - mass @ np.concatenate([FALL, [TURN, 0.0]]))[: ORDER + 1]


def model_of(convective):
    return model_with({} if convective is None else {"added_mass": {"C_a": CARRIED, "convective": convective}})


@pytest.mark.parametrize("seed", [1, 2])
def test_without_its_convective_terms_it_is_the_normal_acceleration_of_the_midline(seed):
    motion = Motion.drawn(seed)
    found = inertial(reduced(model_of(0.0), motion)) - inertial(reduced(model_of(None), motion))
    expected = morison(motion)
    # Second differences at 1e-4 s: truncation and rounding, 1e-6 of the force.
    np.testing.assert_allclose(found, expected, rtol=0, atol=3e-6 * np.abs(expected).max())
    coarse, fine = (
        inertial(bent(model_of(0.0), motion, n)) - inertial(bent(model_of(None), motion, n)) for n in (20, 40)
    )
    np.testing.assert_allclose((4.0 * fine - coarse) / 3.0, expected, rtol=0, atol=2e-3 * np.abs(expected).max())
    kirchhoff = inertial(reduced(model_of(1.0), motion)) - inertial(reduced(model_of(None), motion))
    assert np.abs(kirchhoff - expected).max() > 1e-2 * np.abs(expected).max()  # the two laws do differ here


def power(motion, convective, equations):
    """What the added mass gives the moving arm beyond what it takes from m_a u_n^2 / 2 [W], at u'' = 0."""
    u, v = np.concatenate([motion.z, [motion.theta, 0.0]]), np.concatenate([motion.z_rate, [motion.theta_rate, 0.0]])

    def added(motion):
        with_it, without = (equations(model_of(x), motion) for x in (convective, None))
        return with_it[0] - without[0], with_it[1] - without[1]

    step = 1e-5
    ahead, behind = (
        added(Motion(u[:ORDER] + t * v[:ORDER], motion.z_rate, u[ORDER] + t * v[ORDER], *still(motion)))[0]
        for t in (step, -step)
    )
    return float(v @ added(motion)[1] + 0.5 * v @ ((ahead - behind) / (2.0 * step)) @ v)


def still(motion):
    return motion.theta_rate, motion.memory, motion.t


@pytest.mark.parametrize("seed", [1, 2])
def test_kirchhoff_keeps_energy_and_morison_gains_the_power_of_the_terms_left_out(seed):
    motion = Motion.drawn(seed)
    s, weight = np.polynomial.legendre.leggauss(40)
    s, weight = 0.5 * (s + 1.0), 0.5 * ARM.length * weight
    u, v = np.append(motion.z, motion.theta), np.append(motion.z_rate, motion.theta_rate)
    (ahead, later), (behind, earlier) = (place_and_angle(u + t * v, s) for t in (1e-5, -1e-5))
    velocity, turning, angle = (ahead - behind) / 2e-5, (later - earlier) / 2e-5, place_and_angle(u, s)[1]
    u_n = velocity[:, 0] * np.cos(angle) + velocity[:, 1] * np.sin(angle)
    u_t = velocity[:, 1] * np.cos(angle) - velocity[:, 0] * np.sin(angle)
    mass = CARRIED * WATER.density * 0.25 * np.pi * ARM.section.width(s) ** 2
    gained = float(np.sum(weight * mass * turning * u_n * u_t))
    for equations, close in ((reduced, 1e-6), (lambda model, motion: bent(model, motion, 80), 1e-2)):
        assert abs(power(motion, 1.0, equations)) < close * abs(gained)
        assert power(motion, 0.0, equations) == pytest.approx(gained, rel=close)
        assert power(motion, 0.4, equations) == pytest.approx(0.6 * gained, rel=close)

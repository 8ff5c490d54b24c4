import numpy as np
import pytest

from mujoco_ref.chain_state import ChainState
from mujoco_ref.modes import mass_matrix, natural_frequencies
from mujoco_ref.simulate import make_stepper
from tentacle.specimen import Cone, Fluid, Specimen
from tests.mujoco_ref.arms import CONE, HANGING, STRIP, model_of

MODULUS = 2e5


def rate_of(specimen: Specimen) -> float:
    """sqrt(E I0 / (rho A0 L^4)) [rad/s]."""
    section = specimen.section
    inertia, area = float(section.second_moment(0.0)), float(section.area(0.0))
    return float(np.sqrt(MODULUS * inertia / (specimen.density * area * specimen.length**4)))


def test_uniform_beam():
    # Slender enough (h/L = 1/200) that rotary inertia lowers the second mode by 1e-5 only.
    specimen = Specimen(type(STRIP)(0.01, 0.001), 0.2, 1070.0)
    found = 2 * np.pi * natural_frequencies(make_stepper(model_of(specimen), links=40), count=2) / rate_of(specimen)
    # 40 links: error pi^2 n^-2-like, measured 1e-4 and 1e-3.
    np.testing.assert_allclose(found, np.array([1.87510, 4.69409]) ** 2, rtol=(2e-3))


@pytest.mark.parametrize(
    ("taper", "roots"),
    [(0.0, (8.7193, 21.1457, 38.4538)), (0.1, (7.2049, 18.68, 37.14)), (0.5, (4.6252, 19.548, 48.58))],
)
def test_cones_of_any_taper(taper, roots):
    specimen = Specimen(Cone(0.001, 0.001 * taper), 0.2, 1070.0)
    found = 2 * np.pi * natural_frequencies(make_stepper(model_of(specimen), links=60)) / rate_of(specimen)
    # The targets are printed with four digits, and 60 links are within 3e-3 of the third mode.
    np.testing.assert_allclose(found, roots, rtol=3e-3)


def test_physical_cone_has_rotary_inertia_and_converges_with_order_two():
    steppers = [make_stepper(model_of(CONE), links=links) for links in (10, 20, 40, 80)]
    found = np.array([natural_frequencies(stepper) for stepper in steppers])
    # Euler-Bernoulli with rotary inertia 5.1621, 13.028, 25.157 Hz, printed to 4-5 digits.
    np.testing.assert_allclose(found[-1], [5.1621, 13.028, 25.157], rtol=1e-4)
    order = np.log2((found[1] - found[0]) / (found[2] - found[1]))
    assert np.all(order > 1.8), order


def test_added_mass_lowers_the_frequency_as_it_should():
    # Added mass acts along the normal and not on the section's turning: .719 without rotary inertia, .7201 with it.
    air = natural_frequencies(make_stepper(model_of(CONE)))
    water = natural_frequencies(make_stepper(model_of(CONE, Fluid(1000.0), added_mass={"C_a": 1.0})))
    assert water[0] / air[0] == pytest.approx(np.sqrt(1070 / 2070), abs=2e-3)


def test_weight_of_a_hanging_arm_stiffens_it():
    free = natural_frequencies(make_stepper(model_of(CONE)), count=1)
    hung = natural_frequencies(make_stepper(model_of(CONE, gravity=HANGING)), count=1)
    assert hung[0] > free[0]


def test_added_mass_matrix_is_the_hessian_of_the_waters_energy():
    stepper = make_stepper(model_of(CONE, Fluid(1000.0), added_mass={"C_a": 0.7}), links=5)
    bare = make_stepper(model_of(CONE, Fluid(1000.0)), links=5)
    random = np.random.default_rng(0)
    state = ChainState.at_rest(5, 0.3)
    state.q[3:] = random.normal(0.0, 0.3, 5)
    added = mass_matrix(stepper, state) - mass_matrix(bare, state)

    def energy(v: np.ndarray) -> float:
        """1/2 int m_a u_n^2 ds by fine quadrature, from the definition of the velocities."""
        total, start, rate, phi = 0.0, np.array([v[0], v[1]]), 0.0, 0.0
        for k, (length, begin) in enumerate(zip(stepper.chain.length, stepper.chain.start, strict=True)):
            phi, rate = phi + state.q[2 + k], rate + v[2 + k]
            normal = np.array([np.cos(phi), np.sin(phi)])
            x = (np.arange(400) + 0.5) / 400 * length
            width = CONE.section.width((begin + x) / CONE.length)
            u_n = start @ normal - rate * x
            total += 0.5 * np.sum(0.7 * 1000.0 * np.pi / 4 * width**2 * u_n**2) * length / 400
            start = start - rate * length * normal
        return total

    for _ in range(3):
        v = random.normal(0.0, 1.0, 8)
        # The midpoint rule with 400 cells leaves 1e-6.
        assert 0.5 * v @ added @ v == pytest.approx(energy(v), rel=1e-5)

"""Frequencies against Euler-Bernoulli's, Rayleigh's and Rayleigh-Ritz's values."""

import itertools

import numpy as np
import pytest

from affine_model.arm import Arm
from affine_model.modes import modes
from tentacle.specimen import AIR, Cone, Fluid, Gravity, Rectangle, Specimen

WEIGHTLESS = Gravity(0.0, 0.0)
E, RHO = 2e5, 1070.0


def reduced(section, order, parameters):
    """omega / sqrt(E I0 / (rho A0 L^4)); L = 1000 thicknesses, so that rotary inertia (1e-6 relative) is no matter."""
    arm = Arm(Specimen(section, 1.0, RHO), AIR, WEIGHTLESS, order=order, nodes=order + 6)
    omega = 2 * np.pi * modes(arm, parameters(elasticity__E=E)).frequency
    return omega / np.sqrt(E * section.second_moment(0.0) / (RHO * section.area(0.0)))


UNIFORM, FULL, TENTH, HALF = Rectangle(2e-3, 1e-3), Cone(1e-3, 0.0), Cone(1e-3, 1e-4), Cone(1e-3, 5e-4)


@pytest.mark.parametrize(
    ("section", "first", "second"),
    [(UNIFORM, 3.5327, 34.81), (FULL, 8.7352, 25.18), (TENTH, 7.2113, 21.28)],
)
def test_affine_curvature_gives_the_rayleigh_ritz_values(parameters, section, first, second):
    values = reduced(section, 2, parameters)
    assert values[0] == pytest.approx(first, abs=1e-4)  # the table's last digit
    assert values[1] == pytest.approx(second, abs=1e-2)


@pytest.mark.parametrize(
    ("section", "exact"),
    [
        (UNIFORM, (1.87510**2, 4.69409**2)),
        (FULL, (8.7193, 21.1457, 38.4538)),
        (TENTH, (7.2049, 18.68, 37.14)),
        (HALF, (4.6252, 19.548, 48.58)),
    ],
)
def test_more_coordinates_converge_to_euler_bernoulli_from_above(parameters, section, exact):
    orders = [reduced(section, order, parameters) for order in (2, 3, 4, 5, 10)]
    for k, value in enumerate(exact):
        sequence = [values[k] for values in orders if len(values) > k]
        # Rayleigh-Ritz bounds from above and never rises with more coordinates (1e-7: rounding of the differences).
        assert all(later <= earlier * (1 + 1e-7) for earlier, later in itertools.pairwise(sequence))
        # The table gives four digits; its 37.14 lies 4e-4 above our 37.1246, which bounds the truth from above.
        assert sequence[-1] == pytest.approx(value, rel=5e-4)
    # The paper's two coordinates: first mode within 0.5 % (0.94 % for the blunt cone), second 12 to 58 % too high.
    assert orders[0][0] == pytest.approx(exact[0], rel=1e-2 if section is HALF else 5e-3)
    assert 1.12 < orders[0][1] / exact[1] < 1.59


def test_the_paper_s_cone_in_air_with_rotary_inertia(parameters):
    arm = Arm(Specimen(Cone(0.0125, 0.001), 0.14, RHO), AIR, WEIGHTLESS, order=12, nodes=20)
    frequency = modes(arm, parameters(elasticity__E=E)).frequency
    np.testing.assert_allclose(frequency[:3], [5.1621, 13.028, 25.157], rtol=4e-5)  # the last digit given; order 12


def test_added_mass_lowers_every_frequency_of_a_submerged_cone(parameters):
    # C_a = 1, rho_s = 1070, rho_w = 1000: sqrt(1070/2070) = 0.719, exact but for rotary inertia (1e-6 here).
    arm = Arm(Specimen(Cone(1e-3, 1e-4), 1.0, RHO), Fluid(1000.0), WEIGHTLESS, order=4, nodes=10)
    dry = modes(arm, parameters(elasticity__E=E)).frequency
    wet = modes(arm, parameters(elasticity__E=E, added_mass__C_a=1.0)).frequency
    np.testing.assert_allclose(wet / dry, np.sqrt(1070 / 2070), rtol=1e-5)


def test_kelvin_voigt_damping_ratio_grows_with_frequency(parameters):
    # d = eta I/L, k = E I/L: zeta = omega eta / (2 E) for every mode, exactly.
    arm = Arm(Specimen(Cone(0.0125, 0.001), 0.14, RHO), AIR, WEIGHTLESS, order=3)
    found = modes(arm, parameters(elasticity__E=E, damping__eta=900.0))
    np.testing.assert_allclose(found.damping_ratio, 2 * np.pi * found.frequency * 900.0 / (2 * E), rtol=1e-6)


def test_an_arm_that_stands_up_too_heavy_is_unstable(parameters):
    arm = Arm(Specimen(Cone(0.0125, 0.001), 0.14, RHO), AIR, Gravity(np.pi), order=2)
    assert np.isnan(modes(arm, parameters(elasticity__E=2e3)).frequency[0])
    assert np.all(modes(arm, parameters(elasticity__E=2e5)).frequency > 0)

"""Options of the water's force, each held to the published law that it names; both models."""

from types import SimpleNamespace

import numpy as np
import pytest

from affine_model.effects import catalogue
from mujoco_ref.influence import water_record
from mujoco_ref.section_water import viscous_resistance
from tentacle.specimen import WATER
from tests.conformance.both_models import ARM, ORDER, Motion, bent, model_with, reduced

FREQUENCY, NU, RHO = 0.8, 1e-6, 1000.0


@pytest.mark.parametrize("width", [0.025, 0.006, 0.001])
@pytest.mark.parametrize("speed", [0.01, 0.2])
def test_an_oscillating_section_has_the_drag_coefficient_of_stokes_and_wang(width, speed):
    u_n = speed * np.sin(2.0 * np.pi * np.arange(64) / 64)
    x = SimpleNamespace(width=width, fluid_density=RHO, u_n=u_n)
    law = catalogue()["oscillating_drag"].force
    assert law is not None
    force, _ = law(x, SimpleNamespace(share=1.0, f=FREQUENCY))
    # Morison's C_d: the first harmonic of the force over that of rho w |u| u / 2, by the same sums.
    coefficient = -(force @ u_n) / (0.5 * RHO * width * (np.abs(u_n) * u_n) @ u_n)
    beta, keulegan_carpenter = FREQUENCY * width**2 / NU, speed / (FREQUENCY * width)
    series = (np.pi * beta) ** -0.5 + (np.pi * beta) ** -1.0 - 0.25 * (np.pi * beta) ** -1.5
    # 64 instants give the integral of |sin|^3 to 1e-6.
    assert coefficient == pytest.approx(1.5 * np.pi**3 / keulegan_carpenter * series, rel=1e-5)
    option = {"oscillating_drag": {"share": 1.0, "f": FREQUENCY}}
    water = water_record(option, RHO, 0.14, (0.0, 0.0))
    assert viscous_resistance(width, water[0]) * u_n == pytest.approx(-force, rel=1e-9)


def thrust(equations, option, motion):
    """Force towards the base [N] that the option adds."""
    with_it, without = (equations(model_with(effects), motion)[1] for effects in (option | STREAM, STREAM))
    return -(with_it - without)[ORDER + 1]


STREAM = {"current": {"U_x": 0.0, "U_y": 0.3}}


def test_a_tip_that_sheds_has_lighthill_s_mean_thrust():
    """A stiff arm pitches by a sin(wt) in a stream U from clamp to tip: m (h_t^2 - U^2 h_x^2) / 2, h = L theta."""
    span, size, omega = 0.02, 0.05, 9.0
    option, still = {"shed_tip": {"span": span}}, np.zeros(ORDER)
    for equations in (reduced, lambda model, motion: bent(model, motion, 8)):
        found = [
            thrust(
                equations,
                option,
                Motion(still, still, size * np.sin(phase), size * omega * np.cos(phase), still, 0.0),
            )
            for phase in 2.0 * np.pi * np.arange(8) / 8
        ]
        carried = 0.25 * np.pi * WATER.density * span**2
        expected = 0.25 * carried * size**2 * ((ARM.length * omega) ** 2 - 0.3**2)
        assert np.mean(found) == pytest.approx(expected, rel=3.0 * size**2)  # to the order of the amplitude squared

"""A third value of the first frequency of an arm in air, by PyElastica's Cosserat rod (if it is installed).

That rod shears and has rotary inertia, so it lies between Timoshenko's and Euler-Bernoulli's beam.
"""

from __future__ import annotations

import contextlib
import io
from importlib import import_module
from importlib.util import find_spec

import numpy as np
from scipy.optimize import least_squares

from tentacle.specimen import Cone, Specimen

ROD_STEP = 2e-5  # s: under the rod's fastest shear wave, from 1 mm of radius up
SHEAR_OVER_YOUNG = 1.0 / 3.0  # incompressible
TIP_NUDGE = 0.01  # m/s at the tip, which then swings by a third of a millimetre


def is_installed() -> bool:
    """Whether PyElastica is installed. (After an uninstall a folder of caches can remain; it has no origin.)"""
    spec = find_spec("elastica")
    return spec is not None and spec.origin is not None


def first_frequency(specimen: Specimen, modulus: float, guess: float, elements: int = 40) -> float:
    """First natural frequency [Hz] of the clamped cone, Young's modulus [Pa], from a small free swing of five periods.

    guess [Hz] sets how long it swings, and where the fit of three sines starts. ImportError where PyElastica is not
    installed, ValueError for a section that is no cone, ArithmeticError if the fit does not converge.
    """
    if not isinstance(specimen.section, Cone):
        raise ValueError("PyElastica's rods are round")
    elastica = import_module("elastica")

    class Simulator(elastica.BaseSystemCollection, elastica.Constraints, elastica.CallBacks):
        """The parts of PyElastica that one clamped rod needs."""

    s = (np.arange(elements) + 0.5) / elements
    rod = elastica.CosseratRod.straight_rod(
        elements, np.zeros(3), np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0]), specimen.length,
        specimen.section.half_thickness(s), specimen.density,
        youngs_modulus=modulus, shear_modulus=SHEAR_OVER_YOUNG * modulus,
    )  # fmt: skip
    rod.velocity_collection[0] = TIP_NUDGE * np.linspace(0.0, 1.0, elements + 1) ** 2
    times: list[float] = []
    tips: list[float] = []

    class Watch(elastica.CallBackBaseClass):
        """Keeps the tip's place."""

        def make_callback(self, system, time: float, current_step: int) -> None:
            """Called after every step."""
            if current_step % 20 == 0:
                times.append(float(time))
                tips.append(float(system.position_collection[0, -1]))

    simulator = Simulator()
    simulator.append(rod)
    held = {"constrained_position_idx": (0,), "constrained_director_idx": (0,)}
    simulator.constrain(rod).using(elastica.OneEndFixedBC, **held)
    simulator.collect_diagnostics(rod).using(Watch)
    simulator.finalize()
    duration = 5.0 / guess
    with contextlib.redirect_stdout(io.StringIO()):
        elastica.integrate(elastica.PositionVerlet(), simulator, duration, int(duration / ROD_STEP), progress_bar=False)
    return _lowest_sine(np.array(times), np.array(tips), guess)


def _lowest_sine(t: np.ndarray, x: np.ndarray, guess: float) -> float:
    """Frequency [Hz] of the lowest of three sines fitted to x; the others start at a cone's higher modes."""

    def misfit(frequencies: np.ndarray) -> np.ndarray:
        phases = 2.0 * np.pi * np.outer(t, frequencies)
        columns = np.concatenate([np.cos(phases), np.sin(phases)], axis=1)
        return (columns @ np.linalg.lstsq(columns, x, rcond=None)[0] - x) / np.std(x)

    found = least_squares(misfit, guess * np.array([1.0, 2.5, 4.9]))
    if not found.success:
        raise ArithmeticError(f"the fit of three sines did not converge: {found.message}")
    return float(np.min(found.x))

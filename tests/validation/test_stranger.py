"""The loop on a simulator that shares nothing with it, a rod of point masses (all cases: benchmarks/stranger.py)."""

import numpy as np
import pytest

from benchmarks._discrete_rod import GRAVITY, STEP, Rod, move
from benchmarks.stranger import recording, right
from discovery.diagnose import diagnose


def test_the_stranger_s_rod_hangs_as_a_beam_does():
    # Held level in water that nearly carries it: its tip sinks by w L^4 / (8 E I), to first order in the bend.
    rod = Rod(tip_radius=0.011, water=1060.0)
    theta = np.full(round(5.0 / STEP) + 1, -0.5 * np.pi)
    tip = move(rod, theta, STEP, theta.size - 1)[-1, -1]
    area, second = np.pi * 0.011**2, 0.25 * np.pi * 0.011**4
    drop = (rod.density - rod.water) * area * GRAVITY * rod.length**4 / (8.0 * rod.E * second)
    # Of the last swing 2 % is left; what is of second order (shortening) is far less at drop / L = 1 %.
    assert tip[1] == pytest.approx(drop, rel=0.03)
    assert tip[0] == pytest.approx(rod.length, rel=1e-3)


def test_a_current_in_a_stranger_s_tank_is_named_and_measured():
    found = diagnose([recording({"current": 0.05}, 9.0)])
    assert right("current", found)
    assert found.verdict == "effect"
    assert found.parameters["current"]["U_x"].value == pytest.approx(0.05, abs=1e-3)  # 26 pieces: 1 % of it
    before, after, floor = (error.midline_mm or np.nan for error in (found.before, found.after, found.floor))
    assert after < 1.05 * floor < 0.2 * before

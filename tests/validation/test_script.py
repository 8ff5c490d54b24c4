"""The scripts for PyElastica and SoRoMoX, run by an interpreter that has the program.

TENTACLE_PYTHON_ELASTICA and TENTACLE_PYTHON_SOROMOX name one; else it is this interpreter.
"""

from __future__ import annotations

import json
import os
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mujoco_ref.export.script import PROGRAMS, export_script
from mujoco_ref.undeclared import Noise, Scenario, make_recording
from tentacle.cli import main
from tentacle.io.model_file import write_model
from tentacle.io.recording_rrd import write_rrd
from tentacle.model import Estimate
from tentacle.specimen import AIR, Cone, Gravity, Specimen
from tentacle.waveform import Ramped, Sine
from tests.mujoco_ref.arms import model_of, swimming_model
from validation.export.in_program import interpreter_with, points_in_program, prepared, script_error

E, RADIUS, LENGTH, DENSITY = 2e5, 0.004, 0.1, 1070.0
BEAM = Specimen(Cone(RADIUS, RADIUS), LENGTH, DENSITY)
BENDING, LINE = E * np.pi * RADIUS**4 / 4.0, DENSITY * np.pi * RADIUS**2


@pytest.fixture(params=PROGRAMS)
def program(request):
    """A program and an interpreter that has it."""
    found = PROGRAMS[request.param]
    given = os.environ.get(f"TENTACLE_PYTHON_{found.module.upper()}")
    python = interpreter_with(found, None if given is None else Path(given))
    if python is None:
        pytest.skip(f"{found.name} is not installed here, and TENTACLE_PYTHON_{found.module.upper()} names no other")
    return request.param, python


def tip_of_beam(program, model, q, seconds):
    """Tip's x (T,) [m] of a clamped arm from rest in the shape q, at 200 frames a second."""
    to, python = program
    times = np.arange(0.0, seconds, 0.005)
    still = [0.0, 0.0]
    motion = {
        "start": 0.0, "base": {"t": [-1.0, seconds + 1.0], "theta": still, "rate": still, "acceleration": still},
        "q": q, "q_rate": [0.0] * len(q), "times": times.tolist(), "s": [1.0], "d": [0.0], "points": None,
    }  # fmt: skip
    return times, points_in_program(export_script(model, to), python, motion)[:, 0, 0]


def test_a_clamped_beam_swings_as_euler_s_beam_does(program):
    """omega = 1.8751^2 sqrt(E I / (rho A L^4)); rotary inertia and shear of a beam with r / L = .04 take .4 % off."""
    model = replace(model_of(BEAM, AIR, Gravity(0.0, 0.0)), order=3)
    t, x = tip_of_beam(program, model, [0.05, -0.05, 0.0], 3.0)
    turns = np.flatnonzero((x[1:] > 0.0) != (x[:-1] > 0.0))
    crossing = t[turns] + 0.005 * x[turns] / (x[turns] - x[turns + 1])
    found = np.pi * (len(crossing) - 1) / (crossing[-1] - crossing[0])
    # Twenty elements: some tenths of a percent, 1 / 20^2; three curvatures: less than that.
    assert found == pytest.approx(1.8751**2 * np.sqrt(BENDING / (LINE * LENGTH**4)), rel=0.01)


def test_an_arm_held_level_droops_as_a_beam_does(program):
    """Tip w L^4 / (8 E I) under its weight w, by a weak gravity: 5 % of the length, so that the beam stays a line."""
    pull, damping = 0.3, {"damping": {"eta": 2.9e4}}  # near the first mode's critical one: at rest after 2.5 s
    model = replace(model_of(BEAM, AIR, Gravity(np.pi / 2.0, pull), **damping), order=3)
    _, x = tip_of_beam(program, model, [0.0, 0.0, 0.0], 2.5)
    # Shear droop: 3 r^2 / L^2 = .5 % (PyElastica); bending by 5 % of L: (.05)^2; elements: 1 / 20^2.
    assert x[-1] == pytest.approx(LINE * pull * LENGTH**4 / (8.0 * BENDING), rel=0.012)


@pytest.fixture(scope="module")
def diagnosed():
    """An arm with added mass, and its noisy recording by the reference."""
    model = replace(swimming_model(added_mass={"C_a": 1.0}), order=3)
    scenario = Scenario(model, Ramped(Sine(0.4, 1.3), 0.5), 1.5, 60.0)
    return model, make_recording({}, scenario, 0, Noise(midline=1.5e-4), name="made")[0]


def test_the_program_shows_the_recording_nearly_as_well_as_ours(program, diagnosed):
    to, python = program
    model, recording = diagnosed
    found = script_error(export_script(model, to), python, prepared(model, recording))
    # SoRoMoX solves the same equations in the same coordinates. PyElastica's 20 elements err by .1 mm beside .2 mm.
    assert found.program_mm < (1.02 if to == "soromox" else 1.25) * found.ours_mm
    assert "times ours" in found.sentence()


def test_the_command_runs_the_script_and_prints_both_errors(program, diagnosed, tmp_path, capsys):
    to, python = program
    model, recording = diagnosed
    write_model(model, tmp_path / "model.toml")
    write_rrd(recording, tmp_path / "made.rrd")
    asked = ["export", str(tmp_path / "model.toml"), "--to", to, "--out", str(tmp_path / "arm"), "--python", python]
    assert main([*asked, "--recording", str(tmp_path / "made.rrd")]) == 0
    said = capsys.readouterr().out
    assert "made: ours" in said
    assert PROGRAMS[to].name in said


def test_without_the_program_it_says_that_nothing_was_simulated(diagnosed, tmp_path, capsys):
    model, recording = diagnosed
    bare = tmp_path / "python"
    bare.write_text(f"#!/bin/sh\nexec '{sys.executable}' -I -S \"$@\"\n")  # without any package
    bare.chmod(0o755)
    write_model(model.with_effect("tip_mass", mass=Estimate.exact(0.001)), tmp_path / "model.toml")
    write_rrd(recording, tmp_path / "made.rrd")
    asked = ["export", str(tmp_path / "model.toml"), "--to", "soromox", "--out", str(tmp_path / "arm")]
    assert main([*asked, "--python", str(bare), "--recording", str(tmp_path / "made.rrd")]) == 0
    assert "SoRoMoX is not installed here: nothing was simulated again" in capsys.readouterr().out
    motion = json.loads((tmp_path / "arm" / "motion.json").read_text())
    assert np.allclose(np.diff(motion["base"]["t"]), 1e-3)
    seen, line = np.array(motion["points"], dtype=float), recording.midline
    # What was seen, moved back by the fitted shift of the clamp alone.
    assert np.ptp(seen - line.xy[-len(seen) :], axis=(0, 1)) == pytest.approx([0.0, 0.0], abs=1e-9)

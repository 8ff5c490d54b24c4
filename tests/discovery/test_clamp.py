"""An arm behind a clamp that gives, simulated by the MuJoCo chain: what the loop says of it, declared so and rigid."""

from dataclasses import replace

import numpy as np
import pytest

from discovery.diagnose import diagnose
from mujoco_ref.simulate import Initial, Setup, simulate
from tentacle.declared import Uncertain
from tentacle.diagnosis import Diagnosis
from tentacle.model import Estimate, Model
from tentacle.recording import Declaration, Recording
from tentacle.signals import Midline, MotorSignal
from tentacle.specimen import WATER
from tests.made_recordings import SPECIMEN, TRUTH, WAVE

CLAMP = "specimen.clamp_length_m"
GIVES = 0.007  # m, a twentieth of the arm
NOISE = 1e-3  # m of a point


@pytest.fixture(scope="module")
def seen() -> Recording:
    """The chain's midline in water with noise, declared with a rigid clamp."""
    parameters: dict[str, dict[str, Estimate]] = {}
    for (effect, name), value in TRUTH.items():
        parameters.setdefault(effect, {})[name] = Estimate.exact(value)
    model = Model(replace(SPECIMEN, clamp_length=GIVES), WATER, parameters=parameters)
    s = np.linspace(0.0, 1.0, 31)
    run = simulate(model, WAVE, 12.0, 30.0, setup=Setup(links=30, s=s, initial=Initial(np.zeros(2))))
    xy = run.midline.xy + NOISE * np.random.default_rng(1).standard_normal(run.midline.xy.shape)
    midline = Midline(run.t, s, xy, np.full(xy.shape[:2], NOISE))
    motor = MotorSignal(run.t, run.command, run.theta)
    return Recording("clamped", Declaration(SPECIMEN, WATER), motor, midline=midline)


def answer(recording: Recording, *numbers: Uncertain) -> Diagnosis:
    return diagnose([replace(recording, declaration=replace(recording.declaration, uncertain=numbers))])


def test_a_clamp_of_unknown_give_is_measured_and_nothing_is_missing(seen):
    found = answer(seen, Uncertain(CLAMP, 0.0, 0.01, 0.0, SPECIMEN.length))
    assert found.verdict == "nothing_missing"
    (sentence,) = (words for words in found.words if CLAMP in words)
    value, deviation = (float(part.rstrip(".")) for part in sentence.split("the data say ")[1].split(" +- "))
    assert abs(value - GIVES) < 3.0 * deviation
    assert deviation < 0.2 * 0.01  # m, of what was declared: the data decide
    assert found.base_model.specimen.clamp_length == pytest.approx(value, abs=0.1 * deviation)  # the words are rounded


def test_a_clamp_that_is_declared_rigid_is_missed(seen):
    """The catalogue has no such effect. The answer is an effect that softens the root, or "unknown"."""
    found = answer(seen)
    assert found.verdict != "nothing_missing"

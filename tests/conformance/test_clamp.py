"""A clamp that gives, in both models: beside every effect in one state, and in a swing in water."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import arm_of, parameter_vector
from affine_model.base_signal import Steps, base_table
from affine_model.curvature import midline
from affine_model.effects import absent_effects
from affine_model.simulate import Timing, simulate
from mujoco_ref.simulate import Initial, Setup
from mujoco_ref.simulate import simulate as reference
from tentacle.specimen import Fluid
from tentacle.waveform import Sine
from tests.conformance.both_models import ARM, ORDER, Motion, answers, bent, model_with, nominal, reduced

GIVING = replace(ARM, clamp_length=0.1 * ARM.length)
NAMES = tuple(effect.name for effect in absent_effects())
SECONDS, FPS, STEP = 1.5, 50.0, 1.0 / 400.0


def behind_clamp(model):
    """The same arm behind a clamp that gives."""
    return replace(model, specimen=GIVING)


@pytest.mark.parametrize("name", NAMES)
def test_both_models_accelerate_alike_beside_every_effect(name):
    model, motion = behind_clamp(model_with(nominal((name,)))), Motion.drawn(len(name))
    acceleration, pull = answers(*reduced(model, motion)[:2])
    (coarse, coarse_pull), (fine, fine_pull) = (answers(*bent(model, motion, n)[:2]) for n in (20, 40))
    # Second order in the links: Richardson leaves the fourth, as with a rigid clamp (test_pairs_of_effects).
    scale = np.abs(acceleration).max()
    assert np.abs((4.0 * fine - coarse) / 3.0 - acceleration).max() < 2e-3 * scale
    left = max(2e-3 * max(abs(pull), 0.05), 0.01 * abs(fine_pull - coarse_pull))
    assert abs((4.0 * fine_pull - coarse_pull) / 3.0 - pull) < left
    rigid = answers(*reduced(model_with(nominal((name,))), motion)[:2])[0]
    assert np.abs(rigid - acceleration).max() > 0.02 * scale  # and the clamp matters


@pytest.mark.parametrize("share", [0.0, 0.05, 0.2])
def test_both_models_swing_alike(share):
    """From rest in water: the distance of the two motions is that of a rigid clamp, whatever the clamp gives."""
    plain = model_with({"added_mass": {"C_a": 0.8}}, Fluid(998.0))
    model = replace(plain, specimen=replace(ARM, clamp_length=share * ARM.length))
    arm, parameters = arm_of(model), parameter_vector(model)[:, None]
    wave, s = Sine(0.5, 1.2), np.linspace(0.0, 1.0, 21)
    base = base_table(wave, Steps(0.0, STEP, round(SECONDS / STEP)), parameters)
    run = simulate(arm, parameters, base, Timing(STEP, round(1.0 / STEP / FPS)))
    q = run.q[:, :, 0]
    ours = midline(q, run.theta[:, 0] + arm.root_turn(q, 1), ARM.length, s)
    setup = Setup(links=40, s=s, initial=Initial(np.zeros(ORDER), np.zeros(ORDER)))
    chain = reference(model, wave, SECONDS, FPS, setup=setup)
    apart = np.sqrt(np.mean(np.sum((ours[: len(chain.t)] - chain.midline.xy) ** 2, axis=2)))
    moved = np.sqrt(np.mean(np.sum((chain.midline.xy[:, -1] - chain.midline.xy[:, -1].mean(axis=0)) ** 2, axis=1)))
    assert apart < 1e-3 * moved  # 40 links, four curvatures and the steps leave 0.02 mm of 50 mm

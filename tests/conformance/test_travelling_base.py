"""A base that travels: the reduced model in the frame of the base, the chain in the one that stands still."""

from __future__ import annotations

import numpy as np
import pytest

from affine_model.arm import Arm, active_effects, parameter_vector
from affine_model.curvature import midline
from affine_model.dynamics import Instant, balance
from affine_model.simulate import Timing, simulate
from mujoco_ref.simulate import Initial, Setup
from mujoco_ref.simulate import simulate as reference
from tentacle.specimen import AIR, Fluid, Gravity
from tentacle.waveform import Sine
from tests.conformance.both_models import ORDER, Motion, model_with, reduced

WAVE = Sine(0.2, 0.9)
SECONDS, FPS, STEP = 1.5, 50.0, 1.0 / 400.0
LAWS = {"added_mass": {"C_a": 0.8, "tangential": 0.2}, "linear_drag": {"c_n": 0.5}, "tip_mass": {"mass": 1e-3}}


def travel(t):
    """20 mm to and fro across at 1.3 Hz and 15 mm along at .7 Hz, from rest."""
    t = np.asarray(t, dtype=float)
    ways = [(0.02, 2.0 * np.pi * 1.3), (0.015, 2.0 * np.pi * 0.7)]
    place = [a * (1.0 - np.cos(w * t)) for a, w in ways]
    rate = [a * w * np.sin(w * t) for a, w in ways]
    return np.stack([*place, *rate, *(a * w**2 * np.cos(w * t) for a, w in ways)])


def run_of(model, path):
    """Midlines counted from the base (F, P, 2) [m]."""
    arm = Arm(model.specimen, model.fluid, model.gravity, ORDER, 8)
    middles = (np.arange(round(SECONDS / STEP)) + 0.5) * STEP
    base = WAVE(middles) if path is None else np.concatenate([WAVE(middles), path(middles)])
    batch = simulate(arm, parameter_vector(model)[:, None], base[:, :, None], Timing(STEP, round(1.0 / STEP / FPS)))
    return midline(batch.q[:, :, 0], batch.theta[:, 0], model.specimen.length, np.linspace(0.0, 1.0, 41))


@pytest.mark.parametrize("fluid", [Fluid(998.0), AIR], ids=["water", "air"])
def test_both_models_are_shaken_alike(fluid):
    model = model_with(LAWS if fluid.density else {}, fluid)
    setup = Setup(links=40, travel=travel, initial=Initial(np.zeros(ORDER), np.zeros(ORDER)))
    chain = reference(model, WAVE, SECONDS, FPS, setup=setup)
    np.testing.assert_allclose(chain.mount, travel(chain.t)[:2].T, atol=1e-12)  # the mount is where it is put
    seen = chain.midline.xy - chain.mount[:, None]
    shaken, still = run_of(model, travel), run_of(model, None)
    moved = np.sqrt(np.mean((shaken - still) ** 2))
    assert moved > 1e-3  # the travel matters
    # 40 links and four curvatures: 2 micrometres in water
    assert np.sqrt(np.mean((shaken - seen) ** 2)) < 5e-3 * moved


def test_steady_travel_is_a_current_and_acceleration_is_gravity():
    """Galilei: a towed arm in still water is a standing arm in a stream. Einstein: an accelerated base weighs more."""
    motion = Motion.drawn(3)
    towed = reduced_under(model_with({}), motion, [0.0, 0.0, 0.04, -0.03, 0.0, 0.0])
    streamed = reduced(model_with({"current": {"U_x": -0.04, "U_y": 0.03}}), motion)[1]
    np.testing.assert_allclose(towed[:ORDER], streamed[:ORDER], rtol=1e-12)
    dry = model_with({}, AIR, Gravity(0.3, 9.0))
    g = dry.gravity
    pushed = np.array([-0.7, 1.1])  # m/s^2
    sum_x, sum_y = g.magnitude * np.sin(g.angle) - pushed[0], g.magnitude * np.cos(g.angle) - pushed[1]
    heavier = model_with({}, AIR, Gravity(float(np.arctan2(sum_x, sum_y)), float(np.hypot(sum_x, sum_y))))
    accelerated = reduced_under(dry, motion, [0.0, 0.0, 0.0, 0.0, *pushed])
    np.testing.assert_allclose(accelerated, reduced(heavier, motion)[1], rtol=1e-9, atol=1e-12)


def reduced_under(model, motion, path):
    """The reduced model's force (n + 2,) in a state, its base at this place, rate and acceleration (6,)."""
    _, _, arm, p, u = reduced(model, motion)
    v = np.concatenate([motion.z_rate, [motion.theta_rate, 0.0]])
    return balance(arm, active_effects(p), p, u, v, Instant(motion.t, travel=np.array(path))).force

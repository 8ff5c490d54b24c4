"""Every pair of effects in both models: one motion, one answer; and what mechanics says of each pair.

The reduced model and the MuJoCo chain share no equation. In one state the chain's equations, projected on the reduced
coordinates by virtual work, are the reduced ones up to the links' discretisation, of second order in 1 / links.
"""

from itertools import combinations

import numpy as np
import pytest

from affine_model.arm import active_effects
from affine_model.dynamics import Instant, balance
from affine_model.effects import absent_effects, catalogue
from affine_model.statics import equilibrium
from mujoco_ref.simulate import Setup, make_stepper, simulate
from mujoco_ref.statics import chain_equilibrium as rest_of_chain
from tentacle.law.in_use import laws_in_use
from tentacle.law.quantities import POSITIVE_ROUNDING
from tentacle.specimen import AIR, Gravity
from tentacle.waveform import Sine
from tests.conformance.both_models import ORDER, Motion, answers, bent, model_with, nominal, reduced

NAMES = tuple(effect.name for effect in absent_effects())
PAIRS = list(combinations(NAMES, 2))
STREAMS = {"current", "sloshing"}
# What flows in brings energy of its own; so may a law of a file that does not say otherwise.
OPEN = STREAMS | {law.name for law in laws_in_use() if not law.dissipative}
WEIGHTLESS = Gravity(0.0, 0.0)


def pulls_from_outside(name):
    """Whether the effect, as a magnet or a stop, exerts a force on an arm at rest in weightless air, in some shape."""
    if catalogue()[name].force is None and catalogue()[name].tip_force is None:
        return False
    models = [model_with(effects, AIR, WEIGHTLESS) for effects in (nominal((name,)), {})]
    shapes = [Motion.drawn(seed, still=True) for seed in range(6)]
    forces = [[reduced(model, shape)[1] for shape in shapes] for model in models]
    return not np.allclose(*forces, rtol=0, atol=1e-12)


PULLING = {name for name in NAMES if name not in STREAMS and pulls_from_outside(name)}
WRITTEN = {law.name for law in laws_in_use()}


def rounding_of(names):
    """rad: how far a one-sided law of a file, rounded to have slopes, may bend an arm of stiffness 1 at rest."""
    return POSITIVE_ROUNDING if WRITTEN & set(names) else 0.0


each_effect = pytest.mark.parametrize("first", NAMES)


def pairs_of(first):
    return [pair for pair in PAIRS if pair[0] == first] or [(first,)]


@each_effect
def test_both_models_accelerate_alike_and_pull_the_base_alike(first):
    for pair in pairs_of(first):
        model, motion = model_with(nominal(pair)), Motion.drawn(len(pair[-1]))
        acceleration, pull = answers(*reduced(model, motion)[:2])
        (coarse, coarse_pull), (fine, fine_pull) = (answers(*bent(model, motion, n)[:2]) for n in (20, 40))
        # Second order: Richardson leaves the fourth, 1e-3 of the largest acceleration at these links.
        scale = np.abs(acceleration).max()
        assert np.abs((4.0 * fine - coarse) / 3.0 - acceleration).max() < 2e-3 * scale, pair
        left = max(2e-3 * max(abs(pull), 0.05), 0.01 * abs(fine_pull - coarse_pull))  # where the pull nearly cancels
        assert abs((4.0 * fine_pull - coarse_pull) / 3.0 - pull) < left, pair
        assert np.abs(fine - acceleration).max() < 0.05 * scale, (
            pair
        )  # what 40 links err by, where the accelerations nearly cancel


@each_effect
def test_energy_momentum_and_symmetry_of_the_reduced_model(first):
    for pair in pairs_of(first):
        motion = Motion.drawn(len(pair[-1]) + 1)
        model = model_with(nominal(pair))
        mass, _, arm, p, u = reduced(model, motion)
        effects = active_effects(p)
        np.testing.assert_allclose(mass, mass.T, rtol=0, atol=1e-14)
        assert np.linalg.eigvalsh(mass).min() > 0.0
        if OPEN & set(pair):
            continue
        # Energy: what the rates add to the force does the work -v M' v / 2 of the moving mass, and takes the rest.
        v = np.concatenate([motion.z_rate, [motion.theta_rate, 0.0]])
        still = balance(arm, effects, p, u, 0.0 * v, Instant(motion.t)).force
        moving = balance(arm, effects, p, u, v, Instant(motion.t)).force
        step = 1e-6
        places = (u + step * v, u - step * v)
        ahead, behind = (balance(arm, effects, p, place, 0.0 * v, Instant(motion.t)).mass_matrix for place in places)
        work = v @ (moving - still) + 0.5 * v @ ((ahead - behind) / (2.0 * step)) @ v
        assert work < 0.0, pair  # material damping and drag act in every pair
        # What depends on the shape alone is a potential's: the slopes of its forces are symmetric.
        moves = 1e-5 * np.eye(ORDER, ORDER + 2)
        slopes = np.array(
            [
                (balance(arm, effects, p, u + d, 0.0 * v, Instant(motion.t)).force
                 - balance(arm, effects, p, u - d, 0.0 * v, Instant(motion.t)).force)[:ORDER] / 2e-5
                for d in moves
            ]
        )  # fmt: skip
        assert np.abs(slopes - slopes.T).max() < 1e-6 * np.abs(slopes).max(), pair


@each_effect
def test_an_arm_that_nothing_pulls_keeps_the_shape_it_was_cast_in(first):
    """Without weight, water and motion the unloaded shape is c = c0, whatever else the material or the servo does."""
    for pair in pairs_of(first):
        if (STREAMS | PULLING) & set(pair):  # a stream of air bends an arm that it resists
            continue
        parameters = nominal(pair) | {"intrinsic_curvature": {"c0": 0.5}, "stiffness_drift": {"rate": 0.02}}
        model = model_with(parameters, AIR, WEIGHTLESS)
        _, _, arm, p, _ = reduced(model, Motion.drawn(0, still=True))
        rest = equilibrium(arm, p, t=10.0)
        np.testing.assert_allclose(rest, [0.5, *[0.0] * (ORDER - 1)], atol=1e-9 + rounding_of(pair))


@pytest.mark.parametrize("name", sorted({*NAMES, "amplitude_damping"} - PULLING))
def test_the_chain_too_rests_as_it_was_cast(name):
    parameters = nominal((name,)) | {"intrinsic_curvature": {"c0": 0.5}, "stiffness_drift": {"rate": 0.02}}
    stepper = make_stepper(model_with(parameters, AIR, WEIGHTLESS), links=12)
    state = rest_of_chain(stepper, 0.0)
    np.testing.assert_allclose(12.0 * state.q[3:], 0.5, atol=1e-8 + rounding_of((name,)))


def test_effects_beside_the_loop_s_agree_too():
    for name in sorted(set(catalogue()) - set(NAMES) - {"inertia", "elasticity", "damping", "drag", "weight"}):
        model, motion = model_with(nominal((name, "intrinsic_curvature"))), Motion.drawn(3)
        acceleration, _ = answers(*reduced(model, motion)[:2])
        coarse, fine = (answers(*bent(model, motion, n)[:2])[0] for n in (20, 40))
        assert np.abs((4.0 * fine - coarse) / 3.0 - acceleration).max() < 2e-3 * np.abs(acceleration).max(), name


@pytest.mark.parametrize("name", sorted(catalogue()))
def test_a_model_of_every_effect_runs_in_the_reference(name):
    base = name in ("inertia", "elasticity", "damping", "drag", "weight")
    model = model_with({} if base else nominal((name,)))
    run = simulate(model, Sine(0.3, 1.0), 0.2, 50.0, setup=Setup(links=8))
    assert np.all(np.isfinite(run.midline.xy))

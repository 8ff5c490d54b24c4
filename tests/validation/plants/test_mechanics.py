"""The plants against what beams are known to do, and against the MuJoCo reference that the loop knows."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from affine_model.arm import arm_of, parameter_vector
from affine_model.curvature import midline
from affine_model.simulate import Timing
from affine_model.simulate import simulate as simulate_model
from mujoco_ref.simulate import Setup, simulate
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Fluid, Gravity, Specimen
from tentacle.waveform import Ramped, Sine
from validation.plants.chain import mover
from validation.plants.elastica import move as slender
from validation.plants.laws import law_record
from validation.plants.rod import PIECES, move

ARM = {
    "length": 0.15, "base_radius": 0.011, "tip_radius": 0.003, "density": 1080.0, "water": 1000.0, "gravity": 9.80665,
    "E": 2.2e5, "eta": 4e3, "C_perp": 1.1,
}  # fmt: skip
WAVE, STEP, SECONDS = Sine(0.35, 1.2), 2e-3, 2.0


def model_of_arm(fluid, order):
    """The model of ARM with so many coordinates."""
    exact = {"elasticity": {"E": 2.2e5}, "damping": {"eta": 4e3}, "drag": {"C_perp": 1.1}}
    return Model(
        Specimen(Cone(0.011, 0.003), 0.15, 1080.0), fluid, Gravity(), order,
        {name: {key: Estimate.exact(value) for key, value in table.items()} for name, table in exact.items()},
    )  # fmt: skip


def half_steps(seconds):
    return 0.5 * STEP * np.arange(2 * round(seconds / STEP) + 1)


def test_a_held_rod_sinks_as_a_cantilever():
    # Held level in water that nearly carries it, its tip sinks by w L^4 / (8 E I), to first order in the bend.
    even = ARM | {"tip_radius": 0.011, "water": 1060.0, "C_perp": 30.0}
    theta = np.full(half_steps(5.0).size, -0.5 * np.pi)
    tip = move(law_record(**even), theta, STEP, 500)[0][-1, -1]
    drop = (1080.0 - 1060.0) * 4.0 * 9.80665 * 0.15**4 / (8.0 * 2.2e5 * 0.011**2)
    assert tip[1] == pytest.approx(drop, rel=0.02)
    assert tip[0] == pytest.approx(0.15, rel=1e-3)


@pytest.mark.parametrize(
    ("hidden", "numbers"),
    [
        ({}, {}),
        ({"added_mass": {"C_a": 1.0, "tangential": 0.0}}, {"C_a": 1.0}),
        ({"added_mass": {"C_a": 1.0, "convective": 0.0}}, {"C_a": 1.0, "added_mass_law": 1.0}),
        ({"tip_mass": {"mass": 2e-3, "reach": 0.1}},
         {"payload": 2e-3, "payload_reach": 0.015}),
        ({"soft_spot": {"depth": 0.4, "s0": 0.4}, "intrinsic_curvature": {"c0": 0.3}},
         {"depth": 0.4, "s0": 0.4, "soft_spot_law": 3.0, "c0": 0.3}),
        ({"viscoelasticity": {"g": 0.4, "tau": 0.2}, "cubic_stiffness": {"beta": 0.5}},
         {"g": 0.4, "tau": 0.2, "beta": 0.5}),
        ({"wall": {"B": 20.0, "distance": 0.6}, "dry_friction": {"c_f": 0.1, "sliding": 1.0, "rate": 0.4}},
         {"wall_B": 20.0, "wall_x": 0.09, "wall_law": 2.0, "c_f": 0.1}),
    ],
    ids=(
        "bare", "added mass", "added mass (Morison)", "payload", "soft and curved", "Maxwell and hardening",
        "wall and sliding friction",
    ),
)  # fmt: skip
def test_the_plants_swim_as_the_reference_does(hidden, numbers):
    """Ways to write the same arm's mechanics down that have no line in common."""
    model = model_of_arm(Fluid(1000.0), 2)
    angle = WAVE(half_steps(SECONDS))[0]
    chain = simulate(
        model, WAVE, SECONDS, 50.0, hidden=hidden, setup=Setup(links=40, s=np.linspace(0.0, 1.0, PIECES + 1))
    )
    swum = slice(60, 100)  # the plants start straight, the reference as it hangs
    # 32 pieces, 40 links: the rod, which stretches, is 18 to 31 micrometres of 112 mm of motion away, and 74 with a
    # payload on a lever; the chain, which cannot stretch, 4 to 15.
    for plant, most in ((move, 1e-4), (mover(PIECES), 2.5e-5)):
        places, pulls = plant(law_record(**ARM, **numbers), angle, STEP, 10)
        apart = np.sqrt(np.mean(np.sum((places[swum] - chain.midline.xy[swum]) ** 2, axis=2)))
        assert apart < most
        load = chain.load_cell[swum] - chain.load_cell[swum].mean()
        assert np.std(pulls[swum] - pulls[swum].mean() - load) < 0.06 * np.std(load)


@pytest.mark.parametrize("plant", [move, mover(24)], ids=("rod", "chain"))
@pytest.mark.parametrize(
    "numbers",
    [{}, {"C_a": 1.0, "g": 0.4, "tau": 0.2, "beta": 0.5}],
    ids=("bare", "water carried, memory, hardening"),
)
def test_the_plants_steps_are_of_second_order(plant, numbers):
    coarse, middle = step_errors(plant, numbers)
    assert coarse / middle == pytest.approx(4.0, rel=0.15)  # of first order it is 2; what is left is of higher order


@pytest.mark.parametrize("plant", [move, mover(24)], ids=("rod", "chain"))
def test_the_plants_steps_follow_sliding_friction(plant):
    # tanh(rate / .4 rad/s) is steep. Each step's iteration ends before it is exact: the rod's error falls linearly.
    coarse, middle = step_errors(plant, {"c_f": 0.1})
    assert max(coarse, middle) < 1.5e-6


@pytest.mark.parametrize("plant", [move, mover(24)], ids=("rod", "chain"))
def test_a_jump_of_the_base_s_rate_strikes_the_plants_once(plant):
    """As a gear does whose play is used up. The same jump is drawn at four places within a step."""
    bent = []
    for share in (0.0, 0.25, 0.5, 0.75):
        begin = 0.1 + share * STEP
        angle = 2.0 * np.maximum(half_steps(0.3) - begin, 0.0)  # rad/s
        places = plant(law_record(**ARM), angle, STEP, 1)[0]
        run_t = STEP * np.arange(len(places))
        tip = CubicSpline(run_t, places[:, -1])(begin + np.linspace(0.02, 0.15, 14))
        bent.append(tip - 0.15 * np.stack([-np.sin(now := 2.0 * np.linspace(0.02, 0.15, 14)), np.cos(now)], axis=1))
    # A jump between samples is spread over half a step, which moves the blow by up to a quarter of it.
    for other in bent[1:]:
        assert np.abs(other - bent[0]).max() < 1e-3 * np.abs(bent[0]).max()


def step_errors(plant, numbers):
    """By how much [m] places change from steps of 2 ms to 1 ms, and from 1 to .5 ms."""
    places = []
    for step in (2e-3, 1e-3, 5e-4):
        angle = WAVE(0.5 * step * np.arange(2 * round(1.0 / step) + 1))[0]
        places.append(plant(law_record(**ARM, **numbers), angle, step, round(0.02 / step))[0])
    return [np.sqrt(np.mean((one - other) ** 2)) for one, other in pairwise(places)]


def test_the_chain_of_ever_more_links_is_the_curvature_model():
    """Richardson's extrapolation of 24 and 48 links, beside 12 curvature coordinates: two ways to one partial
    differential equation, which have no line in common.
    """
    angle, every, s = WAVE(half_steps(SECONDS))[0], 10, np.linspace(0.0, 1.0, 25)
    coarse, fine = (mover(links)(law_record(**ARM, C_a=1.0), angle, STEP, every)[0] for links in (24, 48))
    fine = fine[:, ::2]
    exact = fine + (fine - coarse) / 3.0  # the error falls with the square of the links' length
    model = model_of_arm(Fluid(1000.0, "section"), 12)
    base = WAVE(STEP * (np.arange(round(SECONDS / STEP)) + 0.5))[:, :, None]
    run = simulate_model(arm_of(model, nodes=18), parameter_vector(model)[:, None], base, Timing(STEP, stride=every))
    curved = midline(run.q[:, :, 0], run.theta[:, 0], model.specimen.length, s)
    apart, apart_coarse = (np.sqrt(np.mean(np.sum((curved - one) ** 2, axis=2))) for one in (exact, coarse))
    motion = np.sqrt(np.mean(np.sum((curved - curved.mean(axis=0)) ** 2, axis=2)))
    assert apart < 1e-4 * motion
    assert apart < 0.2 * apart_coarse


@pytest.mark.parametrize(
    "numbers",
    [{}, {"C_a": 1.0, "payload": 2e-3, "payload_reach": 0.01, "payload_drop": 0.01, "g": 0.4, "tau": 0.2, "beta": 0.5}],
    ids=("bare", "water carried, payload on a lever, memory, hardening"),
)
def test_the_cosserat_rod_swims_as_the_rod_of_point_masses(numbers):
    pytest.importorskip("elastica")
    angle = WAVE(half_steps(0.6))[0]
    places, others = (plant(law_record(**ARM, **numbers), angle, STEP, 10)[0] for plant in (slender, move))
    apart = np.sqrt(np.mean(np.sum((places - others) ** 2, axis=2)))
    # Shear, which the other rod lacks: .7 % of 22 mm of motion.
    assert apart < 3e-4


def test_the_cosserat_rod_shears_as_the_curvature_model():
    """PyElastica's rod beside eight curvature coordinates, two programs without a common line. What is left with shear
    is stretch and the rod's 32 pieces.
    """
    pytest.importorskip("elastica")
    wave, every = Ramped(WAVE, 0.5), 10
    places = slender(law_record(**ARM), wave(half_steps(SECONDS))[0], STEP, every)[0]
    base = wave(STEP * (np.arange(round(SECONDS / STEP)) + 0.5))[:, :, None]
    s, apart = np.linspace(0.0, 1.0, places.shape[1]), []
    for compliance in (0.0, 1.0):
        model = model_of_arm(WATER, 8)
        arm = arm_of(replace(model, specimen=replace(model.specimen, shear_compliance=compliance)), nodes=14)
        run = simulate_model(arm, parameter_vector(model)[:, None], base, Timing(STEP, stride=every))
        q = run.q[:, :, 0]
        curved = midline(q, run.theta[:, 0] + arm.root_turn(q, 1), model.specimen.length, s)
        apart.append(np.sqrt(np.mean(np.sum((curved - places) ** 2, axis=2))))
    assert apart[1] < 5e-5  # 29 micrometres of 20 mm of motion
    assert apart[1] < 0.3 * apart[0]

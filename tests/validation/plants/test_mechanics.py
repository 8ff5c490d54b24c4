"""The plants against what beams are known to do, and against the MuJoCo reference that the loop knows."""

import numpy as np
import pytest

from mujoco_ref.simulate import Setup, simulate
from tentacle.model import Estimate, Model
from tentacle.specimen import Cone, Fluid, Gravity, Specimen
from tentacle.waveform import Sine
from validation.plants.chain import mover
from validation.plants.elastica import move as slender
from validation.plants.laws import law_record
from validation.plants.rod import PIECES, move

ARM = {
    "length": 0.15, "base_radius": 0.011, "tip_radius": 0.003, "density": 1080.0, "water": 1000.0, "gravity": 9.80665,
    "E": 2.2e5, "eta": 4e3, "C_perp": 1.1,
}  # fmt: skip
WAVE, STEP, SECONDS = Sine(0.35, 1.2), 2e-3, 2.0


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
    exact = {"elasticity": {"E": 2.2e5}, "damping": {"eta": 4e3}, "drag": {"C_perp": 1.1}}
    model = Model(
        Specimen(Cone(0.011, 0.003), 0.15, 1080.0), Fluid(1000.0), Gravity(), 2,
        {name: {key: Estimate.exact(value) for key, value in table.items()} for name, table in exact.items()},
    )  # fmt: skip
    angle = WAVE(half_steps(SECONDS))[0]
    chain = simulate(
        model, WAVE, SECONDS, 50.0, hidden=hidden, setup=Setup(links=40, s=np.linspace(0.0, 1.0, PIECES + 1))
    )
    swum = slice(60, 100)  # the plants start straight, the reference as it hangs
    for plant in (move, mover(PIECES)):
        places, pulls = plant(law_record(**ARM, **numbers), angle, STEP, 10)
        apart = np.sqrt(np.mean(np.sum((places[swum] - chain.midline.xy[swum]) ** 2, axis=2)))
        # 32 pieces, 40 links: 17 micrometres of 112 mm of motion bare, 40 with a wall and friction, 110 with a payload
        # on a lever; of the chain, whose steps are of first order, 60 to 100.
        assert apart < 2.5e-4
        load = chain.load_cell[swum] - chain.load_cell[swum].mean()
        assert np.std(pulls[swum] - pulls[swum].mean() - load) < 0.06 * np.std(load)


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
    # Shear and the sections' turning, which the other rod lacks: .7 % of 22 mm of motion.
    assert apart < 3e-4

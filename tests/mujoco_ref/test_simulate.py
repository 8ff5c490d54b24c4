from dataclasses import replace
from itertools import pairwise

import mujoco
import numpy as np
import pytest

import mujoco_ref
from mujoco_ref.chain_state import ChainState
from mujoco_ref.modes import natural_frequencies
from mujoco_ref.mount import MountRail, MountServo
from mujoco_ref.simulate import Initial, Setup, make_stepper, simulate, state_of_shape
from tentacle.errors import InputError
from tentacle.specimen import AIR, WATER, Gravity, Specimen
from tentacle.waveform import Chirp, Rest, Sine
from tests.mujoco_ref.arms import CONE, HANGING, HORIZONTAL, STRIP, model_of, swimming_model

WAVE = Chirp(0.5, 0.3, 2.2, 3.0)


def level_model():
    """The swimmer in a level plane, as on the paper's rails: gravity pulls out of it."""
    return replace(swimming_model(), gravity=Gravity(0.0, 0.0))


def test_old_mujoco_is_refused_at_import():
    with pytest.raises(ImportError, match=r"mujoco 3.3.1 is too old; .* mujoco >= 4.0"):
        mujoco_ref.require_version("3.3.1")
    mujoco_ref.require_version("4.1.0")


def test_same_input_gives_the_same_bits():
    one, other = (simulate(swimming_model(added_mass={"C_a": 1.0}), WAVE, 0.5, 60.0) for _ in range(2))
    assert one.midline.xy.tobytes() == other.midline.xy.tobytes()
    assert one.load_cell.tobytes() == other.load_cell.tobytes()


def test_second_order_in_the_step():
    model = swimming_model(added_mass={"C_a": 1.0})
    runs = [
        simulate(model, WAVE, 1.0, 50.0, setup=Setup(lead_in=0.5, longest_step=step)) for step in (4e-3, 2e-3, 1e-3)
    ]
    coarse, fine = (np.abs(a.midline.xy - b.midline.xy).max() for a, b in pairwise(runs))
    assert np.log2(coarse / fine) > 1.8
    assert coarse < 5e-6  # 5 micrometres of a motion of 50 mm


def test_agrees_with_mujocos_own_integrator_in_air():
    # The chain's MjModel is complete, so MuJoCo can step it alone. `discrete` is of first order (.5 mm off at .1 ms);
    # two steps extrapolated to zero come to ours.
    model = model_of(CONE, gravity=HANGING, damping={"eta": 300.0})
    run = simulate(
        model, Rest(), 0.2, 50.0, setup=Setup(links=10, longest_step=5e-4, initial=Initial(np.array([0.8, -0.4])))
    )
    stepper = make_stepper(model, links=10)
    compiled = stepper.chain.model
    compiled.jnt_stiffness[:3] = 1e9  # hold the mount

    def last_joint(step: float) -> np.ndarray:
        data, tips = mujoco.MjData(compiled), []
        compiled.opt.timestep = step
        data.qpos[:] = state_of_shape(stepper, np.array([0.8, -0.4])).q
        for i in range(round(0.2 / step) + 1):
            if i % round(0.02 / step) == 0:
                mujoco.mj_kinematics(compiled, data)
                tips.append(data.xpos[-1, :2].copy())
            mujoco.mj_step(compiled, data)
        return np.array(tips)

    lengths = stepper.chain.length[:-1]
    ours = np.stack([-np.sin(run.angles[:, :-1]) @ lengths, np.cos(run.angles[:, :-1]) @ lengths], axis=1)
    extrapolated = 2.0 * last_joint(5e-5) - last_joint(1e-4)
    np.testing.assert_allclose(ours, extrapolated, atol=3e-5)  # of a motion of 80 mm, what third order leaves


@pytest.mark.parametrize("base", ["prescribed", "servo", "rail", "stand"])
def test_momentum_closes(base):
    # Force on the mount + water's force + weight = rate of MuJoCo's own momentum, to 1e-4 N.
    model = swimming_model(skin_drag={"C_t": 0.05})
    servo = MountServo(2.0, 0.02, 1.0) if base == "servo" else None
    rail = MountRail(0.1) if base == "rail" else None
    hidden = {"mount_resonance": {"mass": 0.2, "f": 3.0}} if base == "stand" else None
    stepper = make_stepper(model, hidden, servo=servo, rail=rail)
    data, chain = mujoco.MjData(stepper.chain.model), stepper.chain
    wave, step = Sine(0.5, 1.3), 1e-3
    state = ChainState.at_rest(chain.links)
    momentum, forces = [], []
    weight = chain.model.body_mass[2:].sum() * chain.model.opt.gravity[:2]  # a stand carries the mount
    buoyancy = -model.fluid.density * stepper.body.links[:, 1].sum() * chain.model.opt.gravity[:2]
    for i in range(400):
        data.qpos[:], data.qvel[:] = state.q, state.v
        mujoco.mj_kinematics(chain.model, data)
        mujoco.mj_comPos(chain.model, data)
        mujoco.mj_comVel(chain.model, data)
        mujoco.mj_subtreeVel(chain.model, data)
        momentum.append(chain.model.body_mass.sum() * data.subtree_linvel[0, :2].copy())
        stepper.step(state, wave((i + np.array([0.0, 0.5, 1.0])) * step).T, step, 3)
        forces.append(stepper.reading[:2] + stepper.reading[2:4] + weight + buoyancy)
    missing = np.diff(momentum, axis=0) / step - np.array(forces)[:-1]
    # The first 20 ms ring from the sudden start, where the difference quotient is not the rate.
    assert np.abs(missing[50:]).max() < 1e-4


def test_load_cell_and_thrust_agree_over_a_period():
    run = simulate(swimming_model(added_mass={"C_a": 1.0}), Sine(0.5, 1.25), 8.0, 100.0)
    last = slice(-160, None)  # two periods of 80 frames
    # What a period's ends differ by after 6 s of swinging in: 1e-5 N.
    assert np.mean(run.load_cell[last]) == pytest.approx(np.mean(run.thrust[last]), abs=3e-5)
    assert np.std(run.load_cell[last]) > 1.2 * np.std(run.thrust[last])  # inertia too, instant by instant


def test_an_arm_that_swings_pushes_itself_forward():
    run = simulate(level_model(), Sine(0.5, 1.25), 6.0, 50.0, setup=Setup(rail=MountRail(0.1, viscous=0.02)))
    assert np.mean(run.thrust[-80:]) < 0.0  # towards -y, where the base is
    assert run.mount[-1, 1] < -0.01
    assert np.ptp(run.mount[:, 0]) == 0.0


def test_dry_rail_holds_against_a_weak_thrust():
    run = simulate(level_model(), Sine(0.1, 0.5), 2.0, 50.0, setup=Setup(rail=MountRail(0.1, dry=0.5)))
    assert np.ptp(run.mount[:, 1]) < 2e-5  # the bristle's own stretch


def test_quadratic_drag_decays_as_one_over_t():
    # A straight arm coasting along y meets skin drag alone: v = v0 / (1 + v0 t / l), l = 2 m / (rho C_t perimeter L).
    specimen = Specimen(STRIP, 0.2, 998.0)
    model = model_of(specimen, WATER, Gravity(0.0, 0.0), elasticity={"E": 1e8}, skin_drag={"C_t": 0.5})
    stepper = make_stepper(model, links=5, rail=MountRail(0.01))
    state = ChainState.at_rest(5)
    state.v[1] = 1.0
    for _ in range(500):
        stepper.step(state, np.zeros((3, 3)), 2e-3)
    reach = 2 * (specimen.mass + 0.01) / (998.0 * 0.5 * 0.06 * 0.2)
    assert state.v[1] == pytest.approx(1.0 / (1.0 + 1.0 / reach), rel=1e-3)


def test_terminal_speed():
    # The rail stands upright: net weight against skin drag.
    specimen = Specimen(STRIP, 0.2, 1500.0)
    model = model_of(specimen, WATER, HANGING, elasticity={"E": 1e8}, skin_drag={"C_t": 0.5})
    stepper = make_stepper(model, links=5, rail=MountRail(1e-6))
    state = ChainState.at_rest(5)
    for _ in range(1500):
        stepper.step(state, np.zeros((3, 3)), 2e-3)
    weight = (1500.0 - 998.0) * float(STRIP.area(0.0)) * 0.2 * 9.80665
    assert state.v[1] == pytest.approx(np.sqrt(weight / (0.5 * 998.0 * 0.5 * 0.06 * 0.2)), rel=1e-3)


def test_rigid_arm_turning_steadily_feels_the_integral_of_eq_15():
    # Torque = 1/2 rho C w omega^2 L^4/4; added mass and weight do no work on a straight neutrally heavy arm turning
    # evenly.
    specimen = Specimen(STRIP, 0.2, 998.0)
    model = model_of(
        specimen, WATER, Gravity(0.0, 0.0), elasticity={"E": 1e9}, damping={"eta": 1e6}, drag={"C_perp": 1.1}
    )
    for links in (10, 40):
        stepper = make_stepper(model, links=links)
        state, omega, step = ChainState.at_rest(links), 2.0, 1e-3
        state.v[2] = omega
        for i in range(300):
            angle = omega * (i + np.array([0.0, 0.5, 1.0])) * step
            stepper.step(state, np.stack([angle, np.full(3, omega), np.zeros(3)], axis=1), step, 2)
        # Two Gauss points a link integrate the cube over a link exactly: the rest is the arm's own small bend.
        assert stepper.reading[4] == pytest.approx(0.5 * 998.0 * 1.1 * 0.02 * omega**2 * 0.2**4 / 4, rel=1e-3)


def test_drag_converges_with_links():
    model = swimming_model(skin_drag={"C_t": 0.05}, added_mass={"C_a": 1.0})
    runs = [simulate(model, Sine(0.5, 1.0), 1.5, 50.0, setup=Setup(links=n, lead_in=0.5)) for n in (10, 20, 40, 80)]
    steps = [np.abs(a.midline.xy - b.midline.xy).max() for a, b in pairwise(runs)]
    orders = np.log2(np.array(steps[:-1]) / np.array(steps[1:]))
    assert np.all(orders > 1.6), orders
    assert steps[1] < 2e-4  # 20 links are within .2 mm of a tip that moves by 100


def test_free_decay_is_held_and_then_swings_at_its_frequency():
    model = model_of(CONE, gravity=HORIZONTAL, damping={"eta": 100.0})
    run = simulate(model, Rest(), 2.0, 200.0, setup=Setup(initial=Initial(np.zeros(2), release_t=0.4)))
    held = run.t < 0.4
    assert np.ptp(run.midline.xy[held], axis=0).max() == 0.0
    tip = run.midline.xy[:, -1, 0] - run.midline.xy[-1, -1, 0]
    crossings = run.t[1:][(tip[1:] > 0) & (tip[:-1] <= 0) & ~held[1:]]
    frequency = natural_frequencies(make_stepper(model), count=1)[0]
    assert 1.0 / np.mean(np.diff(crossings)[2:]) == pytest.approx(frequency, rel=0.02)


def test_undamped_arm_keeps_its_energy():
    model = model_of(CONE, gravity=HANGING)
    stepper = make_stepper(model, links=20)
    state = state_of_shape(stepper, np.array([0.5]))
    data = mujoco.MjData(stepper.chain.model)
    stepper.chain.model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY

    def energy() -> float:
        data.qpos[:], data.qvel[:] = state.q, state.v
        mujoco.mj_forward(stepper.chain.model, data)
        return float(np.sum(data.energy))

    start = energy()
    scale = 0.5 * float(np.sum(stepper.chain.stiffness * state.q[3:] ** 2))
    for i in range(1000):
        stepper.step(state, np.zeros((3, 3)), 1e-3, 4 if i == 0 else 1)
    # One Newton correction a step is not exactly symplectic: measured 2e-3 of the elastic energy after 5 periods.
    assert abs(energy() - start) < 5e-3 * scale


def test_servo_follows_within_its_torque_and_stalls_beyond():
    strong = simulate(swimming_model(), Sine(0.5, 1.0), 2.0, 50.0, setup=Setup(servo=MountServo(2.0, 0.02, 1.0)))
    assert np.abs(strong.theta - strong.command).max() < 0.03
    weak = simulate(swimming_model(), Sine(0.5, 1.0), 2.0, 50.0, setup=Setup(servo=MountServo(2.0, 0.02, 2e-3)))
    assert np.abs(weak.torque).max() <= 2e-3 * (1 + 1e-12)
    assert np.abs(weak.theta - weak.command).max() > 0.1


def test_lag_of_a_sine_is_that_of_a_first_order_filter():
    run = simulate(swimming_model(), Sine(0.5, 1.0), 4.0, 50.0, hidden={"servo_lag": {"tau": 0.05}})
    omega, t = 2 * np.pi, run.t[100:]
    expected = 0.5 / np.hypot(1, 0.05 * omega) * np.sin(omega * t - np.arctan(0.05 * omega))
    np.testing.assert_allclose(run.theta[100:], expected, atol=1e-7)


def test_backlash_lets_the_base_trail_by_half_the_play():
    run = simulate(swimming_model(), Sine(0.5, 0.5), 4.0, 50.0, hidden={"backlash": {"play": 0.1}})
    trail = run.command - run.theta
    assert np.quantile(np.abs(trail), 0.9) == pytest.approx(0.05, abs=2e-3)
    assert np.abs(trail).max() < 0.055


def test_length_of_the_midline_is_kept():
    run = simulate(swimming_model(), WAVE, 1.0, 20.0, setup=Setup(s=np.linspace(0, 1, 400)))
    arc = np.sum(np.hypot(*np.moveaxis(np.diff(run.midline.xy, axis=1), -1, 0)), axis=1)
    np.testing.assert_allclose(arc, 0.14, rtol=1e-5)  # chords of 1/400 are shorter than arcs by 1e-6


def test_unusable_runs_are_refused():
    for duration, fps in ((-1.0, 60.0), (1.0, 0.0), (float("nan"), 60.0)):
        with pytest.raises(InputError, match="positive"):
            simulate(swimming_model(), WAVE, duration, fps)
    with pytest.raises(InputError, match=r"\[0, 1\]"):
        simulate(swimming_model(), WAVE, 0.1, 60.0, setup=Setup(s=np.array([0.0, 1.2])))
    with pytest.raises(InputError, match="prescribed"):
        simulate(
            swimming_model(),
            WAVE,
            0.1,
            60.0,
            hidden={"backlash": {"play": 0.1}},
            setup=Setup(servo=MountServo(2.0, 0.02, 1.0)),
        )


def test_in_air_the_water_does_nothing():
    model = replace(swimming_model(added_mass={"C_a": 1.0}, skin_drag={"C_t": 0.1}), fluid=AIR)
    bare = replace(model_of(model.specimen, AIR, model.gravity, damping={"eta": 300.0}), fluid=AIR)
    one, other = (simulate(m, WAVE, 0.3, 50.0) for m in (model, bare))
    assert one.midline.xy.tobytes() == other.midline.xy.tobytes()
    assert np.all(one.thrust == 0.0)

"""The hidden effects by themselves, each against what its own physics says."""

import numpy as np
import pytest

from mujoco_ref.chain_state import ChainState
from mujoco_ref.modes import natural_frequencies
from mujoco_ref.simulate import make_stepper, simulate, state_of_shape
from mujoco_ref.statics import chain_equilibrium
from tentacle.specimen import AIR, WATER, Gravity, Specimen
from tentacle.waveform import Rest, Sine
from tests.mujoco_ref.arms import CONE, STRIP, model_of, swimming_model

HELD = np.zeros((3, 3))


def energy(stepper, state):
    """Elastic energy of the hinges [J]."""
    return 0.5 * float(np.sum(stepper.chain.stiffness * state.q[3:] ** 2))


def swing(stepper, q, seconds, step=1e-3):
    """Tip direction (N,) [rad] of a free swing from the shape q."""
    state = state_of_shape(stepper, np.array(q))
    out = []
    for i in range(round(seconds / step)):
        out.append(float(np.sum(state.q[2:])))
        stepper.step(state, HELD, step, 4 if i == 0 else stepper.corrections)
    return np.array(out)


def peaks(x):
    """Heights of the maxima above zero."""
    inside = (x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:]) & (x[1:-1] > 0)
    return x[1:-1][inside]


def test_dry_friction_takes_the_same_from_every_swing():
    # Coulomb: amplitude falls by equal steps; Kelvin-Voigt damping: by equal ratios.
    stiff = Specimen(STRIP, 0.2, 1070.0)
    dry = make_stepper(model_of(stiff), {"dry_friction": {"c_f": 0.02}}, links=6)
    heights = peaks(swing(dry, [0.5], 4.0))[:8]
    falls = -np.diff(heights)
    # Equal steps until the bristle no longer yields; the first mode's shape makes them equal to 15 %.
    assert falls[:5].max() / falls[:5].min() < 1.15
    wet = make_stepper(model_of(stiff, damping={"eta": 60.0}), links=6)
    ratios = np.diff(np.log(peaks(swing(wet, [0.5, -0.5], 4.0))[:10]))[3:]  # the second mode is gone by then
    assert ratios.max() / ratios.min() == pytest.approx(1.0, abs=0.15)


def test_dry_friction_holds_a_small_bend():
    # Below its yield the bristle is a spring of four times the stiffness, slack where it started: the arm rests, on
    # average, at four fifths of its bend; without friction, at none.
    held = swing(make_stepper(model_of(CONE), {"dry_friction": {"c_f": 0.3}}, links=10), [0.02, -0.02], 2.0)
    free = swing(make_stepper(model_of(CONE), links=10), [0.02, -0.02], 2.0)
    assert held.mean() == pytest.approx(0.8 * 0.01, rel=0.02)
    assert abs(free.mean()) < 0.05 * 0.01


def test_maxwell_branch_stiffens_fast_motion_and_not_the_rest_shape():
    model = model_of(CONE, gravity=Gravity(np.pi / 2))
    slow = make_stepper(model)
    branch = make_stepper(model, {"viscoelasticity": {"g": 0.5, "tau": 100.0}})
    assert chain_equilibrium(branch, 0.0).q == pytest.approx(chain_equilibrium(slow, 0.0).q, abs=1e-9)
    # tau far beyond a period: the branch is a spring, k grows by half, f by sqrt(1.5).
    still = model_of(CONE)
    base = natural_frequencies(make_stepper(still), count=1)[0]
    x = swing(make_stepper(still, {"viscoelasticity": {"g": 0.5, "tau": 100.0}}), [1e-3, -1e-3], 1.5)
    spectrum = np.abs(np.fft.rfft(x * np.hanning(x.size), 2**18))
    found = np.fft.rfftfreq(2**18, 1e-3)[np.argmax(spectrum)]
    assert found / base == pytest.approx(np.sqrt(1.5), rel=0.02)


def test_water_carried_every_way_is_as_much_mass_of_the_arm():
    """A cone's water fills its own volume, so that C_a = .5 every way is 499 kg/m^3 more arm, where nothing weighs."""
    carried = {"C_a": 0.5, "tangential": 1.0}
    effects = {"damping": {"eta": 300.0}, "drag": {"C_perp": 1.1}}
    heavier = Specimen(CONE.section, CONE.length, CONE.density + 0.5 * WATER.density)
    wave = Sine(0.4, 1.5)
    light = simulate(model_of(CONE, WATER, **effects, added_mass=carried), wave, 1.0, 60.0).midline.xy
    heavy = simulate(model_of(heavier, WATER, **effects), wave, 1.0, 60.0).midline.xy
    plain = simulate(model_of(CONE, WATER, **effects), wave, 1.0, 60.0).midline.xy
    # The sections' own rotary inertia is the arm's alone: (r / L)^2 = .008 of the rest at the base.
    assert np.abs(light - heavy).max() < 1e-2 * np.abs(plain - heavy).max()


def test_a_weight_ahead_of_the_tip_pulls_with_a_longer_lever():
    """A small load P at a reach r beyond a cantilever's tip turns that tip by P (L^2 / 2 + r L) / EI."""
    length, reach = 0.2, 0.3
    bending = 2e5 * float(STRIP.second_moment(0.0))
    pull = 0.01 * bending / length**2
    light = Specimen(STRIP, length, 1e-6)
    hung = {"tip_mass": {"mass": pull / Gravity().magnitude, "reach": reach}}
    state = chain_equilibrium(make_stepper(model_of(light, AIR, Gravity(np.pi / 2)), hung, links=40), 0.0)
    turned = -float(np.sum(state.q[2:]))
    # Order 2 in 1 / 40, and 1e-4 of nonlinearity.
    assert turned == pytest.approx(pull * length**2 * (0.5 + reach) / bending, rel=1e-3)


def test_cubic_stiffness_hardens_with_amplitude():
    stepper = make_stepper(model_of(CONE), {"cubic_stiffness": {"beta": 2.0}})

    def period(q):
        x = swing(stepper, [q], 1.0)
        up = np.flatnonzero((x[1:] > 0) & (x[:-1] <= 0))
        return float(np.mean(np.diff(up)))

    assert period(0.6) < 0.95 * period(0.02)


def test_soft_spot_bends_where_it_is():
    model = model_of(CONE, gravity=Gravity(np.pi / 2))
    plain = chain_equilibrium(make_stepper(model, links=40), 0.0).q[3:]
    soft = chain_equilibrium(make_stepper(model, {"soft_spot": {"depth": 0.5, "s0": 0.4}}, links=40), 0.0).q[3:]
    ratio = soft / plain
    s = (np.arange(40) + 0.5) / 40
    assert abs(s[np.argmax(ratio)] - 0.4) < 0.03
    assert ratio.max() == pytest.approx(2.0, rel=0.1)


def test_stiffness_drift_is_felt_over_time():
    hidden = {"stiffness_drift": {"rate": 0.02}}
    run, plain = (simulate(swimming_model(), Sine(0.4, 1.0), 10.0, 20.0, hidden=h) for h in (hidden, None))
    apart = np.sqrt(np.mean(np.sum((run.midline.xy - plain.midline.xy) ** 2, axis=2), axis=1))
    assert apart[180:].mean() > 5 * apart[1:21].mean()


def test_density_error_is_weight_and_inertia():
    # Twice as dense in air: the same as declaring it.
    light = Specimen(CONE.section, CONE.length, 1000.0)
    level = Gravity(np.pi / 2)
    hidden = make_stepper(model_of(light, AIR, level), {"buoyancy": {"density_error": 300.0}})
    declared = make_stepper(model_of(Specimen(CONE.section, CONE.length, 1300.0), AIR, level))
    np.testing.assert_allclose(chain_equilibrium(hidden, 0.0).q, chain_equilibrium(declared, 0.0).q, rtol=1e-12)
    assert natural_frequencies(hidden)[0] == natural_frequencies(declared)[0]


def test_a_swaying_tank_carries_a_neutral_arm_with_it():
    # An arm as dense as its water feels the pressure gradient as the water does: no weight, and with the base alone
    # held it bends as if the base were shaken the other way. In a current that is uniform and steady only drag remains.
    model = model_of(Specimen(CONE.section, 0.14, 998.0), WATER, added_mass={"C_a": 1.0})
    stepper = make_stepper(model, {"sloshing": {"U_cos": 0.0, "U_sin": 0.1, "f": 1.0}}, links=10)
    state = ChainState.at_rest(10)
    stepper.step(state, HELD, 1e-4, 6)
    displaced = 998.0 * float(stepper.body.links[:, 1].sum())
    acceleration = 2 * np.pi * 0.1  # of the water at t = 0
    # Froude-Krylov on the whole arm at the first instant, before it moves.
    assert stepper.reading[0] == pytest.approx(displaced * acceleration, rel=1e-3)


def test_a_stand_that_gives_rings_at_its_own_frequency():
    # A stiff straight arm on a springy stand: one mass on one spring.
    model = model_of(Specimen(STRIP, 0.2, 1070.0), elasticity={"E": 1e8}, damping={"eta": 1e4})
    hidden = {"mount_resonance": {"mass": 0.3, "f": 3.0, "damping_ratio": 0.02}}
    stepper = make_stepper(model, hidden, links=6)
    state = ChainState.at_rest(6)
    state.v[0] = 0.1
    x = []
    for i in range(3000):
        x.append(state.q[0])
        stepper.step(state, HELD, 1e-3, 4 if i == 0 else 1)
    up = np.flatnonzero((np.array(x[1:]) > 0) & (np.array(x[:-1]) <= 0))
    assert 1e3 / np.mean(np.diff(up)) == pytest.approx(3.0, rel=0.01)


def test_a_clamp_slips_beyond_its_moment_and_not_below():
    model = swimming_model()
    firm = simulate(model, Sine(0.5, 1.0), 3.0, 50.0, hidden={"clamp_slip": {"moment": 1.0}})
    loose = simulate(model, Sine(0.5, 1.0), 3.0, 50.0, hidden={"clamp_slip": {"moment": 2e-3}})
    assert np.abs(firm.theta - firm.command).max() < 5e-3  # the horn's own give
    assert np.abs(loose.theta - loose.command).max() > 0.1
    assert np.abs(loose.torque).max() < 2e-3 + 0.02 * 10  # what it holds, and its damper


def test_a_wall_adds_drag_on_its_side():
    hidden = {"wall": {"B": 100.0, "distance": 0.4}}
    run, plain = (simulate(swimming_model(), Sine(0.6, 1.0), 4.0, 50.0, hidden=h) for h in (hidden, None))
    change = run.midline.xy[100:, -1, 0] - plain.midline.xy[100:, -1, 0]
    far = plain.midline.xy[100:, -1, 0] < -0.03
    near = plain.midline.xy[100:, -1, 0] > 0.03
    assert np.std(change[near]) > 0.0
    assert np.ptp(run.midline.xy[100:, -1, 0]) < np.ptp(plain.midline.xy[100:, -1, 0])
    assert far.any()


def test_a_magnet_draws_the_tip():
    hidden = {"magnet": {"strength": 1e-5, "x": 0.05, "y": 0.15}}
    run = simulate(swimming_model(), Rest(), 0.2, 50.0, hidden=hidden)
    assert run.midline.xy[0, -1, 0] > 1e-3
    assert np.ptp(run.midline.xy[:, -1, 0]) < 1e-6  # at rest in its equilibrium

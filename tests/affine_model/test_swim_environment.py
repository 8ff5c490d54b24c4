"""The environments against gymnasium's checker, the simulation itself, and the limits that they promise."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.advance import Drive
from affine_model.simulate import Timing, simulate
from affine_model.swim import HOBBY_SERVO, PAPER_RAIL, assumed_model, paper_cone
from affine_model.swim.swimmers import Swimmers
from tentacle.errors import InputError
from tentacle.model import Estimate
from tentacle.specimen import AIR

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install tentacle-twin[learn]")

MODEL = assumed_model(paper_cone(0.21), "dragon-skin-10")


@pytest.fixture(scope="module")
def environment():
    from affine_model.swim import environment

    environment.register()
    return environment


def test_one_arm_passes_gymnasiums_checker(environment):
    from gymnasium.utils.env_checker import check_env

    check_env(gymnasium.make(environment.ID).unwrapped, skip_render_check=True)


def test_many_arms_are_each_the_one_arm(environment):
    many = gymnasium.make_vec(environment.ID, num_envs=3)
    one = gymnasium.make(environment.ID).unwrapped
    many.reset(seed=5)
    one.reset(seed=5)  # the first of the same stream of random numbers
    waves = np.sin(np.arange(6)[:, None, None] + np.arange(3)[None, :, None])
    seen, reward, *_ = [many.step(wave) for wave in waves][-1]
    alone, reward_alone, *_ = [one.step(wave[0]) for wave in waves][-1]
    np.testing.assert_allclose(seen[0], alone, rtol=1e-5, atol=1e-6)
    assert reward[0] == pytest.approx(reward_alone, rel=1e-6)
    assert seen.shape == (3, 8)


def test_an_episode_ends_and_begins_anew_in_the_same_step(environment):
    many = environment.SwimVectorEnv(2, seconds=0.15)
    many.reset(seed=1)
    for expected in (False, False, True):
        seen, _, lost, over, infos = many.step(np.ones((2, 1)))
        assert over.tolist() == [expected] * 2
        assert not lost.any()
    assert np.all(infos["final_obs"][:, 2] == 1.0)  # where it was told to go
    assert np.all(seen[:, 3:] == 0.0)  # straight and at rest again
    assert np.all(many.step(np.ones((2, 1)))[3] == [False, False])


def test_commands_one_by_one_are_the_simulation_in_one_piece():
    """With memory, lag and drift in it: nothing is lost between two commands."""
    model = MODEL.with_effect("viscoelasticity", g=Estimate.exact(0.3), tau=Estimate.exact(0.2))
    model = model.with_effect("current", U_x=Estimate.exact(0.05)).with_effect("servo_lag", tau=Estimate.exact(0.03))
    swimmers = Swimmers(model, 1)
    tables, told = [], [1.0, -1.0, -1.0, 0.3, 1.0, 0.0]
    for share in told:
        target = np.array([share * HOBBY_SERVO.angle])
        tables.append(swimmers.filter.follow(swimmers.servo_state, target, swimmers.substeps)[0])
        swimmers.command(np.array([share]))
    whole = simulate(
        swimmers.arm,
        swimmers.parameters,
        np.concatenate(tables, axis=1),
        Timing(swimmers.interval / swimmers.substeps, iterations=2),
        drive=Drive(rail=PAPER_RAIL),
    )
    n = swimmers.arm.order
    swing = np.abs(whole.q).max()
    np.testing.assert_allclose(swimmers.arm.to_monomial @ swimmers.state.u[:n], whole.q[-1], atol=2e-3 * swing)
    assert swimmers.state.u[n + 1, 0] == pytest.approx(whole.rail[-1, 0], abs=1e-3 * np.abs(whole.rail).max())


def test_no_sequence_of_commands_leaves_the_servos_limits():
    swimmers = Swimmers(MODEL, 64)
    random = np.random.default_rng(0)
    peaks = np.zeros(3)
    for k in range(60):
        share = np.sign(np.sin(np.linspace(0.5, 8.0, 64) * 0.05 * k)) if k % 2 else random.choice([-1.0, 1.0], 64)
        base, swimmers.servo_state = swimmers.filter.follow(swimmers.servo_state, share * HOBBY_SERVO.angle, 8)
        peaks = np.maximum(peaks, np.abs(base).max(axis=(1, 2)))
    limits = (HOBBY_SERVO.angle, HOBBY_SERVO.speed, HOBBY_SERVO.acceleration)
    assert np.all(peaks <= np.array(limits) * (1.0 + 1e-9))


@pytest.mark.parametrize(
    ("model", "says"),
    [
        (replace(MODEL, fluid=AIR), "no water"),
        (MODEL.with_effect("backlash", play=Estimate.exact(0.02)), "no part in swimming"),
    ],
)
def test_what_cannot_swim_is_refused(model, says):
    with pytest.raises(InputError, match=says):
        Swimmers(model, 1)

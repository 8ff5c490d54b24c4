"""From a recording to an experiment: noise found, window, frame of the midline, and when it cannot tell."""

from dataclasses import replace

import numpy as np
import pytest

from inference.compare import judged_frames
from inference.noise_floor import noise_deviation
from inference.prepare import CannotTellError, prepare, recalibrated
from tentacle.errors import InputError


def test_noise_is_found_under_motion_and_jumps():
    random = np.random.default_rng(0)
    t = np.arange(1200) / 60.0
    motion = np.sin(2 * np.pi * 1.5 * t)[:, None] * np.array([1.0, 10.0])
    noise = np.array([0.02, 0.1])
    series = motion + noise * random.standard_normal((t.size, 2))
    # A median of 1200 correlated differences: 1 sigma is about 4 %.
    np.testing.assert_allclose(noise_deviation(series), noise, rtol=0.12)
    series[300] += 50.0  # one jump moves no median
    series[400:420] = np.nan
    np.testing.assert_allclose(noise_deviation(series), noise, rtol=0.12)
    assert np.isnan(noise_deviation(series[:14])).all()  # ten differences are too few


def test_a_third_from_the_middle_on_is_held_out_and_its_end_is_fitted(recorded):
    recording = recorded(seconds=12.0)
    experiment = prepare(recording, hold_out=True).experiment
    t = experiment.observation.t
    held = t[~experiment.used]
    assert (held.min(), held.max()) == pytest.approx((6.0, 10.0), abs=1.5 / 60)
    assert np.all(np.diff(held) < 1.5 / 60)
    assert experiment.used[-1]
    np.testing.assert_array_equal(judged_frames(experiment, True), ~experiment.used)
    assert prepare(recording, hold_out=False).experiment.used.all()


def test_errors_are_stated_on_the_held_out_stretch_and_not_on_a_frame_that_was_left_out_elsewhere(recorded):
    recording = recorded(seconds=12.0)
    xy = recording.midline.xy.copy()
    xy[[100, 420]] = np.nan  # at 1.7 s, where the fit is, and at 7 s, in the stretch
    damaged = replace(recording, midline=replace(recording.midline, xy=xy))
    experiment = prepare(damaged, hold_out=True).experiment
    assert not experiment.used[[100, 420]].any()
    whole = judged_frames(prepare(recording, hold_out=True).experiment, True)
    np.testing.assert_array_equal(judged_frames(experiment, True), whole)


def test_a_midline_that_turns_with_the_base_is_turned_back(recorded):
    recording = recorded(seconds=4.0)
    theta = recording.motor.angle
    cos, sin = np.cos(-theta)[:, None], np.sin(-theta)[:, None]
    x, y = recording.midline.xy[..., 0], recording.midline.xy[..., 1]
    turned = np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
    standing = prepare(recording, hold_out=False)
    turning = prepare(replace(recording, midline=replace(recording.midline, xy=turned)), hold_out=False)
    assert not standing.words
    assert "turns with the base" in turning.words[0]
    # The base motion is fitted to the motor's samples: it follows them to micro-radians.
    np.testing.assert_allclose(turning.points, standing.points, atol=1e-6)


def test_a_servo_log_of_the_other_sign_is_turned_round(recorded):
    recording = recorded(seconds=4.0)
    motor = recording.motor
    reversed_log = replace(recording, motor=replace(motor, command=-motor.command, angle=-motor.angle))
    right, wrong = prepare(recording, hold_out=False), prepare(reversed_log, hold_out=False)
    assert not right.words
    assert "against the servo's log" in wrong.words[0]
    t = right.experiment.observation.t
    np.testing.assert_allclose(wrong.experiment.base(t), right.experiment.base(t), atol=1e-12)
    np.testing.assert_array_equal(wrong.experiment.observation.coefficients, right.experiment.observation.coefficients)


def test_noise_that_is_not_stated_is_found(recorded):
    recording = recorded(seconds=4.0, noise=2e-4)
    silent = replace(recording.midline, sigma=np.full_like(recording.midline.sigma, np.nan))
    found = prepare(replace(recording, midline=silent), hold_out=False)
    assert found.sigma == pytest.approx(2e-4, rel=0.1)  # the median over 42 columns, each good to 8 %
    assert "states no noise" in found.words[0]


def test_understated_noise_is_raised_and_overstated_noise_kept(recorded):
    experiment = prepare(recorded(seconds=4.0), hold_out=False).experiment
    random = np.random.default_rng(0)
    channels = experiment.noise_gain.size
    size = np.linspace(0.5, 3.0, channels)
    rows = size * random.standard_normal((experiment.used.size, channels))
    noisier = replace(experiment, observation=experiment.observation.subtract_residual(-rows))
    # Some 240 differences of correlated values: the median absolute deviation is good to 12 %.
    np.testing.assert_allclose(recalibrated(noisier, rows).noise_gain[size > 1.5], size[size > 1.5], rtol=0.4)
    np.testing.assert_array_equal(recalibrated(noisier, rows).noise_gain[size < 0.8], 1.0)


def test_the_ringing_of_a_model_is_no_noise(recorded):
    experiment = prepare(recorded(seconds=4.0), hold_out=False).experiment
    ringing = 50.0 * np.sin(2.0 * np.pi * 15.0 * experiment.observation.t)[:, None] + np.zeros(
        experiment.noise_gain.size
    )
    assert recalibrated(experiment, ringing).noise_gain.max() < 1.5  # the recording's noise is the one that is stated


def test_too_few_frames_too_few_points_and_a_still_arm_cannot_tell(recorded, without_motion):
    recording = recorded(seconds=2.0)
    hidden = recording.midline.xy.copy()
    hidden[20:] = np.nan
    sparse = replace(recording.midline, s=recording.midline.s[:4], xy=recording.midline.xy[:, :4])
    sparse = replace(sparse, sigma=recording.midline.sigma[:, :4])
    for midline, words in ((replace(recording.midline, xy=hidden), "usable frames"), (sparse, "points a frame")):
        with pytest.raises(CannotTellError, match=words):
            prepare(replace(recording, midline=midline), hold_out=True)
    with pytest.raises(CannotTellError, match="hardly moves"):
        prepare(without_motion, hold_out=True)
    with pytest.raises(InputError, match="no measurement"):
        prepare(replace(recording, midline=None), hold_out=True)

"""What moves an arm may be told incompletely: a log that ends early, a release that is not declared, grams."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tentacle.recording import Recording
from tentacle.signals import MotorSignal
from tentacle.slips import find_slips
from tests.made_recordings import as_markers


@pytest.fixture(scope="module")
def sound(recorded) -> Recording:
    return recorded(seconds=4.0)


def decay(recording: Recording, release: float, *, held: float = 0.0, growth: float = 0.0) -> Recording:
    """A tip that is held aside by 40 mm, rings there by `held` [m], is let go and swings at 1.4 Hz; growth [1/s]: of a
    swing that grows.
    """
    seen = replace(as_markers(recording, (1.0,)), motor=None)
    assert seen.markers is not None
    t = np.arange(0.0, 6.0, 1.0 / 60.0)
    since, omega = np.maximum(t - release, 0.0), 2.0 * np.pi * 1.4
    swing = 0.04 * np.exp((growth - 0.3) * since) * np.cos(omega * since)
    x = swing + held * np.sin(2.0 * np.pi * 7.0 * t) * (t < release)
    x = x + 2e-4 * np.random.default_rng(0).standard_normal(t.size)
    path = np.stack([x, np.sqrt(0.139**2 - x**2)], axis=-1)[:, None]
    return replace(seen, markers=replace(seen.markers, t=t, xy=path))


def cut(recording: Recording, start: float, stop: float) -> Recording:
    motor = recording.motor
    assert motor is not None
    kept = (motor.t >= start) & (motor.t <= stop)
    return replace(recording, motor=MotorSignal(motor.t[kept], motor.command[kept], motor.angle[kept]))


@pytest.mark.parametrize("held", [0.0, 0.003], ids=["still", "ringing by 3 mm"])
def test_a_hand_that_lets_go_is_told_with_its_time(sound, held) -> None:
    (slip,) = find_slips(decay(sound, 1.2, held=held))
    assert (slip.file, slip.field, slip.certain) == ("recording.toml", "release", False)
    value, sd = (float(slip.remedy.partition(f"{name} = ")[2].split()[0].strip(",")) for name in ("value", "sd"))
    assert abs(value - 1.2) < 2.0 * sd < 0.2
    assert "if it is driven" in slip.remedy


def test_a_decay_that_is_declared_or_filmed_from_its_swing_on_is_sound(sound) -> None:
    waiting = decay(sound, 1.2)
    assert find_slips(replace(waiting, declaration=replace(waiting.declaration, release_t=1.2))) == []
    assert find_slips(decay(sound, -0.3)) == []  # within the first swing
    assert find_slips(decay(sound, 0.0)) == []  # at its turning point
    assert find_slips(decay(sound, 0.2)) == []  # held for a moment: it swings for longer


def test_a_motion_that_grows_slowly_is_no_release(sound) -> None:
    """Its largest swing is not its first one."""
    assert find_slips(decay(sound, 1.2, growth=0.4)) == []


def test_a_log_that_ends_while_the_servo_turns_says_which_pictures_are_left_out(sound) -> None:
    (slip,) = find_slips(cut(sound, 0.0, 3.0))
    assert (slip.file, slip.certain) == ("motor.csv", False)
    assert "ends at 3 s, and the arm is seen from 0 to 4 s" in slip.seen
    assert "the pictures after it are left out, 60 of 24" in slip.seen  # 60 Hz
    (late,) = find_slips(cut(sound, 1.0, 4.0))
    assert "begins at 1 s" in late.seen
    assert find_slips(cut(sound, 0.0, 3.95)) == []  # three pictures


def test_a_log_that_ends_while_the_servo_rests_says_where_it_is_taken_to_rest(sound) -> None:
    motor = sound.motor
    theta = 0.2 * np.where(motor.t < 2.0, np.sin(0.5 * np.pi * motor.t) ** 2, 0.0)
    resting = replace(sound, motor=MotorSignal(motor.t, theta, theta))
    (slip,) = find_slips(cut(resting, 0.0, 3.0))
    assert "the servo rests there: for the pictures after it, 60 of 24" in slip.seen
    assert find_slips(cut(resting, 0.0, 3.8)) == []  # less than a tenth of the run


def test_a_payload_in_grams_is_told_and_one_of_a_few_arm_masses_is_sound(sound) -> None:
    mass = sound.declaration.specimen.mass  # 46 g

    def loaded(kilograms: float) -> Recording:
        specimen = replace(sound.declaration.specimen, tip_mass=kilograms)
        return replace(sound, declaration=replace(sound.declaration, specimen=specimen))

    assert find_slips(loaded(5.0 * mass)) == []
    (slip,) = find_slips(loaded(4.6))
    assert not slip.certain
    assert f"4.6 kg is {4.6 / mass:.3g} times the mass of the arm itself" in slip.seen
    assert "grams" in slip.remedy

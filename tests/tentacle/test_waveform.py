"""Waveforms: each derivative is that of the one before, and the gait is the paper's eq. 20."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.gait import GAIT_TERMS, Gait
from tentacle.io.waveform_file import read_waveform, waveform_from_table, waveform_table, write_waveform
from tentacle.servo_limits import ServoLimits
from tentacle.waveform import Chirp, Multisine, Ramped, Rest, Sine, Waveform

GAIT = Gait((0.4, 0.1, 0.05, 4.0, 3.0, 2.0, 0.3, 0.2, 0.1), bandwidth=4.0)
WAVEFORMS: list[Waveform] = [
    Rest(0.3),
    Sine(0.5, 1.1, 0.4),
    Chirp(0.4, 0.2, 2.0, 10.0),
    Multisine((0.3, 0.1), (0.5, 1.7), (0.0, 1.0)),
    GAIT,
    Ramped(Sine(0.5, 1.1, 0.4), 2.0),
    Ramped(GAIT, 1.5),
]


@pytest.mark.parametrize("waveform", WAVEFORMS, ids=repr)
def test_derivatives_equal_finite_differences(waveform: Waveform) -> None:
    t, h = np.linspace(-0.5, 6.0, 400), 1e-5
    before, now, after = waveform(t - h), waveform(t), waveform(t + h)
    assert now.shape == (3, 400)
    # Central differences: rounding 1e-16 / h = 1e-11 and h^2 / 6 = 2e-11 times a third derivative under 1e3; at the two
    # ends of a ramp the third derivative jumps, and one difference there is off by h times the jump, 1e-5 * 30.
    np.testing.assert_allclose((after[0] - before[0]) / (2 * h), now[1], atol=1e-7)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * h), now[2], atol=1e-3)


def test_the_gait_is_equation_20_where_no_harmonic_fades() -> None:
    a1, a2, a3, a4, a5, a6, a7, a8, a9 = GAIT.alpha
    wide = Gait(GAIT.alpha, bandwidth=1e6)
    for t in (0.0, 0.7, 3.1):
        square = sum(np.sin(a5 * (2 * n - 1) * t + a8) / (2 * n - 1) for n in range(1, GAIT_TERMS + 1))
        saw_tooth = sum(np.sin(a6 * n * t + a9) / n for n in range(1, GAIT_TERMS + 1))
        expected = a1 * np.sin(a4 * t + a7) + a2 * square + a3 * saw_tooth
        # The fading takes (pi/2 n f / bandwidth)^2 = 5e-11 of a harmonic of 4 Hz at most.
        assert wide(t)[0] == pytest.approx(expected, abs=1e-10)


def test_a_ramp_starts_from_rest_and_ends_in_the_motion() -> None:
    sine = Sine(0.5, 1.0, 0.9)
    ramped = Ramped(sine, 2.0)
    np.testing.assert_array_equal(ramped([0.0, -1.0]), np.zeros((3, 2)))
    later = np.linspace(2.0, 9.0, 30)
    np.testing.assert_array_equal(ramped(later), sine(later))


@pytest.mark.parametrize("waveform", WAVEFORMS, ids=repr)
def test_a_waveform_file_gives_the_waveform_back(waveform: Waveform, tmp_path: Path) -> None:
    write_waveform(waveform, tmp_path / "motion.toml")
    assert read_waveform(tmp_path / "motion.toml") == waveform
    assert waveform_from_table(waveform_table(waveform)) == waveform


def test_samples_are_a_kind_of_waveform() -> None:
    t = np.arange(0, 4, 0.01)
    sine = Sine(0.4, 0.8)
    sampled = waveform_from_table({"kind": "samples", "t_s": t.tolist(), "angle_rad": sine(t)[0].tolist()})
    judged = np.linspace(0.5, 3.5, 50)
    np.testing.assert_allclose(sampled(judged)[2], sine(judged)[2], atol=1e-4)  # (omega h)^4 = 6e-6 of 10 rad/s^2
    with pytest.raises(TypeError, match="no table"):
        waveform_table(sampled)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "waveform: missing"),
        ("[waveform]\nkind = 'sin'", "motion.toml:2: waveform.kind: 'sin' is not known (did you mean sine?)"),
        ("[waveform]\nkind = 'sine'\namplitude_rad = 1", "motion.toml:1: waveform.frequency_hz: missing"),
        ("[waveform]\nkind = 'rest'\nramp_s = 0", "motion.toml:3: waveform.ramp_s: 0 is out of range"),
        ("[waveform]\nkind = 'rest'\nramp_s = 1e308", "motion.toml:3: waveform.ramp_s: 1e+308 is out of range"),
        ("[waveform]\nkind = 'sine'\namplitude_rad = 1\nfrequency_hz = 1e200", "motion.toml:4: waveform.frequency_hz"),
        ("[waveform]\nkind = 'gait'\nalpha = [0, 0, 0, 1e200, 0, 0, 0, 0, 0]", "waveform.alpha"),
        ("[waveform]\nkind = 'rest'\nfrequency_hz = 1", "motion.toml:3: waveform.frequency_hz: unknown key"),
        ("[waveform]\nkind = 'gait'\nalpha = [1, 2]", "waveform.alpha: [1, 2] is not usable; expected a list of 9"),
        ("[waveform]\nkind = 'samples'\nt_s = [0, 0]\nangle_rad = [0, 0]", "waveform.t_s: times go back or repeat"),
        (
            "[waveform]\nkind = 'samples'\nt_s = [0, 1]\nangle_rad = [0, 0]",
            "t_s: 2 samples; expected at least 6",
        ),
    ],
)
def test_bad_waveform_files_are_refused_in_one_line(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "motion.toml").write_text(text)
    with pytest.raises(InputError) as caught:
        read_waveform(tmp_path / "motion.toml")
    assert said in str(caught.value)


def test_servo_limits_name_what_is_exceeded() -> None:
    limits = ServoLimits(angle=0.6, speed=5.0, acceleration=40.0)
    limits.check(Sine(0.5, 1.0), 3.0)
    angle, speed, acceleration = limits.peaks(Sine(0.5, 1.0), 3.0)
    omega = 2 * np.pi  # peaks lie within half a millisecond of a sample: 1 - cos(omega 5e-4) = 5e-6
    assert [angle, speed, acceleration] == pytest.approx([0.5, 0.5 * omega, 0.5 * omega**2], rel=1e-5)
    for waveform, said in (
        (Sine(0.7, 0.1), r"waveform angle: the motion reaches 0\.7 rad; expected <= 0\.6 rad"),
        (Sine(0.5, 2.0), "waveform speed"),
        (Sine(0.3, 2.0), "waveform acceleration"),
    ):
        with pytest.raises(InputError, match=said):
            limits.check(waveform, 30.0)
    with pytest.raises(InputError, match="servo limit: speed"):
        ServoLimits(1.0, 0.0, 1.0)

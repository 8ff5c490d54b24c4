"""Limits: mandatory, checked before a run, and obeyed on the way from and to neutral."""

from __future__ import annotations

import numpy as np
import pytest

from rig.protocol import Boot
from rig.safety import SafetyLimits, ServoCalibration, check_limits, check_set_points, lead_samples, set_points
from tentacle.errors import InputError
from tentacle.waveform import Rest, Sine


def test_limits_have_no_defaults() -> None:
    with pytest.raises(TypeError):
        SafetyLimits()  # type: ignore[call-arg]


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ((0.1, 0.8, 8.0, 0.9), "limits.min_angle_rad"),
        ((-0.8, 0.8, 0.0, 0.9), "limits.max_speed_rad_s"),
        ((-0.8, 0.8, 8.0, -1.0), "limits.max_current_a"),
        ((-0.8, float("nan"), 8.0, 1.0), "limits"),
        ((-0.8, 0.8, 1.0, 0.9), "limits.max_speed_rad_s"),  # 0.25 s + 0.8 s + 0.04 s to neutral: too slow
    ],
)
def test_unusable_limits_are_named(values: tuple[float, ...], field: str) -> None:
    with pytest.raises(InputError) as caught:
        SafetyLimits(*values)
    assert caught.value.field == field


def test_waveform_beyond_angle_or_speed_is_refused(limits: SafetyLimits) -> None:
    with pytest.raises(InputError, match=r"beyond the limits"):
        set_points(Sine(0.9, 1.0), 2.0, limits)
    with pytest.raises(InputError, match=r"rad/s"):
        set_points(Sine(0.7, 2.0), 2.0, limits)  # 8.8 rad/s
    with pytest.raises(InputError, match="not a number"):
        check_set_points(np.array([0.0, np.nan]), 0.02, limits)


def test_a_run_begins_and_ends_at_neutral(limits: SafetyLimits) -> None:
    cosine = Sine(0.5, 1.0, np.pi / 2)
    points = set_points(cosine, 2.0, limits)
    lead = lead_samples(cosine)
    assert points[0] == 0.0
    assert abs(points[-1]) < 1e-12
    np.testing.assert_allclose(points[lead : lead + 101], cosine(np.arange(101) * 0.02)[0])
    assert lead_samples(Rest()) == 0


def test_limits_that_the_board_was_not_built_for_are_refused(limits: SafetyLimits) -> None:
    boot = Boot(1, 1, 0, 900, 2100, 1_600_000, 20_000_000, 250_000, 0)
    check_limits(limits, ServoCalibration(), boot)
    with pytest.raises(InputError, match="pulse"):
        check_limits(limits, ServoCalibration(centre_us=1900.0), boot)

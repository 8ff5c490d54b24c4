"""The paper's rule of settling, on a decaying swell."""

from __future__ import annotations

import numpy as np
import pytest

from rig.settle import SettleRule, Settling
from tentacle.errors import InputError


def test_settled_when_the_swell_has_gone_and_not_before() -> None:
    source = np.random.default_rng(1)
    t = np.arange(0, 60, 0.0107)
    force = 0.02 * np.exp(-t / 6) * np.sin(2 * np.pi * 0.9 * t) + source.normal(0, 3e-4, t.size) + 0.1
    settling = Settling(SettleRule(threshold=1e-3, samples=200, timeout=120.0))
    at = next(time for time, reading in zip(t, force, strict=True) if (settling.add([reading]), settling.settled)[1])
    # A sine of amplitude a has deviation a / sqrt 2: with the noise's 3e-4 the threshold is met at a = 1.35e-3,
    # that is after 6 ln(0.02 / 1.35e-3) = 16.2 s, up to one window (2.1 s) later.
    assert 16.2 - 0.6 < at < 16.2 + 2.2
    assert settling.level == pytest.approx(0.1, abs=2e-4)


def test_a_few_readings_are_never_settled() -> None:
    settling = Settling(SettleRule(threshold=1.0, samples=10, timeout=1.0))
    settling.add([0.0] * 9)
    assert not settling.settled


@pytest.mark.parametrize("values", [(0.0, 10, 1.0), (1.0, 2, 1.0), (1.0, 10, 0.0)])
def test_unusable_rules_are_refused(values: tuple[float, int, float]) -> None:
    with pytest.raises(InputError):
        SettleRule(*values)

"""A payload that hangs elsewhere: both models move as if it had been declared there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.conformance.both_models import ARM, Motion, answers, bent, model_with, reduced

ALONG, ASIDE = 0.006, -0.003
ELSEWHERE = replace(ARM, tip_mass_reach=ARM.tip_mass_reach + ALONG, tip_mass_drop=ARM.tip_mass_drop + ASIDE)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_shifted_payload_is_a_payload_declared_there(seed):
    motion = Motion.drawn(seed)
    shifted = model_with({"payload_place": {"along": ALONG, "aside": ASIDE}})
    there = replace(model_with({}), specimen=ELSEWHERE)
    for shown in (lambda model: reduced(model, motion)[:2], lambda model: bent(model, motion, 20)[:2]):
        (acceleration, pull), (expected, expected_pull) = (answers(*shown(model)) for model in (shifted, there))
        np.testing.assert_allclose(acceleration, expected, rtol=1e-9)  # rounding: the same numbers in another order
        assert pull == pytest.approx(expected_pull, rel=1e-9)

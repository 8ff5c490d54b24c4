"""An effect that acts in one of several recordings is found, measured, and said to act there."""

from __future__ import annotations

from dataclasses import replace

import pytest

from discovery.diagnose import diagnose
from discovery.given import Deciding
from tests.made_recordings import record

U = 0.03
HIDDEN = {("current", "U_x"): U}


def test_a_current_in_one_of_two_recordings_is_said_to_act_there() -> None:
    with_it = replace(record(HIDDEN, seed=1), name="after")
    without = replace(record(seed=2), name="before")
    found = diagnose([without, with_it], deciding=Deciding(laws=False))
    assert found.verdict == "effect"
    assert found.effects == ("current",)
    assert found.where == {"before": (), "after": ("current",)}
    # Shared by both recordings the speed would be about half as large: the interval of 95 %, twice as wide, holds it.
    speed = found.parameters["current"]["U_x"]
    assert abs(speed.value - U) < speed.high - speed.low
    assert speed.value == pytest.approx(U, rel=0.1)


def test_an_effect_in_every_recording_is_said_to_act_in_every_one() -> None:
    both = [replace(record(HIDDEN, seed=seed), name=str(seed)) for seed in (1, 2)]
    found = diagnose(both, deciding=Deciding(laws=False))
    assert found.where == {"1": ("current",), "2": ("current",)}

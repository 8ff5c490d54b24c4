"""When a law is sought beside a verdict."""

from types import SimpleNamespace
from typing import cast

import pytest

from discovery.laws.rivals import LEFT, seeks_laws
from tentacle.diagnosis import FINER_SHAPE, Diagnosis


def answer(verdict, effects, after):
    error, floor = SimpleNamespace(midline_mm=after), SimpleNamespace(midline_mm=0.2)
    missing = tuple(name for name in effects if name != FINER_SHAPE)
    fields = {"verdict": verdict, "effects": effects, "missing_effects": missing, "after": error, "floor": floor}
    return cast(Diagnosis, SimpleNamespace(**fields))


@pytest.mark.parametrize(
    ("verdict", "effects", "after", "sought"),
    [
        ("unknown", (), 0.2, True),
        ("nothing_missing", (), 0.2, False),
        ("effect", (FINER_SHAPE,), 0.4, False),  # no effect is named: the model is only finer
        ("effect", ("current",), 0.201, False),  # at the floor
        ("effect", ("current",), 0.21 * LEFT, True),
        ("effect", ("current", "linear_drag"), 0.2, True),
        ("group", ("time_offset", "servo_lag"), 0.2, False),
        ("effect", ("current",), None, False),
    ],
)
def test_a_law_is_sought_where_the_named_effects_leave_more_or_are_several(verdict, effects, after, sought):
    assert seeks_laws(answer(verdict, effects, after)) is sought

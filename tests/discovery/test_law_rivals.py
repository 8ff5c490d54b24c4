"""When a law is sought beside a verdict, and which is shown."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import cast

import pytest

from discovery.laws.rivals import LEFT, seeks_laws, with_laws
from tentacle.diagnosis import FINER_SHAPE, Diagnosis
from tentacle.law.written_law import WrittenLaw
from tentacle.proposed_law import MissingForce, ProposedLaw


@dataclass(frozen=True)
class Answer:
    """What of a diagnosis is asked."""

    verdict: str
    effects: tuple[str, ...]
    missing_effects: tuple[str, ...]
    after: SimpleNamespace
    floor: SimpleNamespace
    words: tuple[str, ...] = ()
    missing: MissingForce | None = None


def answer(verdict, effects, after):
    error, floor = SimpleNamespace(midline_mm=after), SimpleNamespace(midline_mm=0.2)
    missing = tuple(name for name in effects if name != FINER_SHAPE)
    return cast(Diagnosis, Answer(verdict, effects, missing, error, floor))


def proposed(error):
    """A law that leaves that error [mm] on held-out frames."""
    law = SimpleNamespace(name="law_tip_drag", title="a drag at the tip", parameters=())
    return ProposedLaw(cast(WrittenLaw, law), {}, 100.0, error, 0.1, {}, 0.14)


@pytest.mark.parametrize(
    ("verdict", "effects", "after", "sought"),
    [
        ("unknown", (), 0.2, True),
        ("nothing_missing", (), 0.2, False),
        ("effect", (FINER_SHAPE,), 0.22, False),  # no effect is named: the model is only finer
        ("effect", (FINER_SHAPE,), 0.27, True),
        ("nothing_missing", (), 0.27, True),
        ("effect", ("current",), 0.201, False),  # at the floor
        ("effect", ("current",), 0.21 * LEFT, True),
        ("effect", ("current", "linear_drag"), 0.2, True),
        ("group", ("time_offset", "servo_lag"), 0.2, False),
        ("effect", ("current",), None, False),
    ],
)
def test_a_law_is_sought_where_the_named_effects_leave_more_or_are_several(verdict, effects, after, sought):
    assert seeks_laws(answer(verdict, effects, after)) is sought


def test_what_a_baseline_leaves_too_is_no_law():
    assert seeks_laws(answer("nothing_missing", (), 0.4))
    assert not seeks_laws(answer("nothing_missing", (), 0.4), own_error=True)


@pytest.mark.parametrize(
    ("effects", "error", "shown"),
    [
        ((), 0.21, True),
        ((), 0.30, True),  # sqrt(.2^2 + (.4^2 - .2^2) / 2) = .32
        ((), 0.35, False),  # better, but it leaves most of what the model leaves
        (("current",), 0.39, True),
        (("current",), 0.41, False),
    ],
)
def test_a_law_is_shown_beside_nothing_only_if_it_follows_much_better(effects, error, shown):
    before = answer("effect" if effects else "nothing_missing", effects, 0.4)
    after = with_laws(before, MissingForce(laws=(proposed(error),)))
    assert bool(after.words) is shown
    assert (after.missing is not None) is shown
    assert not shown or ("No effect is named, but" in after.words[0]) is not bool(effects)

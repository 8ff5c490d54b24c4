"""When a law is sought beside a verdict, and which is shown."""

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import cast

import pytest

from discovery.answer import cannot_tell, proposal_words
from discovery.laws.grammar import Scale, forms
from discovery.laws.operating_point import EVERY_FORM
from discovery.laws.rivals import FAMILY, LEFT, sought_forms, with_laws
from discovery.next_experiment import Proposal
from tentacle.diagnosis import FINER_SHAPE, Diagnosis, ErrorMeasure
from tentacle.io.waveform_file import waveform_table
from tentacle.proposed_law import LawExperiment, MissingForce
from tentacle.recording import Declaration, Recording
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Sine
from tests.discovery.proposals import proposed


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


@pytest.mark.parametrize(
    ("verdict", "effects", "after", "sought"),
    [
        ("unknown", (), 0.2, EVERY_FORM),
        ("nothing_missing", (), 0.2, ()),
        ("effect", (FINER_SHAPE,), 0.22, ()),  # no effect is named: the model is only finer
        ("effect", (FINER_SHAPE,), 0.27, EVERY_FORM),
        ("nothing_missing", (), 0.27, EVERY_FORM),
        ("effect", ("tip_mass",), 0.201, ()),  # at the floor, and of no family of the grammar
        ("effect", ("tip_mass",), 0.21 * LEFT, EVERY_FORM),
        ("effect", ("linear_drag",), 0.201, FAMILY["linear_drag"]),
        ("group", ("tip_mass", "skin_drag"), 0.2, FAMILY["skin_drag"]),
        ("effect", ("current", "linear_drag"), 0.2, EVERY_FORM),
        ("group", ("time_offset", "servo_lag"), 0.2, ()),
        ("effect", ("tip_mass",), None, ()),
    ],
)
def test_a_law_is_sought_where_the_named_effects_leave_more_or_are_several(verdict, effects, after, sought):
    assert sought_forms(answer(verdict, effects, after)) == sought


def test_every_family_has_forms_in_the_grammar():
    names = [form.law.name for form in forms(Scale(0.14, True, 20.0))]
    for family in FAMILY.values():
        assert all(any(name.startswith(beginning) for name in names) for beginning in family)


OF_EFFECTS = Proposal(Sine(0.3, 0.5), (("buoyancy",), ("sloshing",)), 40.0)
OF_LAWS = LawExperiment(waveform_table(Sine(0.2, 1.1)), 268.0, "The next experiment in next_experiment.toml: two laws.")


def with_effects_experiment(verdict, effects):
    """An answer whose own next experiment is on effects of the catalogue."""
    recording = Recording("one", Declaration(Specimen(Cone(0.011, 0.004), 0.14, 1070.0), WATER))
    return replace(
        cannot_tell(recording, "", 0), verdict=verdict, effects=effects, after=ErrorMeasure(0.3),
        words=("A remark.", proposal_words(OF_EFFECTS)), next_experiment=waveform_table(OF_EFFECTS.waveform),
        next_nats=OF_EFFECTS.nats,
    )  # fmt: skip


@pytest.mark.parametrize("asked", [OF_LAWS, None, replace(OF_LAWS, motion=None, words="No base motion.")])
def test_after_an_unknown_the_next_experiment_is_on_the_laws_or_none(asked):
    missing = MissingForce(laws=(proposed("jet", 0.01),), words=("Proposed law.",), experiment=asked)
    found = with_laws(with_effects_experiment("unknown", ()), missing)
    assert found.next_experiment == (asked.motion if asked else None)
    assert found.words == ("A remark.", *((asked.words,) if asked else ()))
    assert sum("next_experiment.toml" in word for word in found.sentences) == (found.next_experiment is not None)
    assert found.sentences.count("Proposed law.") == 1


def test_beside_named_effects_the_file_is_the_one_of_the_sentence():
    missing = MissingForce(laws=(proposed("jet", 0.01),), words=("Proposed law.",), experiment=OF_LAWS)
    answer = with_effects_experiment("effect", ("current",))
    found = with_laws(answer, missing)
    assert found.next_experiment == answer.next_experiment
    assert [word for word in found.words if "next_experiment.toml" in word] == [proposal_words(OF_EFFECTS)]
    assert found.missing.experiment is None
    assert not any("next_experiment.toml" in word for word in found.missing.words)


def test_what_a_baseline_leaves_too_is_no_law():
    assert sought_forms(answer("nothing_missing", (), 0.4)) == EVERY_FORM
    assert sought_forms(answer("nothing_missing", (), 0.4), own_error=True) == ()


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
    after = with_laws(before, MissingForce(laws=(replace(proposed("tip_drag", 0.1), held_out_midline_mm=error),)))
    assert bool(after.words) is shown
    assert (after.missing is not None) is shown
    assert not shown or ("No effect is named, but" in after.words[0]) is not bool(effects)

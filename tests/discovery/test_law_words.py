"""What is said of the missing force: it names what fits, explains what does not, and promises what is there."""

import pytest

from discovery.laws.law_words import experiment_of, missing_words
from discovery.laws.over import over_words
from discovery.next_experiment import SEPARATES, Proposal
from tentacle.law.expression import parse
from tentacle.proposed_law import FITS
from tentacle.waveform import Sine
from tests.discovery.proposals import FORMS, over, proposed, searched

OVER = (over("x", 0.45), over("angle", 0.39))


def test_a_law_that_fits_is_proposed():
    words = missing_words((proposed("jet", 0.01),), {"the place of every section": [searched("jet", 0.02)]}, {}, OVER)
    assert words[0].startswith("Proposed law: a steady jet around a point in space (a = ")
    assert any("37 % (1/e)" in word for word in words)  # what its reach is


def test_where_no_law_fits_the_first_sentence_says_so():
    kinds = {"the place of every section": [searched("jet", 0.08)], "the place of the tip": [searched("tether", 0.21)]}
    refused = {"law_jet": "its fit ends at a bound of reach"}
    words = missing_words((proposed("tether", 0.19),), kinds, refused, OVER)
    assert words[0] == (
        "A force at s = 0.60 is missing, across the arm; no law of the grammar fits it (the best leaves 19 %)."
    )
    assert words[1].startswith("The best law is a thread")
    assert not any("Proposed" in word or "If the law is true" in word for word in words)
    told = " ".join(words)
    assert "around a point in space, is not proposed: its fit ends at a bound of reach." in told


def test_the_share_that_fits_divides_right_laws_from_wrong_ones():
    """Shares that laws left in an outside program's recordings, whose hidden laws are known."""
    right, wrong = (0.01, 0.02, 0.03, 0.10), (0.19, 0.25, 0.35, 0.43, 0.55)
    assert max(right) < FITS < min(wrong)


def test_without_any_law_the_reason_of_the_best_is_given():
    kinds = {"time": [searched("beat_x", 0.3)]}
    words = missing_words((), kinds, {"law_beat_x": "its fit gains too little"}, OVER)
    assert "no law of the grammar fits it" in words[0]
    assert any(word.endswith("is not proposed: its fit gains too little.") for word in words)
    assert "the best leaves 30 %" in missing_words((), kinds, {}, OVER)[0]


def test_a_large_distance_is_told_as_a_bound():
    laws = (proposed("tether", 0.01, 117469.0), proposed("tip_spring", 0.3, 10.0))
    assert any("more than 1000 nats behind" in word for word in missing_words(laws, {}, {}, OVER))


@pytest.mark.parametrize(
    ("spread", "said"), [(1e-4, "If the law is true, its place is at_x"), (0.05, "do not determine")]
)
def test_an_interval_of_a_place_holds_if_the_law_is_true(spread, said):
    words = proposed("attraction", 0.01, spread=spread).region_words
    assert said in words
    assert "if the law is true" in words.lower()
    assert proposed("drag_width", 0.01).region_words == ""


def test_expressions_are_short_and_state_every_number():
    for name, form in FORMS.items():
        shown = proposed(name, 0.1).expression
        assert "6.28" not in shown
        for text in form.law.components.values():
            assert "* 1 *" not in text
            parse(text)
    assert "u_0 = 0.1 m/s" in proposed("drag_length", 0.1).expression
    assert "cos(2 pi * frequency * t)" in proposed("beat_x", 0.1).expression


def test_the_next_experiment_names_the_laws_by_their_titles():
    laws = (proposed("line_spring", 0.1), proposed("tether", 0.2))
    splits = tuple((law.law.name,) for law in laws)
    found = experiment_of(Proposal(Sine(0.3, 0.5), splits, 268.5), laws)
    assert found is not None
    assert found.motion is not None
    assert "by 268 nats: a force towards x = 0 all along the arm" in found.words
    assert "law_" not in found.words
    none = experiment_of(Proposal(Sine(0.3, 0.5), splits, 0.5 * SEPARATES), laws)
    assert none is not None
    assert none.motion is None
    assert "next_experiment.toml" not in none.words


def test_no_share_is_told_that_rounds_to_nothing():
    words = over_words((over("x", 0.004), over("angle", 0.001)))
    assert words.endswith("It follows no single coordinate.")
    alone = over_words((over("phase at 3.1 Hz", 0.9, 3.1), over("x", 0.0)))
    assert "It is periodic at 3.1 Hz: a curve over that period predicts 90 % of its variance" in alone
    assert " 0 %" not in alone


def test_a_kind_with_a_proposed_law_needs_no_excuse():
    kinds = {"time": [searched("vortex", 0.02), searched("beat_x", 0.03)]}
    words = missing_words((proposed("beat_x", 0.04),), kinds, {"law_vortex": "its fit ends at a bound of power"}, OVER)
    assert not any("not proposed" in word for word in words)

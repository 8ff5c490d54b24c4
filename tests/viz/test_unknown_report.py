"""The report after an unknown: what it says of the missing force, it says once, in words that it explains."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from discovery.laws.law_words import missing_words
from tentacle.cli.pages.diagnosis import answer_lines
from tentacle.diagnosis import Diagnosis
from tentacle.proposed_law import ForceMap, MissingForce
from tests.discovery.proposals import over, proposed, searched
from tests.page import parsed, problems
from viz.diagnosis_report import diagnosis_report
from viz.topics.verdict import verdict_markdown
from viz.words import in_words

SPLIT = "The best model adds gravity_tilt + added_mass."


def unknown(case, left: float) -> Diagnosis:
    """The case as an unknown, with a jet that leaves that share."""
    t, s = np.linspace(0.0, 6.0, 60), np.linspace(0.0, 1.0, 5)
    force, tip = np.ones((60, 5)), np.ones(60)
    shown = ForceMap("chirp 1", t, s, force, 0.1 * force, tip, 0.1 * tip)
    laws, found = (proposed("jet", left),), (over("x", 0.45), over("time", 0.001))
    kinds = {"the place of every section": [searched("jet", left)]}
    words = missing_words(laws, kinds, {}, found)
    missing = MissingForce((shown,), laws, (("the place of every section", left),), words, None, found)
    return replace(
        case.diagnosis, verdict="unknown", effects=(), parameters={}, words=(SPLIT,), next_experiment=None,
        missing=missing,
    )  # fmt: skip


def text_of(case, found: Diagnosis) -> str:
    """The page's words with single spaces between; of one recording."""
    found = replace(found, runs=found.runs[:1])
    page = diagnosis_report(found, case.recordings, "tentacle diagnose run", {}, {})
    assert problems(page) == []
    return " ".join(" ".join(parsed(page)[0].itertext()).split())


def test_every_sentence_on_the_missing_force_stands_once(case):
    found = unknown(case, 0.02)
    text = text_of(case, found)
    for sentence in found.missing.words:
        assert text.count(in_words(sentence, found)) == 1
        assert sum(sentence in line for line in answer_lines(found)) == 1


@pytest.mark.parametrize(("left", "label"), [(0.02, "with the proposed law"), (0.35, "with the best law")])
def test_the_error_with_the_law_stands_beside_those_before_and_after(case, left, label):
    found = unknown(case, left)
    assert f"0.31 mm after, 0.27 mm {label} (floor 0.21 mm)" in found.headline
    text = text_of(case, found)
    assert f"error {label} 0.27 mm" in text
    assert f"floor {label} midline mm 10.5 0.31 0.21 0.27" in text
    assert found.verdict_json()["error"]["after"]["midline_mm"] == found.after.midline_mm
    assert ("No law fits the missing force" in text) is (label == "with the best law")


def test_candidates_that_only_resemble_have_no_probability(case):
    found = unknown(case, 0.02)
    text = text_of(case, found)
    candidates = text[text.index("None of them has a probability") :]
    assert "93.0 %" not in candidates
    assert "| probability" not in verdict_markdown(found)
    assert "93.0 %" in text_of(case, case.diagnosis)


def test_names_are_titles_in_the_report_and_names_on_the_terminal(case):
    found = unknown(case, 0.02)
    text = text_of(case, found)
    assert "The best model adds gravity tilt + added mass." in text
    assert any(SPLIT in line for line in answer_lines(found))
    compared = in_words("Compare law_jet with gravity_tilt: --effects laws/law_jet.toml.", found)
    assert compared == "Compare a steady jet around a point in space with gravity tilt: " + (
        "--effects laws/law_jet.toml."
    )


def test_its_words_are_explained(case):
    text = text_of(case, unknown(case, 0.35))
    explained = text[text.index("Words ") :]
    for term in ("judged", "reach", "missing force", "grammar", "held out", "law"):
        assert f" {term} " in explained
    for unexplained in ("structured error", "generalised force", "the curvature before", "nothing (a steady"):
        assert unexplained not in text

"""Results show themselves in a notebook: well-formed, escaped, with the numbers that the report has."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree


def texts(html: str) -> list[str]:
    return list(ElementTree.fromstring(f"<div>{html}</div>").itertext())


def test_a_diagnosis_shows_headline_errors_and_what_was_found(case):
    shown = texts(case.diagnosis._repr_html_())
    assert shown[0] == case.diagnosis.headline
    row = shown.index("midline")
    assert shown[row : row + 5] == ["midline", "mm", "10.5", "0.31", "0.21"]
    assert shown[shown.index("speed") :][:4] == ["speed", "0.052", "0.047 to 0.058", "m/s"]


def test_names_cannot_break_the_page(case):
    assert "<b>" in texts(replace(case.diagnosis, effects=("<b>",))._repr_html_())[0]


def test_a_model_shows_its_parameters(case):
    shown = texts(case.diagnosis.augmented_model._repr_html_())
    assert shown[0] == "Model with 2 curvature coordinates"
    assert shown[shown.index("current") :][:5] == ["current", "speed", "0.052", "0.047 to 0.058", "m/s"]

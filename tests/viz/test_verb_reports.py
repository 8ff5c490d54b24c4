"""The other verbs' reports are pages of the same design: valid, whole, and with the numbers that were handed over."""

from __future__ import annotations

import numpy as np

from viz.optimise import Search
from viz.report import Origin
from viz.scene import scene_of
from viz.verb_reports import model_report, optimisation_report


def test_a_search_shows_its_course_its_motion_and_its_promise():
    search = Search(np.array([50.0, 100.0, 150.0]), np.array([0.01, 0.02, 0.02]), np.arange(3.0), np.zeros(3))
    rows = [("thrust", "mN", "21.0", "8.1")]
    page = optimisation_report({"CMA-ES": search}, "mean thrust [N]", rows, "2.6 times the best sine.", Origin("x"))
    for wanted in (
        "2.6 times the best sine.",
        ">21.0</td>",
        "best mean thrust [N]",
        "base angle [rad]",
        "evaluations [1]",
    ):
        assert wanted in page


def test_a_fit_shows_its_parameters_and_its_error(case):
    scene = scene_of(case.diagnosis.runs[0])
    page = model_report(
        "identify", "Identified", "A sentence.", case.diagnosis.base_model, [scene], ["in words"], Origin("tentacle")
    )
    error = f"{scene.judged_rms_mm(scene.models[0]):.3g} mm"
    for wanted in ("280 to 340", "in words", f">{error}</dd>", "Recording: chirp 1"):
        assert wanted in page

"""The report of an identified model has the numbers that were handed over."""

from __future__ import annotations

from viz.identify_report import Told, model_report
from viz.report import Origin
from viz.scene import scene_of


def test_a_fit_shows_its_parameters_and_its_error(case):
    scene = scene_of(case.diagnosis.runs[0])
    page = model_report(
        case.diagnosis.base_model,
        Told("A sentence.", ["in words"], {"elasticity.E": 188000.0}, {"elasticity.E": (291000.0, 333000.0)}),
        [scene],
        case.recordings[:1],
        Origin("tentacle"),
    )
    error = f"{scene.judged_rms_mm(scene.models[0]):.3g} mm"
    for wanted in (
        "280 to 340",
        "291000 to 333000",
        ">188000</td>",
        "in words",
        f">{error}</dd>",
        "Recording: chirp 1",
    ):
        assert wanted in page

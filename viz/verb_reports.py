"""The reports of the verbs beside diagnose, in the same design: a fit or a comparison, a search for the best motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from tentacle.model import Model
from viz.diagnosis_report import parameter_rows, run_section, runs_section
from viz.figures.motion import motion_figure
from viz.figures.search import search_figure
from viz.optimise import Search
from viz.report import Origin, Picture, Report, Section, Table, render
from viz.scene import Scene
from viz.words import number


def model_report(
    verb: str, title: str, headline: str, model: Model, scenes: Sequence[Scene], words: Sequence[str], origin: Origin
) -> str:
    """report.html of a fitted or compared model: its parameters with intervals, and every run beside its subject."""
    rows = [row[:5] for row in parameter_rows(model, None)]
    header = ("effect", "parameter", "value", "95 % interval", "unit")
    arm = f"The arm is described by {model.order} curvature coordinates."
    sections = [
        Section("Parameters", [arm, *words], [Table("Parameters of the model", header, rows, numeric=(2,))]),
        runs_section(scenes),
        *(run_section(scene, None) for scene in scenes),
    ]
    errors = [scene.judged_rms_mm(scene.models[0]) for scene in scenes if scene.models]
    merits = [("largest error", f"{number(max(errors))} mm")] if errors else []
    return render(Report(verb, title, headline, sections, origin, merits))


def optimisation_report(
    searches: Mapping[str, Search], quantity: str, promises: Sequence[Sequence[str]], headline: str, origin: Origin
) -> str:
    """report.html of a search for the largest `quantity` (with its unit).

    promises: rows (quantity, unit, found, best sine) of what the motion found promises, beside the best sine.
    """
    courses = {name: (search.evaluations, search.best_so_far) for name, search in searches.items()}
    motions = {name: (search.t, search.theta) for name, search in searches.items()}
    promise = Table(
        "The motion found beside the best sine", ("quantity", "unit", "found", "best sine"), promises, (2, 3)
    )
    sections = [
        Section("What it promises", (), [promise]),
        Section("The motion", (), (), [Picture(motion_figure(motions), "Base angle of the best motion found.")]),
        Section("The search", (), (), [Picture(search_figure(courses, quantity), "Best value after so many trials.")]),
    ]
    return render(Report("optimise", "Best base motion", headline, sections, origin))

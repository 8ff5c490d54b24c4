"""The report of `tentacle identify`, in the same design as that of diagnose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from tentacle.model import Model
from tentacle.recording import Recording
from tentacle.rounding import number
from viz.diagnosis_report import parameter_table_rows, run_section, runs_section
from viz.report import Origin, Report, ReportSection, ReportTable, render_report
from viz.scene import ViewedRun, swims


@dataclass(frozen=True)
class Told:
    """The results: the headline, sentences, the paper's values (effect.parameter -> value; empty where its
    regression could not be done), the bootstrap's intervals (effect.parameter -> low, high; empty if not asked for).
    """

    headline: str
    words: Sequence[str]
    regression: Mapping[str, float]
    drawn: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def model_report(
    model: Model,
    told: Told,
    scenes: Sequence[ViewedRun],
    recordings: Sequence[Recording],
    origin: Origin,
) -> str:
    """report.html of an identified model: its parameters with intervals, and every run beside its recording.

    A recording a scene.
    """
    rows = [row[:5] for row in parameter_table_rows(model, None)]
    header: tuple[str, ...] = ("effect", "parameter", "value", "95 % interval", "unit")
    names = [f"{effect}.{name}" for effect, values in model.parameters.items() for name in values]
    if told.drawn:
        ends = [told.drawn.get(name) for name in names]
        shown = ["" if pair is None else f"{number(pair[0])} to {number(pair[1])}" for pair in ends]
        rows = [(*row, interval) for row, interval in zip(rows, shown, strict=True)]
        header = (*header, "by the bootstrap")
    if told.regression:
        rows = [(*row, number(told.regression.get(name))) for row, name in zip(rows, names, strict=True)]
        header = (*header, "by the paper's regression")
    numeric = (2, len(header) - 1) if told.regression else (2,)
    arm = f"The arm is described by {model.order} curvature coordinates."
    sections = [
        ReportSection(
            "Parameters", [arm, *told.words], [ReportTable("Parameters of the model", header, rows, numeric=numeric)]
        ),
        runs_section(scenes),
        *(
            run_section(scene, recording, swims=swims(model.fluid, [scene.theta]))
            for scene, recording in zip(scenes, recordings, strict=True)
        ),
    ]
    errors = [scene.judged_rms_mm(scene.models[0]) for scene in scenes if scene.models]
    merits = [("largest error", f"{number(max(errors))} mm")] if errors else []
    return render_report(Report("identify", "Identified model", told.headline, sections, origin, merits))

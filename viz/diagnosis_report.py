"""The report of `tentacle diagnose`, from a Diagnosis and the recordings it judged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from tentacle.diagnosis import Diagnosis
from tentacle.model import Model
from tentacle.recording import Recording
from tentacle.rounding import NO_VALUE, number
from viz.candidate_section import candidate_section
from viz.figures.budget import budget_figure
from viz.figures.coordinates import coordinates_figure
from viz.figures.force_over import force_over_figure
from viz.figures.missing_force import missing_force_figure
from viz.figures.residual import residual_figure
from viz.figures.sensors import sensors_figure
from viz.figures.shapes import shapes_figure
from viz.figures.spectrum import spectrum_figure
from viz.figures.thrust import thrust_figure
from viz.report import Origin, Picture, Report, ReportSection, ReportTable, render_report
from viz.scene import ViewedRun, paired, scene_of, swims
from viz.verdict_sections import finding_section, limits_sections, next_section, title_of, untold_section
from viz.words import effect_name, error_rows, in_words

DRAWN_RUNS = 4  # runs with figures; the others are in the table only (a report stays under 3 MB)


def error_section(diagnosis: Diagnosis) -> ReportSection:
    """The errors before and after, the floor, and where the error comes from."""
    judged = "held-out data, on which nothing was fitted" if diagnosis.held_out else "the data that were fitted"
    added = (
        "the best set of the catalogue, which is not named"
        if diagnosis.verdict == "unknown"
        else "what the verdict adds"
    )
    paragraph = (
        f"Root mean square over {judged}. Before: the declared model after its own refit. After: with {added}. "
        "Floor: the error from measurement noise and the reduction to few coordinates alone."
    )
    rows: list[tuple[str, ...]] = list(error_rows(diagnosis.before, diagnosis.after, diagnosis.floor))
    header = ("quantity", "unit", "before", "after", "floor")
    if diagnosis.first_law is not None:
        header = (*header, diagnosis.law_label)
        error = number(diagnosis.first_law.held_out_midline_mm)
        rows = [(*row, error if row[0] == "midline" else NO_VALUE) for row in rows]
        paragraph += " The last column has the declared model with the first law that was found, on the same frames."
    after, floor = diagnosis.after.midline_mm, diagnosis.floor.midline_mm
    if after is not None and floor is not None and after < floor:
        paragraph += (
            f" Here the error after, {number(after)} mm, is below the floor, {number(floor)} mm. The floor has the "
            "reduction's error in the reference simulation, and in this arm that error is smaller. The model is as "
            "good as these data can show."
        )
    table = ReportTable("Errors", header, rows, numeric=tuple(range(2, len(header))))
    budget = Picture(
        budget_figure(diagnosis.budget),
        "Error budget of the declared model. Independent parts add in squares.",
    )
    return ReportSection("Error before and after", [paragraph], [table], [budget])


def parameter_table_rows(model: Model, base: Model | None) -> list[tuple[str, ...]]:
    """Rows (effect, parameter, value, interval, unit, before) of a model beside the one before it."""
    rows = []
    for effect, values in model.parameters.items():
        for name, estimate in values.items():
            earlier = None if base is None else base.parameters.get(effect, {}).get(name)
            before = "" if base is None else ("not in the model" if earlier is None else number(earlier.value))
            rows.append(
                (effect_name(effect), name, estimate.value_words, estimate.interval_words, estimate.unit, before)
            )
    return rows


def parameter_section(diagnosis: Diagnosis) -> ReportSection:
    """The parameters that were found, as in verdict.json, and every parameter of model.toml."""
    model = diagnosis.augmented_model
    rows = parameter_table_rows(model, diagnosis.base_model)
    added = tuple(k for k, row in enumerate(rows) if row[5] == "not in the model")
    header = ("effect", "parameter", "value", "95 % interval", "unit", "before")
    words = [f"The arm is described by {model.order} curvature coordinates (before: {diagnosis.base_model.order})."]
    tables = [ReportTable("Parameters of model.toml", header, rows, numeric=(2, 5), marked=added)]
    found = [
        (effect_name(effect), name, estimate.value_words, estimate.interval_words, estimate.unit)
        for effect, values in diagnosis.parameters.items()
        for name, estimate in values.items()
    ]
    if found:
        words.append(
            "The values found are estimated together with unknown forces, over all likely answers. model.toml has the "
            "values with which the model alone is closest to the data. Noise alone would give narrower intervals: both "
            "are widened by the same factor, for the laws' form is known only approximately."
        )
        tables.insert(0, ReportTable("What was found", header[:5], found, numeric=(2,)))
    return ReportSection("Parameters", words, tables)


def worst_runs(scenes: Sequence[ViewedRun], count: int) -> list[ViewedRun]:
    """The runs with the largest error before, largest first."""
    return sorted(scenes, key=lambda scene: -np.nan_to_num(scene.judged_rms_mm(scene.models[0]), nan=-1.0))[:count]


def run_section(scene: ViewedRun, recording: Recording | None, *, swims: bool) -> ReportSection:
    """The figures of one run; its thrust where a load cell measured it, or the arm swims."""
    pictures = [Picture(shapes_figure(scene), "Shapes at instants spread over the swing; models run open loop.")]
    if any(party.q is not None and np.isfinite(party.q).any() for party in scene.parties):
        pictures.append(Picture(coordinates_figure(scene), "The paper's coordinates; grey: where errors are judged."))
    if scene.models:
        pictures.append(Picture(residual_figure(scene), "Error of the models over arc length and time."))
    pictures.append(Picture(spectrum_figure(scene), "Tip, along n: spectra of the motion and of each model's error."))
    load_cell = recording.load_cell if recording else None
    thrust = thrust_figure(scene, load_cell) if swims or load_cell is not None else None
    if thrust is not None:
        pictures.append(Picture(thrust, "Thrust, as a load cell at the base reads it."))
    strain, acceleration = sensors_figure(scene, "strain"), sensors_figure(scene, "acceleration")
    if strain is not None:
        pictures.append(Picture(strain, "Strain at the gauges, about its mean."))
    if acceleration is not None:
        words = "What the accelerometers read, gravity included, about its mean."
        pictures.append(Picture(acceleration, words))
    return ReportSection(f"Recording: {scene.name}", (), (), pictures)


def runs_section(scenes: Sequence[ViewedRun]) -> ReportSection:
    """Every recording's own error."""
    rows = []
    for scene in scenes:
        errors = [number(scene.judged_rms_mm(party)) for party in scene.models]
        span = f"{scene.t[0]:.2f} to {scene.t[-1]:.2f}"
        rows.append((scene.name, scene.points, span, str(int(scene.judged.sum())), *errors))
    names = [f"{party.role.name} [mm]" for party in scenes[0].models] if scenes else []
    words = [f"Figures follow for the {DRAWN_RUNS} with the largest error."] if len(scenes) > DRAWN_RUNS else []
    header = ("recording", "points", "t [s]", "judged instants", *names)
    numeric = tuple(range(3, 4 + len(names)))
    return ReportSection(
        "Recordings", words, [ReportTable("Distance to the measured points, rms", header, rows, numeric=numeric)]
    )


def missing_sections(diagnosis: Diagnosis) -> list[ReportSection]:
    """After an unknown: the missing force in words and as a map of every recording; nothing otherwise."""
    missing = diagnosis.missing
    if not missing.maps:
        return []
    words = [
        *(in_words(word, diagnosis) for word in missing.words),
        "The figure shows a smooth force along the arm and one at the tip, both along the normal: the smallest ones "
        "that give the measured motion. A force near the tip can appear in either. The band is one standard deviation. "
        "The figure is blank where frames are held out or lacking.",
    ]
    pictures = [
        Picture(
            missing_force_figure(one, missing.kinds if k == 0 else ()), f"{one.name}: the force that the model misses."
        )
        for k, one in enumerate(missing.maps[:DRAWN_RUNS])
    ]
    if missing.over:
        first = missing.over[0]
        words_of = f"{first.name}: the missing force as one at {first.place}, over each coordinate of that place."
        pictures.append(Picture(force_over_figure(missing.over), words_of))
    return [ReportSection("The missing force", words, (), pictures)]


def answer_sections(diagnosis: Diagnosis, recordings: Sequence[Recording], command: str) -> list[ReportSection]:
    """Every section of an answer that tells something."""
    pairs = [(scene_of(run), recording) for run, recording in paired(diagnosis.runs, recordings)]
    scenes = [scene for scene, _ in pairs]
    known = {scene.name: recording for scene, recording in pairs}
    swimming = swims(diagnosis.base_model.fluid, [run.theta for run in diagnosis.runs])
    filmed = [scene for scene, recording in pairs if recording is not None and recording.video is not None]
    return [
        finding_section(diagnosis, worst_runs(filmed or scenes, 1), known),
        *missing_sections(diagnosis),
        next_section(diagnosis, command, recordings),
        error_section(diagnosis),
        parameter_section(diagnosis),
        *limits_sections(diagnosis.verdict_json(), diagnosis.first_law),
        candidate_section(diagnosis),
        runs_section(scenes),
        *(run_section(scene, known.get(scene.name), swims=swimming) for scene in worst_runs(scenes, DRAWN_RUNS)),
    ]


def merits_of(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """Confidence and errors, as they stand below the headline."""
    errors = {"error before": diagnosis.before.midline_mm, "error after": diagnosis.after.midline_mm}
    if diagnosis.first_law is not None:
        errors[f"error {diagnosis.law_label}"] = diagnosis.first_law.held_out_midline_mm
    shown = [(name, NO_VALUE if error is None else f"{error:.2f} mm") for name, error in errors.items()]
    return [("confidence", f"{diagnosis.confidence:.0%}"), *shown]


def diagnosis_report(
    diagnosis: Diagnosis,
    recordings: Sequence[Recording],
    command: str,
    versions: Mapping[str, str],
    inputs: Mapping[str, str],
) -> str:
    """report.html of a diagnosis as text.

    command is the line that made it, versions maps a package to its version, inputs a file to its SHA-256. recordings
    are found by the runs' names and give the load cell; they may be empty. The same arguments give the same text.
    """
    told = not diagnosis.cannot_tell
    return render_report(
        Report(
            verb="diagnose",
            title=title_of(diagnosis),
            headline=in_words(diagnosis.headline, diagnosis),
            sections=answer_sections(diagnosis, recordings, command) if told else [untold_section(tuple(inputs))],
            origin=Origin(command, diagnosis.seed, versions, inputs),
            figures_of_merit=merits_of(diagnosis) if told else [],
        )
    )

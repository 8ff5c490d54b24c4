"""The report of `tentacle diagnose`, from a Diagnosis and the recordings it judged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tentacle.diagnosis import Diagnosis
from tentacle.model import Model
from tentacle.recording import Recording
from tentacle.signals import Array
from viz.figures.budget import budget_figure
from viz.figures.coordinates import coordinates_figure
from viz.figures.ranking import ranking_figure
from viz.figures.residual import residual_figure
from viz.figures.shapes import shapes_figure
from viz.figures.spectrum import spectrum_figure
from viz.figures.thrust import thrust_figure
from viz.figures.twins import twins_figure
from viz.report import Origin, Picture, Report, Section, Table, render
from viz.scene import Scene, paired, scene_of
from viz.words import NONE, VERDICT_TITLES, effect_name, error_rows, interval, number

DRAWN_RUNS = 4  # runs with figures of their own; the others stand in the table (a report stays under 3 MB)
TWIN_COSINE = 0.85  # pairs above this are named in words


def error_section(diagnosis: Diagnosis) -> Section:
    """The errors before and after, the floor, and where the error comes from."""
    judged = "held-out data, on which nothing was fitted" if diagnosis.held_out else "the data that were fitted"
    paragraph = (
        f"Root mean square over {judged}. Before: the model as declared, refitted as well as it goes. After: with what "
        "the verdict adds. Floor: what measurement noise and the reduction to few coordinates alone would leave."
    )
    rows = error_rows(diagnosis.before, diagnosis.after, diagnosis.floor)
    table = Table("Errors", ("quantity", "unit", "before", "after", "floor"), rows, numeric=(2, 3, 4))
    budget = Picture(
        budget_figure(diagnosis.budget),
        "Error budget of the declared model. Independent parts add in squares.",
    )
    return Section("Error before and after", [paragraph], [table], [budget])


def parameter_rows(model: Model, base: Model | None) -> list[tuple[str, ...]]:
    """Rows (effect, parameter, value, interval, unit, before) of a model beside the one before it."""
    rows = []
    for effect, values in model.parameters.items():
        for name, estimate in values.items():
            earlier = None if base is None else base.parameters.get(effect, {}).get(name)
            before = "" if base is None else ("not in the model" if earlier is None else number(earlier.value))
            rows.append((effect_name(effect), name, number(estimate.value), interval(estimate), estimate.unit, before))
    return rows


def parameter_section(diagnosis: Diagnosis) -> Section:
    """Every parameter of the augmented model with its interval; for a group, each candidate's own."""
    model = diagnosis.augmented_model
    rows = parameter_rows(model, diagnosis.base_model)
    added = tuple(k for k, row in enumerate(rows) if row[5] == "not in the model")
    header = ("effect", "parameter", "value", "95 % interval", "unit", "before")
    arm = f"The arm is described by {model.order} curvature coordinates (before: {diagnosis.base_model.order})."
    tables = [Table("Parameters of the augmented model", header, rows, numeric=(2, 5), marked=added)]
    elsewhere = [
        (effect_name(effect), name, number(estimate.value), interval(estimate), estimate.unit)
        for effect, values in diagnosis.parameters.items()
        for name, estimate in values.items()
        if name not in model.parameters.get(effect, {})
    ]
    if elsewhere:
        tables.append(Table("Found, each with its own refit", header[:5], elsewhere, numeric=(2,)))
    return Section("Parameters", [arm], tables)


def gate_section(diagnosis: Diagnosis) -> Section:
    """Whether the augmented model leaves anything that noise does not explain."""
    rows = [
        (gate.name, number(gate.statistic), number(gate.threshold), "passed" if gate.passed else "failed", gate.words)
        for gate in diagnosis.gates
    ]
    failed = tuple(k for k, gate in enumerate(diagnosis.gates) if not gate.passed)
    header = ("test", "statistic", "threshold", "result", "in words")
    return Section(
        "Is the model adequate?",
        ["A model passes only where its residual looks like the measurement's noise: in size, in time, over the run."],
        [Table("Adequacy tests", header, rows, numeric=(1, 2), warned=failed)] if rows else [],
    )


def twin_words(names: Sequence[str], cosines: Array) -> str:
    """The pairs of effects that this recording hardly tells apart, as a sentence."""
    pairs = [
        (abs(float(cosines[i, j])), names[i], names[j])
        for i in range(len(names))
        for j in range(i)
        if abs(cosines[i, j]) >= TWIN_COSINE
    ]
    if not pairs:
        return f"No pair of candidates has |cos| above {TWIN_COSINE:g}: this excitation separates them."
    listed = "; ".join(f"{effect_name(a)} / {effect_name(b)} ({c:.3f})" for c, a, b in sorted(pairs, reverse=True)[:8])
    return f"Nearly twins under this excitation: {listed}. They are told apart only by much data or another motion."


def candidate_section(diagnosis: Diagnosis) -> Section:
    """The catalogue as ranked, and which candidates resemble one another."""
    rows = [
        (effect_name(r.effect), number(r.score), number(r.held_out_midline_mm), f"{r.probability:.3f}")
        for r in diagnosis.ranking
    ]
    marked = tuple(k for k, ranked in enumerate(diagnosis.ranking) if ranked.effect in diagnosis.effects)
    tables, pictures = [], []
    if rows:
        header = ("effect", "score [nat]", "judged error [mm]", "probability")
        tables.append(Table("Every candidate, added alone", header, rows, numeric=(1, 2, 3), marked=marked))
        pictures.append(
            Picture(ranking_figure(diagnosis.ranking, diagnosis.effects), "Candidates; hatched: in the verdict.")
        )
    paragraphs = []
    if len(diagnosis.twin_names) > 1:
        paragraphs.append(twin_words(diagnosis.twin_names, diagnosis.twin_cosines))
        pictures.append(
            Picture(
                twins_figure(diagnosis.twin_names, diagnosis.twin_cosines),
                "How alike the candidates' effects on these recordings are, what refitting the base absorbs taken off.",
            )
        )
    return Section("Candidates", paragraphs, tables, pictures)


def worst_runs(scenes: Sequence[Scene], count: int) -> list[Scene]:
    """The runs with the largest error before, largest first."""
    return sorted(scenes, key=lambda scene: -np.nan_to_num(scene.judged_rms_mm(scene.models[0]), nan=-1.0))[:count]


def run_section(scene: Scene, recording: Recording | None) -> Section:
    """The figures of one run."""
    pictures = [Picture(shapes_figure(scene), "Shapes at instants spread over the swing; models run open loop.")]
    if any(party.q is not None and np.isfinite(party.q).any() for party in scene.parties):
        pictures.append(Picture(coordinates_figure(scene), "The paper's coordinates; grey: where errors are judged."))
    if scene.models:
        pictures.append(Picture(residual_figure(scene), "Where and when the models miss."))
    pictures.append(Picture(spectrum_figure(scene), "Tip, along n: the motion, and what each model leaves of it."))
    thrust = thrust_figure(scene, recording.load_cell if recording else None)
    if thrust is not None:
        pictures.append(Picture(thrust, "Thrust, as a load cell at the base reads it."))
    return Section(f"Recording: {scene.name}", (), (), pictures)


def runs_section(scenes: Sequence[Scene]) -> Section:
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
    return Section("Recordings", words, [Table("Distance to the measured points, rms", header, rows, numeric=numeric)])


def flatten(table: Mapping[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """A waveform table as rows (key, value), nested keys joined by dots."""
    rows: list[tuple[str, str]] = []
    for key, value in table.items():
        if isinstance(value, Mapping):
            rows += flatten(value, f"{prefix}{key}.")
        elif isinstance(value, Sequence) and not isinstance(value, str):
            rows.append((f"{prefix}{key}", ", ".join(number(v) if isinstance(v, float) else str(v) for v in value)))
        else:
            rows.append((f"{prefix}{key}", number(value) if isinstance(value, float) else str(value)))
    return rows


def remaining_section(diagnosis: Diagnosis) -> Section:
    """What remains, in words, and the experiment that would tell more."""
    words = list(diagnosis.words) or ["Nothing was noted."]
    if diagnosis.next_experiment is None:
        words.append("No further experiment is proposed.")
        return Section("What remains, and what to do next", words)
    words.append("Next experiment: this base motion, designed within the servo's limits, would tell more.")
    rows = flatten(diagnosis.next_experiment)
    return Section("What remains, and what to do next", words, [Table("Next base motion", ("key", "value"), rows)])


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
    pairs = [(scene_of(run), recording) for run, recording in paired(diagnosis.runs, recordings)]
    scenes = [scene for scene, _ in pairs]
    known = {scene.name: recording for scene, recording in pairs}
    sections = [
        error_section(diagnosis),
        parameter_section(diagnosis),
        gate_section(diagnosis),
        candidate_section(diagnosis),
        remaining_section(diagnosis),
        runs_section(scenes),
        *(run_section(scene, known.get(scene.name)) for scene in worst_runs(scenes, DRAWN_RUNS)),
    ]
    before, after = diagnosis.before.midline_mm, diagnosis.after.midline_mm
    merits = [
        (
            "verdict",
            ", ".join(effect_name(effect) for effect in diagnosis.effects) or diagnosis.verdict.replace("_", " "),
        ),
        ("confidence", f"{diagnosis.confidence:.0%}"),
        ("error before", NONE if before is None else f"{number(before)} mm"),
        ("error after", NONE if after is None else f"{number(after)} mm"),
    ]
    return render(
        Report(
            verb="diagnose",
            title=VERDICT_TITLES[diagnosis.verdict],
            headline=diagnosis.headline,
            sections=sections,
            origin=Origin(command, diagnosis.seed, versions, inputs),
            figures_of_merit=merits,
        )
    )

"""Sections of the report: the finding, its confidence, the detection limits, and what to do next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from tentacle.diagnosis import NEXT_SECONDS, Diagnosis
from tentacle.proposed_law import ProposedLaw
from tentacle.recording import Recording
from tentacle.rounding import NO_VALUE, number, rounded
from viz.figures.finding import finding_figure
from viz.report import Picture, ReportSection, ReportTable
from viz.scene import ViewedRun, swims
from viz.words import effect_name, in_words, listed, probability_words, verdict_title

ANSWER_FILES = (
    ("session.rrd", "the recording and both models over it, in time"),
    ("model.toml", "the model with what was found; every other command takes it"),
    ("verdict.json", "this answer as data"),
)
# Effects that a wrong number of the declaration looks like, and where that number stands.
DECLARED_AS = {
    "camera_roll": "arm_px in [camera]",
    "camera_scale": "m_per_px in [camera], and length_m in [specimen]",
    "gravity_tilt": "angle_rad in [gravity]",
    "buoyancy": "density_kg_m3 in [specimen] and [fluid]",
    "payload_place": "tip_mass_reach_m and tip_mass_drop_m in [specimen]",
    "time_offset": "the clock of motor.csv",
}
WITHOUT_MOTOR = {"time_offset": "t_s in [release]"}
# The same where the positions were measured without [camera].
WITHOUT_CAMERA = {
    "camera_roll": "the axes of their frame, of which y lies along the straight arm",
    "camera_scale": "their scale, and length_m in [specimen]",
}


def title_of(diagnosis: Diagnosis) -> str:
    """The verdict as a title that names what was found."""
    names = [effect_name(effect) for effect in diagnosis.missing_effects]
    if diagnosis.verdict == "effect" and names:
        return f"Missing: {listed(names)}"
    if diagnosis.verdict == "group" and names:
        doubt = [effect_name(effect) for effect in diagnosis.in_doubt]
        sure = [name for name in names if name not in doubt]
        return f"Missing: {listed(sure)}, beside {listed(doubt, 'or')}" if sure else f"Missing: {listed(doubt, 'or')}"
    return verdict_title(diagnosis)


def finding_section(
    diagnosis: Diagnosis, worst: Sequence[ViewedRun], recordings: Mapping[str, Recording | None]
) -> ReportSection:
    """The worst moment as a picture, the value found, and how sure the answer is; it stands first."""
    pictures = []
    for scene in worst:
        figure = finding_figure(scene, recordings.get(scene.name))
        if figure is not None:
            found = listed([effect_name(effect) for effect in diagnosis.effects])
            added = f" and with {found}" if found and diagnosis.verdict == "effect" else " and with what was found"
            words = f"{scene.name} at the moment of the largest error, as declared{added}. Models run open loop."
            pictures.append(Picture(figure, words))
    return ReportSection("The finding", sure_words(diagnosis.verdict_json()), pictures=pictures, leads=True)


def sure_words(answer: Mapping[str, Any]) -> list[str]:
    """Sentences about the confidence of the answer, from the keys of verdict.json."""
    words = []
    explained = answer.get("explained")
    if explained:
        shares = [100.0 * explained[key] for key in ("share", "low", "high")]
        width = shares[2] - shares[1]
        share, low, high = (f"{one:.0f}" if width >= 1.0 else rounded(one, width) for one in shares)
        words.append(f"What was found explains {share} % of the force that was missing ({low} to {high} %).")
    certain, sets = answer.get("certain") or [], answer.get("sets") or []
    if certain and len(sets) > 1:
        words.append(f"All likely answers contain {listed([effect_name(effect) for effect in certain])}.")
    where = answer.get("where") or {}
    if len(where) > 1:
        told = "; ".join(
            f"{name}: {listed([effect_name(e) for e in effects]) or 'nothing'}" for name, effects in where.items()
        )
        words.append(f"By recording: {told}.")
    return words


def limits_sections(answer: Mapping[str, Any], best: ProposedLaw | None = None) -> list[ReportSection]:
    """The credible set, the laws proposed after an unknown (the best of them), and the detection limits."""
    found = []
    sets = answer.get("sets") or []
    if sets:
        rows = [
            (
                listed([effect_name(e) for e in one["effects"]]) or "nothing missing",
                probability_words(one["probability"]),
            )
            for one in sets
        ]
        together = probability_words(sum(one["probability"] for one in sets))
        words = (
            "The fewest sets with 95 % of the probability of all sets of the catalogue. Each counts with the sets that "
            f"contain it: more may act beside it. Together they have {together} of the whole probability. The rest "
            "belongs to effects outside the catalogue, and to other sets."
        )
        confidence = (
            "The confidence at the top is another number: the probability of the verdict as a whole, corrected by how "
            "often such verdicts were right in blind trials."
        )
        header = ("these effects", "probability of these, alone or beside others")
        table = ReportTable("Sets of effects", header, rows, numeric=(1,))
        found.append(ReportSection("Likely answers", [words, confidence], [table]))
    laws = answer.get("laws") or []
    if laws:
        rows = [
            (
                law["expression"],
                law["acts"],
                law["place"],
                number(law["evidence"]),
                number(law["held_out_midline_mm"]),
                law["file"] or NO_VALUE,
            )
            for law in laws
        ]
        header = ("law", "acts on", "place", "evidence [nat]", "judged error [mm]", "file")
        why = (
            "No effect of the catalogue explains the residual. These laws were fitted to it."
            if answer.get("verdict") == "unknown"
            else "These laws follow the held-out frames at least as well as the named effects."
        )
        tested = "They are proposals to be tested."
        words = f"{why} {tested if best is None or best.fits else 'No law fits the missing force: none is the answer.'}"
        found.append(ReportSection("Laws proposed", [words], [ReportTable("Proposals", header, rows, numeric=(3, 4))]))
    limits = answer.get("detection_limits") or {}
    if limits:
        rows = [
            (effect_name(effect), name, number(one["value"]), one["unit"])
            for effect, values in limits.items()
            for name, one in values.items()
        ]
        words = (
            "The smallest value that would have been named in 95 of 100 such recordings. Smaller values may be present."
        )
        table = ReportTable("Detection limits", ("effect", "parameter", "from", "unit"), rows, numeric=(2,))
        found.append(ReportSection("What would have been detected", [words], [table]))
    return found


def next_section(diagnosis: Diagnosis, command: str, recordings: Sequence[Recording]) -> ReportSection:
    """Remarks, the next steps as commands that can be copied, and links to the files beside the report."""
    commands = [(f"{words} (in the folder of this report):", line) for words, line in local_commands(diagnosis)]
    tables = []
    files = ANSWER_FILES
    if diagnosis.next_experiment is not None:
        line = command.replace("tentacle diagnose ", "tentacle diagnose next.rrd ", 1)
        commands.append(("Then diagnose it together with the others:", line))
        tables.append(ReportTable("Next base motion", ("key", "value"), flatten(diagnosis.next_experiment)))
        files = (*ANSWER_FILES, ("next_experiment.toml", "the proposed next base motion"))
    words = [in_words(word, diagnosis) for word in diagnosis.words] + check_words(diagnosis.effects, recordings)
    return ReportSection("What to do next", words, tables, commands=commands, files=files)


def untold_section(inputs: Sequence[str]) -> ReportSection:
    """What is left to do after an answer that tells nothing: the recording's own view."""
    commands = [("Look at the recording:", f"tentacle view {name}") for name in inputs[:1]]
    return ReportSection("What to do next", (), commands=commands, files=(("verdict.json", "this answer as data"),))


def check_words(effects: Sequence[str], recordings: Sequence[Recording]) -> list[str]:
    """A sentence for each effect that may be a wrong number of the declaration, or of positions measured elsewhere."""
    clamped = bool(recordings) and all(recording.motor is None for recording in recordings)
    declared = DECLARED_AS | (WITHOUT_MOTOR if clamped else {})
    unfilmed = bool(recordings) and all(recording.declaration.camera is None for recording in recordings)
    words = []
    for effect in effects:
        if unfilmed and effect in WITHOUT_CAMERA:
            words.append(f"The {effect_name(effect)} may be an error of the positions: check {WITHOUT_CAMERA[effect]}.")
        elif effect in declared:
            words.append(
                f"The {effect_name(effect)} may be a wrong number of the declaration: check {declared[effect]}."
            )
    return words


def local_commands(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """The commands for this verdict: what each does, and its line."""
    look = ("Look at it in time", "tentacle view session.rrd")
    use = ("Find the gait that swims best with this model", "tentacle optimise model.toml --out gait")
    rig = f"tentacle rig record rig.toml next_experiment.toml --seconds {NEXT_SECONDS:.0f} --out next.rrd"
    run = ("Run the proposed base motion on your rig", rig)
    if diagnosis.next_experiment is not None:
        return [look, run]
    known = diagnosis.verdict in ("effect", "nothing_missing")
    return [look, use] if known and swims(diagnosis.base_model.fluid, [run.theta for run in diagnosis.runs]) else [look]


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

"""What `tentacle diagnose` says and writes: verdict, augmented model, report, session, the next experiment."""

from __future__ import annotations

from pathlib import Path

from tentacle.diagnosis import Diagnosis
from tentacle.recording import Recording


def answer_lines(diagnosis: Diagnosis) -> list[str]:
    """The answer for a terminal: headline, confidence, each parameter that was found with its interval, remarks."""
    if diagnosis.cannot_tell:
        return [diagnosis.headline]
    lines = [diagnosis.headline, f"  Confidence {diagnosis.confidence:.0%}."]
    for effect, values in diagnosis.parameters.items():
        lines += [f"  {effect}.{name} = {e.with_unit} (95 %: {e.interval_words})" for name, e in values.items()]
    return lines + [f"  {sentence}" for sentence in diagnosis.sentences]


def write_answer(
    diagnosis: Diagnosis, recordings: list[Recording], folder: Path, command: str, inputs: list[Path]
) -> None:
    """verdict.json, model.toml, report.html, session.rrd and next_experiment.toml of a diagnosis, into the folder."""
    import json
    from dataclasses import replace

    from affine_model.run_forces import with_forces
    from tentacle.io.effect_file import effect_text
    from tentacle.io.model_file import write_model
    from tentacle.io.provenance import input_hashes, versions
    from tentacle.io.waveform_file import waveform_from_table, write_waveform
    from tentacle.law.in_use import laws_in_use
    from viz.diagnosis_report import diagnosis_report
    from viz.report import write_report
    from viz.session import write_session

    (folder / "verdict.json").write_text(json.dumps(diagnosis.verdict_json(), indent=1) + "\n")
    write_model(diagnosis.augmented_model, folder / "model.toml")
    for law in laws_in_use():
        (folder / "effects").mkdir(exist_ok=True)
        (folder / "effects" / f"{law.name}.toml").write_text(effect_text(law), encoding="utf-8")
    for proposed in diagnosis.missing.laws:
        (folder / "laws").mkdir(exist_ok=True)
        (folder / "laws" / f"{proposed.law.name}.toml").write_text(effect_text(proposed.law), encoding="utf-8")
    if diagnosis.next_experiment is not None:
        write_waveform(waveform_from_table(diagnosis.next_experiment), folder / "next_experiment.toml")
    runs = with_forces(diagnosis.runs, diagnosis.base_model, diagnosis.augmented_model)
    shown = replace(diagnosis, runs=runs)
    page = diagnosis_report(shown, recordings, command, versions(), input_hashes(inputs))
    write_report(page, folder / "report.html")
    write_session(shown, recordings, folder / "session.rrd")

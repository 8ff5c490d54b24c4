"""A campaign: a list of runs in a TOML file, done one after the other, resumed where it stopped.

| field | meaning |
|---|---|
| name | goes before each run's name |
| [[run]] name | the recording's name; NAME.rrd in the campaign's folder, NAME-2.rrd and so on where it is repeated |
| [[run]] duration_s, repeat = 1 | how long, how often |
| [run.waveform] | a table as tentacle.io.waveform_file describes it |
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from rig.board import Board
from rig.camera import CameraThread
from rig.fault import Fault
from rig.journal import set_aside
from rig.motion import RigMotion, described, rig_motion
from rig.record import UNATTENDED, Attendance, RunResult, record_run
from rig.setup_file import RigSetup
from rig.soundness import is_complete_run
from tentacle.errors import InputError
from tentacle.io.folder_lock import owned_folder
from tentacle.io.sound_recording import LONGEST_SPAN
from tentacle.io.toml_table import Table, read_toml
from tentacle.io.waveform_file import parse_waveform


@dataclass(frozen=True)
class CampaignRun:
    """One recording to be made: its name, and the motion, checked against the limits."""

    name: str
    motion: RigMotion


@dataclass(frozen=True)
class Campaign:
    """name, and runs in the order in which they are made."""

    name: str
    runs: tuple[CampaignRun, ...]


def read_campaign(file: Path, setup: RigSetup) -> Campaign:
    """The campaign in a TOML file, every run within the setup's limits. InputError before anything moves."""
    text, values = read_toml(file)
    document = Table(values, file=file, text=text)
    name = document.string("name", file.stem)
    tables = document.raw("run", "one or more [[run]] tables")
    if not isinstance(tables, list) or not tables:
        raise document.error("is no list of tables", "run", "one or more [[run]] tables")
    document.finish()
    runs: list[CampaignRun] = []
    for number, entry in enumerate(tables, start=1):
        runs += _parse_run(Table(entry, file=file, name=f"run {number}"), setup)
    names = [run.name for run in runs]
    for run in names:
        if names.count(run) > 1:
            raise InputError(
                f"{run!r} is the name of two runs", file=file, field="run.name", expected="names that differ"
            )
    return Campaign(name, tuple(runs))


def _parse_run(table: Table, setup: RigSetup) -> list[CampaignRun]:
    name = table.string("name")
    if not name or any(c in name for c in "/\\\0") or name.startswith("."):
        raise table.error(f"{name!r} is no file name", "name", "a plain name")
    duration = table.number("duration_s", above=0, most=LONGEST_SPAN)
    repeat = table.whole_number("repeat", 1, least=1)
    waveform = parse_waveform(table.required_table("waveform"))
    table.finish()
    try:
        motion = rig_motion(waveform, duration, setup.limits, described(waveform))
    except InputError as error:
        raise table.error(error.problem, "waveform", error.expected) from None
    return [CampaignRun(name if k == 1 else f"{name}-{k}", motion) for k in range(1, repeat + 1)]


def run_campaign(
    setup: RigSetup,
    board: Board,
    camera: CameraThread | None,
    campaign: Campaign,
    folder: Path,
    attendance: Attendance = UNATTENDED,
) -> Iterator[RunResult]:
    """Makes the runs that are not complete in `folder` yet, yielding each; a run that ended otherwise is set aside
    first.

    Fault where a run does not complete: the next start goes on from there. InputError where another process makes runs
    in the folder.
    """
    with owned_folder(folder, "one campaign a folder"):
        yield from _missing_runs(setup, board, camera, campaign, folder, attendance)


def _missing_runs(
    setup: RigSetup, board: Board, camera: CameraThread | None, campaign: Campaign, folder: Path, attendance: Attendance
) -> Iterator[RunResult]:
    for run in campaign.runs:
        path = folder / f"{run.name}.rrd"
        before = path.exists()
        aside = _set_aside(path) if before else None
        if before and aside is None:
            continue
        if attendance.interrupts is not None and attendance.interrupts.pause:
            return
        name = f"{campaign.name} {run.name}"
        result = record_run(
            setup,
            board,
            camera,
            run.motion,
            path,
            replace(attendance, name=name),
        )
        if aside is not None:
            kept = f"an unfinished or damaged recording of this run is kept as {aside.name}"
            result = replace(result, words="; ".join(filter(None, (result.words, kept))))
        yield result
        if result.outcome == "interrupted":
            return
        if result.outcome != "complete":
            raise Fault("no_answer", f"{path}: {result.outcome}: {result.words}")


def _set_aside(path: Path) -> Path | None:
    """Where an unfinished recording was moved to; None where it is complete."""
    return None if is_complete_run(path) else set_aside(path)

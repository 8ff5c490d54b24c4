"""The journal of a study on the rig. If it is damaged, it is made again from the recordings."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path

import optuna
from optuna.distributions import FloatDistribution

from rig.run import Run
from rig.run_file import read_run
from tentacle.errors import InputError

JOURNAL = "study.journal"
RECORDING = "recording"  # attribute of a trial with its file name, if that is not from the trial's number


def recording_path(folder: Path, number: int, attributes: Mapping[str, object]) -> Path:
    """Where a trial's recording lies."""
    return folder / str(attributes.get(RECORDING, f"trial-{number:04d}.rrd"))


def set_aside(path: Path) -> Path:
    """Moves a file to a free name, never over another file; returns the new path."""
    number = 1
    while (aside := path.with_name(f"{path.stem}.unfinished-{number}{path.suffix}")).exists():
        number += 1
    return path.rename(aside)


def whole_journal(folder: Path, told: Callable[[str], None]) -> Path:
    """The study's journal, without a torn last line; one that is damaged elsewhere is set aside."""
    journal = folder / JOURNAL
    cut_torn_line(journal)
    if journal.exists():
        lines = journal.read_bytes().split(b"\n")[:-1]
        bad = next((number for number, line in enumerate(lines, start=1) if not _is_entry(line)), None)
        if bad is not None:
            aside = set_aside(journal)
            told(f"{journal}:{bad}: damaged; it is now {aside.name}")
        elif not lines:
            journal.unlink()
    return journal


def recover(
    study: optuna.Study,
    folder: Path,
    bounds: Mapping[str, tuple[float, float]],
    value_of: Callable[[Run, float], float],
) -> int:
    """Adds the folder's complete recordings to a study that has none; returns their number. value_of: (run,
    frequency).
    """
    count = 0
    distributions = {name: FloatDistribution(*pair) for name, pair in bounds.items()}
    for path in sorted(folder.glob("trial-*.rrd")):
        try:
            run = read_run(path)
            described = run.start["waveform"]
            point = {name: float(described[name]) for name in bounds}
            value = value_of(run, point["frequency_hz"])
        except (InputError, KeyError, TypeError, ValueError):
            continue  # not complete, or of another study
        if any(not low <= point[name] <= high for name, (low, high) in bounds.items()):
            continue
        attributes = {"source": str(described.get("source", "search")), RECORDING: path.name}
        study.add_trial(
            optuna.trial.create_trial(
                params=point, distributions=dict(distributions), value=value, user_attrs=attributes
            )
        )
        count += 1
    return count


def cut_torn_line(journal: Path) -> int:
    """Removes the text after the last newline, because an incomplete line from a crash would make every later start
    fail. Returns the number of bytes removed.
    """
    if not journal.exists():
        return 0
    data = journal.read_bytes()
    whole = data.rfind(b"\n") + 1
    while whole and not _is_entry(
        data[data.rfind(b"\n", 0, whole - 1) + 1 : whole]
    ):  # blocks of zeros after a power cut
        whole = data.rfind(b"\n", 0, whole - 1) + 1
    if whole < len(data):
        with journal.open("rb+") as file:
            file.truncate(whole)
    return len(data) - whole


def _is_entry(line: bytes) -> bool:
    try:
        return isinstance(json.loads(line), dict)
    except ValueError:
        return False

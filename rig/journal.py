"""The journal of a study on the rig. If it is damaged, it is made again from the recordings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import optuna
from optuna.distributions import FloatDistribution
from optuna.trial import TrialState

from rig.journal_file import cut_torn_end
from rig.run import Run
from rig.run_file import read_run
from tentacle.errors import InputError

JOURNAL = "study.journal"
RECORDING = "recording"  # attribute of a trial with its file name, if that is not from the trial's number


def recording_path(folder: Path, number: int, attributes: Mapping[str, object]) -> Path:
    """Where a trial's recording lies."""
    return folder / str(attributes.get(RECORDING, f"trial-{number:04d}.rrd"))


def free_recording_path(folder: Path, number: int) -> Path:
    """Where a new trial's recording goes: under its number, or the next that no file has."""
    while (path := recording_path(folder, number, {})).exists():
        number += 1
    return path


def set_aside(path: Path) -> Path:
    """Moves a file to a free name, never over another file; returns the new path."""
    number = 1
    while (aside := path.with_name(f"{path.stem}.unfinished-{number}{path.suffix}")).exists():
        number += 1
    return path.rename(aside)


def whole_journal(folder: Path, told: Callable[[str], None]) -> Path:
    """The study's journal, without a torn end; one that is damaged elsewhere is set aside."""
    journal = folder / JOURNAL
    bad = cut_torn_end(journal)
    if bad is not None:
        aside = set_aside(journal)
        told(f"{journal}:{bad}: damaged; it is now {aside.name}")
    elif journal.exists() and not journal.stat().st_size:
        journal.unlink()
    return journal


def recover(
    study: optuna.Study,
    folder: Path,
    bounds: Mapping[str, tuple[float, float]],
    value_of: Callable[[Run, float], float],
) -> int:
    """Adds the folder's complete recordings that the study does not know; returns their number. value_of: (run,
    frequency).
    """
    count = 0
    finished = study.get_trials(deepcopy=False, states=(TrialState.COMPLETE,))
    known = {recording_path(folder, t.number, t.user_attrs) for t in finished}
    distributions = {name: FloatDistribution(*pair) for name, pair in bounds.items()}
    for path in sorted(set(folder.glob("trial-*.rrd")) - known):
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

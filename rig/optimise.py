"""Optimising gaits on the rig: a Gaussian process over noisy trials, started from a model's best, resumable at any
moment.

A study is a folder: study.journal (every step, fsynced), trial-0000.rrd and so on (each trial's recording, and the
source of its value). After a kill at any point, the next start removes an incomplete last line, marks the running trial
as failed and tries it again. A damaged journal is set aside and made again from the recordings; no recording is ever
overwritten.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import optuna
from optuna.storages import JournalStorage
from optuna.trial import FrozenTrial, TrialState

from rig.fault import Fault
from rig.gait_space import GaitSpace, TrialPlan
from rig.interrupts import Interrupts
from rig.journal import RECORDING, free_recording_path, recording_path, recover, whole_journal
from rig.journal_file import JournalFile
from rig.run import Run
from rig.run_file import read_run
from tentacle.errors import InputError
from tentacle.io.folder_lock import owned_folder
from tentacle.waveform import Waveform

NAME = "gaits"
STARTUP = 8  # trials before the Gaussian process proposes
STEP_FROM_BEST = 0.04  # of the space's width, standard deviation of a step from the best
FAULTS_IN_A_ROW = 3  # after that a person must check the rig


# Tries a gait for so many seconds and records it at the path, with the description in the start record. It raises
# nothing for a fault of the rig: the recording says how the run ended.
TrialRunner = Callable[[Waveform, float, Path, dict[str, Any]], None]
Proposer = Callable[[Sequence[Path]], Sequence[Mapping[str, float]]]


@dataclass(frozen=True)
class RigTrial:
    """A finished trial: its number, point, propulsion [N] (mean, minus thrust along +y) and where it came from."""

    number: int
    point: dict[str, float]
    propulsion: float
    source: str
    recording: Path


@dataclass(frozen=True)
class StudyPlan:
    """The plan of a study. trials: number of finished trials in all; reidentify_every: 0 for never; seed: of the
    sampler.
    """

    space: GaitSpace
    trials: int
    plan: TrialPlan = field(default_factory=TrialPlan)
    reidentify_every: int = 0
    seed: int = 0

    def __post_init__(self) -> None:
        if self.trials < 1:
            raise InputError(f"{self.trials!r} is not usable", field="trials", expected="at least 1")


@dataclass(frozen=True)
class Suggestions:
    """first: points to try first (a model's best). propose: given the recordings so far, points of a model identified
    anew, every study.reidentify_every trials (None: never).
    """

    first: Sequence[Mapping[str, float]] = ()
    propose: Proposer | None = None


NO_SUGGESTIONS = Suggestions()


def optimise_on_rig(
    folder: Path,
    study: StudyPlan,
    run_trial: TrialRunner,
    suggestions: Suggestions = NO_SUGGESTIONS,
    *,
    interrupts: Interrupts | None = None,
    told: Callable[[str], None] = lambda _words: None,
) -> Iterator[RigTrial]:
    """Runs trials until `study.trials` are finished, yielding each; those of an earlier start are yielded first.

    told is called if the journal had to be made again. Fault after
    FAULTS_IN_A_ROW trials that did not complete; InputError
    where the folder is in use or holds another study.
    """
    with owned_folder(folder, "one optimisation a folder"):
        opened = _open(folder, study, told)
        finished = _finished(opened, folder)
        yield from finished
        if not opened.trials:
            for point in suggestions.first:
                opened.enqueue_trial(dict(point), user_attrs={"source": "model"})
        done, faults = len(finished), 0
        while done < study.trials:
            if interrupts is not None and interrupts.pause:
                return
            propose = suggestions.propose
            if propose is not None and study.reidentify_every and done and done % study.reidentify_every == 0:
                _enqueue_proposals(opened, propose, [t.recording for t in _finished(opened, folder)], done)
            if done > max(len(suggestions.first), STARTUP) and done % 2:
                _enqueue_near_best(opened, study, done)
            trial = _one_trial(opened, folder, study, run_trial)
            if trial is None:
                faults += 1
                if interrupts is not None and interrupts.pause:
                    return
                if faults == FAULTS_IN_A_ROW:
                    raise Fault("no_answer", f"{faults} trials in a row did not complete; the last says why: {folder}")
                continue
            done, faults = done + 1, 0
            yield trial


def best(trials: Sequence[RigTrial]) -> RigTrial:
    """The trial of the highest measured propulsion; InputError where there is none."""
    if not trials:
        raise InputError("no trial has finished", expected="at least one")
    return max(trials, key=lambda trial: trial.propulsion)


def propulsion(run: Run, begin: float, end: float) -> float:
    """Minus the mean thrust along +y [N] over [begin, end) [s] of the waveform's time, less the reading at rest.

    Means over time (trapezoids between samples): conversions are not spaced evenly. InputError where the run is not
    whole.
    """
    if run.outcome != "complete" or run.stop is None:
        raise InputError(f"ended as {run.outcome!r}", file=run.path, expected="a complete run")
    cell = run.start["load_cell"]
    thrust = (run.load - cell["offset_counts"]) / cell["counts_per_newton"] - float(run.stop["rest_n"])
    t = run.load_t - run.zero
    if t.size < 2 or t[0] > begin or t[-1] < end - 0.1:
        raise InputError(f"was not sampled from {begin:.2f} to {end:.2f} s", file=run.path)
    grid = np.linspace(begin, min(end, float(t[-1])), 4096)
    return -float(np.trapezoid(np.interp(grid, t, thrust), grid) / (grid[-1] - grid[0]))


def _open(folder: Path, study: StudyPlan, told: Callable[[str], None]) -> optuna.Study:
    journal = whole_journal(folder, told)
    lost = not journal.exists()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    storage = JournalStorage(JournalFile(journal))
    sampler = optuna.samplers.GPSampler(
        seed=study.seed + (journal.stat().st_size if journal.exists() else 0),  # a resumed study must not repeat itself
        n_startup_trials=STARTUP,
        deterministic_objective=False,
    )
    opened = optuna.create_study(
        storage=storage, sampler=sampler, study_name=NAME, direction="maximize", load_if_exists=True
    )
    bounds = {name: list(pair) for name, pair in study.space.bounds.items()}
    known = opened.user_attrs.get("bounds")
    if known is None:
        opened.set_user_attr("bounds", bounds)
    elif known != json.loads(json.dumps(bounds)):
        raise InputError("holds a study of other bounds", file=folder, expected="a folder of its own for each study")
    for trial in opened.get_trials(states=(TrialState.RUNNING,)):
        _settle_unfinished(opened, folder, study, trial)
    count = recover(
        opened, folder, study.space.bounds, lambda run, frequency: propulsion(run, *study.plan.window(frequency))
    )
    if count:
        what = "was lost" if lost else "lacks its end"
        told(f"{journal}: {what}; {count} trials are recovered from their recordings")
    return opened


def _settle_unfinished(opened: optuna.Study, folder: Path, study: StudyPlan, trial: FrozenTrial) -> None:
    """A trial that was running when the process died: its recording counts if it is whole, else it is tried again."""
    path, point = recording_path(folder, trial.number, trial.user_attrs), trial.params
    complete = set(point) == set(study.space.bounds)
    if path.exists() and complete:
        try:
            begin, end = study.plan.window(point["frequency_hz"])
            opened.tell(trial.number, propulsion(read_run(path), begin, end))
            return
        except InputError:
            pass
    opened.tell(trial.number, state=TrialState.FAIL)
    if complete:
        opened.enqueue_trial(point, user_attrs={"source": "again"})


def _one_trial(opened: optuna.Study, folder: Path, study: StudyPlan, run_trial: TrialRunner) -> RigTrial | None:
    asked = opened.ask()
    point = {name: asked.suggest_float(name, low, high) for name, (low, high) in study.space.bounds.items()}
    source = str(asked.user_attrs.get("source", "search"))
    path = free_recording_path(folder, asked.number)
    if path != recording_path(folder, asked.number, {}):
        asked.set_user_attr(RECORDING, path.name)
    description = {"kind": "gait", "trial": asked.number, "source": source, **point}
    run_trial(study.space.gait(point), study.plan.duration(point["frequency_hz"]), path, description)
    try:
        value = propulsion(read_run(path), *study.plan.window(point["frequency_hz"]))
    except InputError:
        opened.tell(asked, state=TrialState.FAIL)
        opened.enqueue_trial(point, user_attrs={"source": "again"})
        return None
    opened.tell(asked, value)
    return RigTrial(asked.number, point, value, source, path)


def _enqueue_proposals(opened: optuna.Study, propose: Proposer, recordings: Sequence[Path], done: int) -> None:
    if opened.user_attrs.get("reidentified_at") == done:
        return  # a trial has failed since, or the process was started again
    for point in propose(recordings):
        opened.enqueue_trial(dict(point), user_attrs={"source": f"model after {done}"})
    opened.set_user_attr("reidentified_at", done)


def _enqueue_near_best(opened: optuna.Study, study: StudyPlan, done: int) -> None:
    """A step from the best trial so far. In 30 trials with four coordinates the Gaussian process explores mostly
    unknown corners, and never improved on a model's best gait.
    """
    if opened.get_trials(deepcopy=False, states=(TrialState.WAITING,)):
        return  # proposals of a model, and trials to be repeated, come first
    source = np.random.default_rng((study.seed, done))
    point = {
        name: float(np.clip(opened.best_params[name] + STEP_FROM_BEST * (high - low) * source.normal(), low, high))
        for name, (low, high) in study.space.bounds.items()
    }
    opened.enqueue_trial(point, user_attrs={"source": "near the best"})


def _finished(opened: optuna.Study, folder: Path) -> list[RigTrial]:
    found = opened.get_trials(deepcopy=False, states=(TrialState.COMPLETE,))
    return [
        RigTrial(
            t.number,
            dict(t.params),
            float(t.values[0]),
            str(t.user_attrs.get("source", "search")),
            recording_path(folder, t.number, t.user_attrs),
        )
        for t in found
    ]

"""A campaign that goes on until its explanations are split: diagnose jointly, design, run, diagnose again.

The folder is the state. Every run is a recording NAME.rrd, and a run that is complete and sound is never made again and
never overwritten; one that is not is set aside. The run that follows a decision holds it in its start record, so the
journal (rig.split_journal) can be made again. Why an attempt at a run failed is told and stands in the journal. The
reference motion runs several times at first, then once before every `reference_every`-th experiment and before the
conclusion (rig.sentinel).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from discovery.next_experiment import DURATION
from rig.campaign import Campaign
from rig.fault import NEEDS_A_PERSON, Fault
from rig.interrupts import Interrupts
from rig.journal import set_aside
from rig.motion import RigMotion, rig_motion
from rig.run_file import read_run
from rig.safety import SafetyLimits
from rig.sentinel import FEWEST_REPEATS
from rig.soundness import is_complete_run
from rig.split_decision import Decision, decision_from
from rig.split_journal import append, decision_on, failure, hashes, open_journal
from tentacle.errors import InputError
from tentacle.io.folder_lock import owned_folder
from tentacle.io.waveform_file import waveform_from_table, waveform_table
from tentacle.waveform import Sine

PATIENCE = (5.0, 30.0)  # s before the second and the third attempt at a run; then a person must check the rig
# At 0.97 Hz a camera of 25, 30 or 60 frames/s sees every period at other phases, so that a bias of the tracking that
# depends on the place in the picture is the same in every run.
REFERENCE, REFERENCE_PERIODS = Sine(0.3, 0.97), 12
DECISION = "decision"  # key of a run's description
LISTEN_EVERY = 0.1  # s at which an interrupt is heard while the next attempt is waited for


@dataclass(frozen=True)
class SplitPlan:
    """first: runs to begin with; most: experiments in all; reference: the repeated motion, run `repeats` times at first
    and then before every `reference_every`-th experiment; patience: seconds before each further attempt at a run.
    """

    first: Campaign
    limits: SafetyLimits
    most: int = 8
    reference: Sine = REFERENCE
    reference_every: int = 2
    repeats: int = 6
    patience: tuple[float, ...] = PATIENCE

    def __post_init__(self) -> None:
        for name, value, least in (
            ("most", self.most, len(self.first.runs)),
            ("reference_every", self.reference_every, 1),
            ("repeats", self.repeats, FEWEST_REPEATS),
        ):
            if value < least:
                raise InputError(f"{value!r} is not usable", field=name, expected=f"at least {least}")
        for run in self.first.runs:
            if run.name.startswith(("reference-", "experiment-")):
                raise InputError(f"{run.name!r} is a name that this campaign gives", field="run.name")

    @property
    def comparisons(self) -> int:
        """How often a later reference run is compared with the first ones, at most."""
        return self.most // self.reference_every + 1


@dataclass(frozen=True)
class Bench:
    """make plays a motion and records it at a path, and returns the fault that kept the run from its end; judge
    diagnoses runs jointly (KeyboardInterrupt: it is to be left); changed compares the last reference run with the first
    ones, and gives a line for each change; is_sound tells whether a recording is whole enough to be judged.
    """

    make: Callable[[RigMotion, Path], Fault | None]
    judge: Callable[[Sequence[Path]], Decision]
    changed: Callable[[Sequence[Path]], list[str]]
    is_sound: Callable[[Path], bool] = is_complete_run


@dataclass(frozen=True)
class Conclusion:
    """How it ended: "split", "limits" (no motion within the limits splits further), "most" (the number of experiments
    was reached), "drifted" (the reference motion changed: the decision rests on an arm that did not stay the same) or
    "paused". drift: the lines that say so.
    """

    ending: Literal["split", "limits", "most", "drifted", "paused"]
    decision: Decision | None
    experiments: tuple[Path, ...]
    drift: tuple[str, ...] = ()


class _PausedError(Exception):
    """An interrupt was heard between two runs."""


def run_until_split(
    folder: Path,
    plan: SplitPlan,
    bench: Bench,
    *,
    interrupts: Interrupts | None = None,
    told: Callable[[str], None] = lambda _words: None,
) -> Conclusion:
    """Goes on from what is in the folder. told hears every run and every decision.

    Fault where all attempts at one run failed, or where no further attempt can help; InputError where another process
    uses the folder.
    """
    with owned_folder(folder, "one campaign a folder"):
        return _Campaign(folder, plan, bench, interrupts, told).conclude()


class _Campaign:
    def __init__(
        self,
        folder: Path,
        plan: SplitPlan,
        bench: Bench,
        interrupts: Interrupts | None,
        told: Callable[[str], None],
    ) -> None:
        self.folder, self.plan, self.bench = folder, plan, bench
        self.interrupts, self.told = interrupts, told
        self.experiments: list[Path] = []
        self.references: list[Path] = []
        self.lines = open_journal(folder, told)
        self.decision: Decision | None = None

    def conclude(self) -> Conclusion:
        """Runs and decisions until there is an ending."""
        try:
            for name, motion in self._experiments():
                if found := self._drift():
                    return self._ended("drifted", found)
                self.experiments.append(self._made(name, motion))
            assert self.decision is not None
            ending = self.decision.ending or "most"
            found = self._drift(last=True)
            return self._ended("drifted" if found else ending, found)
        except _PausedError:
            return self._ended("paused", [])

    def _ended(self, ending: Any, found: list[str]) -> Conclusion:
        return Conclusion(ending, self.decision, tuple(self.experiments), tuple(found))

    def _experiments(self) -> Iterator[tuple[str, RigMotion | None]]:
        """Names and motions, the first runs before those that decisions ask for; None: it is made already."""
        for run in self.plan.first.runs:
            yield run.name, run.motion
        while True:
            name = f"experiment-{len(self.experiments) + 1:04d}"
            path = self.folder / f"{name}.rrd"
            if self.bench.is_sound(path):
                self._recover(path)
                yield name, None
                continue
            self.decision = self._decided()
            if self.decision.ending is not None or len(self.experiments) >= self.plan.most:
                return
            assert self.decision.motion is not None
            judged = {"runs": hashes(self.experiments), DECISION: self.decision.table()}
            table = self.decision.motion
            yield name, rig_motion(waveform_from_table(table), DURATION, self.plan.limits, {**table, **judged})

    def _decided(self) -> Decision:
        judged = hashes(self.experiments)
        decision = decision_on(self.lines, judged)
        if decision is None:
            if self._paused:
                raise _PausedError
            try:
                decision = self.bench.judge(self.experiments)
            except KeyboardInterrupt:  # a diagnosis is left at once; it is made again from the same runs
                raise _PausedError from None
            append(self.folder, self.lines, {"runs": judged, DECISION: decision.table()})
        self.told(f"{len(self.experiments)} recordings: {decision.words}")
        return decision

    def _recover(self, path: Path) -> None:
        """Writes the decision that asked for a run into the journal again, where it is not there."""
        described = read_run(path).start["waveform"]
        try:
            judged, decision = dict(described["runs"]), decision_from(described[DECISION])
        except (KeyError, TypeError, ValueError):
            return  # a run that was put here by hand: it counts as any other
        if decision_on(self.lines, judged) is None:
            append(self.folder, self.lines, {"runs": judged, DECISION: decision.table()})

    def _drift(self, last: bool = False) -> list[str]:
        """The reference motion, where it is due, and what has changed in it."""
        count = len(self.experiments)
        if count % self.plan.reference_every and not last:
            return []
        seconds = REFERENCE_PERIODS / self.plan.reference.frequency
        motion = rig_motion(self.plan.reference, seconds, self.plan.limits, waveform_table(self.plan.reference))
        names = [f"reference-{count:04d}"]
        if not count:
            names += [f"{names[0]}-{k}" for k in range(2, self.plan.repeats + 1)]
        for name in names:
            path = self._made(name, motion)
            if path not in self.references:
                self.references.append(path)
        return self.bench.changed(self.references)

    def _made(self, name: str, motion: RigMotion | None) -> Path:
        """The run's recording, complete and sound; made if it is not there."""
        path = self.folder / f"{name}.rrd"
        if self.bench.is_sound(path):
            return path
        assert motion is not None
        attempt, attempts = 1, 1 + len(self.plan.patience)
        while (fault := self._attempt(path, motion)) is not None:
            append(self.folder, self.lines, failure(name, fault))
            if fault.kind in NEEDS_A_PERSON:
                raise Fault(fault.kind, f"{path.name}: {fault}")
            if attempt == attempts:
                raise Fault(fault.kind, f"{path.name}: {attempts} attempts failed; the last: {fault}")
            seconds = self.plan.patience[attempt - 1]
            attempt += 1
            self.told(f"{path.name}: {fault.kind}: {fault}; attempt {attempt} of {attempts} in {seconds:g} s")
            self._wait(seconds)
        self.told(f"{path.name}: complete")
        return path

    def _attempt(self, path: Path, motion: RigMotion) -> Fault | None:
        """What kept one attempt at a run from its end."""
        if path.exists():
            self.told(f"{path.name} is not complete: kept as {set_aside(path).name}")
        if self._paused:
            raise _PausedError
        fault = self.bench.make(motion, path)
        if self.bench.is_sound(path):
            return None
        if self._paused:
            raise _PausedError
        return fault or Fault("no_answer", "the recording is not whole")

    def _wait(self, seconds: float) -> None:
        until = time.monotonic() + seconds
        while time.monotonic() < until and not self._paused:
            time.sleep(min(LISTEN_EVERY, max(until - time.monotonic(), 0.0)))

    @property
    def _paused(self) -> bool:
        return self.interrupts is not None and self.interrupts.pause

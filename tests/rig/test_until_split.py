"""Campaigns until the explanations are split: resumed after every fault, no sound run made twice, drift told."""

from __future__ import annotations

import json
import random
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from benchmarks._split_faults import FAULTS, FaultyBench, KilledError, decided
from rig import until_split
from rig.campaign import Campaign, CampaignRun
from rig.connection import connected
from rig.emulator import Emulator
from rig.fault import Fault
from rig.motion import RigMotion, described, rig_motion
from rig.record import motion_runner
from rig.safety import SafetyLimits
from rig.soundness import is_complete_run
from rig.split_decision import Decision
from rig.split_journal import NAME
from rig.until_split import Bench, Conclusion, SplitPlan, run_until_split
from tentacle.errors import InputError
from tentacle.waveform import Chirp, Sine
from tests.rig.test_campaign import setup_at

WAVE = Sine(0.3, 1.0)
ALL_RUNS = 4 + 5  # experiments; references: 3 at first, one before the third experiment, one before the conclusion


@pytest.fixture
def plan(limits: SafetyLimits) -> SplitPlan:
    chirp = Chirp(0.3, 0.3, 2.0, 2.0)
    first = CampaignRun("chirp", rig_motion(chirp, 2.0, limits, described(chirp)))
    return SplitPlan(Campaign("twins", (first,)), limits, repeats=3, patience=(0.0, 0.0))


def go(folder: Path, plan: SplitPlan, bench: FaultyBench) -> Conclusion:
    return run_until_split(folder, plan, Bench(bench.make, decided, lambda _runs: []))


def until_done(folder: Path, plan: SplitPlan, bench: FaultyBench) -> Conclusion:
    """The same command again after every end that is no conclusion; what was sound before stays as it is."""
    for _ in range(60):
        sound = {path: path.read_bytes() for path in folder.glob("*.rrd") if is_complete_run(path)}
        try:
            found = go(folder, plan, bench)
        except (KilledError, Fault):
            found = None
        assert all(path.read_bytes() == content for path, content in sound.items())
        if found is not None:
            return found
    pytest.fail("no conclusion")


def test_it_runs_until_one_explanation_holds(plan: SplitPlan, tmp_path: Path) -> None:
    bench = FaultyBench([])
    found = go(tmp_path, plan, bench)
    assert found.ending == "split"
    assert [path.stem for path in found.experiments] == ["chirp", *(f"experiment-{k:04d}" for k in (2, 3, 4))]
    assert bench.made == ALL_RUNS
    assert go(tmp_path, plan, bench) == found
    assert bench.made == ALL_RUNS


@pytest.mark.parametrize("seed", range(2))
def test_faults_neither_repeat_nor_lose_a_sound_run(seed: int, plan: SplitPlan, tmp_path: Path) -> None:
    """Every fault once, in a random order, with sound runs between; benchmarks/until_split.py injects fifty."""
    source = random.Random(seed)
    faults = [
        fault for name in source.sample(FAULTS, len(FAULTS)) for fault in (name, "") if fault or source.random() < 0.5
    ]
    bench = FaultyBench(faults)
    found = until_done(tmp_path, plan, bench)
    assert found.ending == "split"
    assert bench.made == ALL_RUNS + len(FAULTS)  # a run more for each fault, none for anything else
    lines = journal_of(tmp_path)
    assert [len(line["runs"]) for line in lines if "runs" in line] == [1, 2, 3, 4]
    kinds = sorted(line["kind"] for line in lines if "failed" in line)
    assert kinds == ["disk", "link_lost", "no_answer", "overcurrent", "watchdog"]  # all but the kill, which wrote none


@pytest.mark.parametrize("damage", ["gone", "zeroed"])
def test_a_lost_journal_is_made_again_from_the_runs(damage: str, plan: SplitPlan, tmp_path: Path) -> None:
    found = go(tmp_path, plan, FaultyBench([]))
    journal = tmp_path / NAME
    before = journal.read_text()
    journal.unlink() if damage == "gone" else journal.write_bytes(bytes(len(before)))
    judged: list[int] = []

    def judge(runs):  # only the last decision is in no run
        judged.append(len(runs))
        return decided(runs)

    assert run_until_split(tmp_path, plan, Bench(FaultyBench([]).make, judge, lambda _runs: [])) == found
    assert judged == [4]
    assert journal.read_text() == before


def journal_of(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / NAME).read_text().splitlines()]


class PausedAfter:
    """Ctrl-C during run number `runs`."""

    def __init__(self, bench: FaultyBench, runs: int) -> None:
        self.bench, self.runs = bench, runs

    @property
    def pause(self) -> bool:
        return self.bench.made >= self.runs


@pytest.mark.parametrize("runs", [1, 2, 5])
def test_a_paused_campaign_goes_on_with_the_same_command(runs: int, plan: SplitPlan, tmp_path: Path) -> None:
    bench = FaultyBench([])
    wired = Bench(bench.make, decided, lambda _runs: [])
    found = run_until_split(tmp_path, plan, wired, interrupts=PausedAfter(bench, runs))  # type: ignore[arg-type]
    assert (found.ending, bench.made) == ("paused", runs)
    assert go(tmp_path, plan, bench).ending == "split"
    assert bench.made == ALL_RUNS


def test_a_diagnosis_that_is_left_pauses_the_campaign(plan: SplitPlan, tmp_path: Path) -> None:
    def left(_runs: Sequence[Path]) -> Decision:
        raise KeyboardInterrupt

    bench = FaultyBench([])
    assert run_until_split(tmp_path, plan, Bench(bench.make, left, lambda _runs: [])).ending == "paused"
    assert go(tmp_path, plan, bench).ending == "split"
    assert bench.made == ALL_RUNS


def test_a_rig_that_keeps_failing_is_a_fault(plan: SplitPlan, tmp_path: Path) -> None:
    bench, heard = FaultyBench(["unplug"] * 9), []
    with pytest.raises(Fault, match="3 attempts failed; the last: the board is gone before the run begins"):
        run_until_split(tmp_path, plan, Bench(bench.make, decided, lambda _runs: []), told=heard.append)
    assert bench.made == 3
    said = "reference-0000.rrd: link_lost: the board is gone before the run begins; attempt"
    assert heard == [f"{said} 2 of 3 in 0 s", f"{said} 3 of 3 in 0 s"]
    failed = journal_of(tmp_path)
    assert [(line["failed"], line["kind"]) for line in failed] == [("reference-0000", "link_lost")] * 3


@pytest.mark.parametrize("fault", ["overcurrent", "disk full"])
def test_a_fault_that_no_attempt_mends_ends_it_at_once(fault: str, plan: SplitPlan, tmp_path: Path) -> None:
    bench = FaultyBench([fault])
    with pytest.raises(Fault, match=f"reference-0000.rrd: {fault}"):
        go(tmp_path, plan, bench)
    assert bench.made == 1
    assert go(tmp_path, plan, bench).ending == "split"


def test_an_interrupt_is_heard_while_the_next_attempt_is_waited_for(plan: SplitPlan, tmp_path: Path) -> None:
    bench = FaultyBench(["unplug"] * 9)
    patient, begun = replace(plan, patience=(60.0, 60.0)), time.monotonic()

    class Paused:
        @property
        def pause(self) -> bool:
            return time.monotonic() - begun > 1.0

    wired = Bench(bench.make, decided, lambda _runs: [])
    assert run_until_split(tmp_path, patient, wired, interrupts=Paused()).ending == "paused"  # type: ignore[arg-type]
    assert bench.made == 1
    assert time.monotonic() - begun < 30.0  # half of the shorter wait: a busy computer is slow, but no minute late


def test_limits_that_split_no_further_are_an_ending(plan: SplitPlan, tmp_path: Path) -> None:
    bench = Bench(FaultyBench([]).make, lambda runs: replace(decided(runs), nats=2.5), lambda _runs: [])
    found = run_until_split(tmp_path, plan, bench)
    assert (found.ending, len(found.experiments)) == ("limits", 1)
    assert found.decision is not None
    assert "the best would give 2.5 nats" in found.decision.words


def test_an_unknown_is_no_explanation() -> None:
    unknown = replace(decided([]), verdict="unknown", mass=0.99)
    assert unknown.ending is None
    assert replace(unknown, motion=None).ending == "limits"


def test_a_drift_stops_the_campaign(plan: SplitPlan, tmp_path: Path) -> None:
    bench = Bench(FaultyBench([]).make, decided, lambda runs: ["softer"] * (len(runs) > 3))
    found = run_until_split(tmp_path, plan, bench)
    assert (found.ending, found.drift, len(found.experiments)) == ("drifted", ("softer",), 2)


def test_a_name_that_the_campaign_gives_is_refused(plan: SplitPlan) -> None:
    run = replace(plan.first.runs[0], name="reference-0000")
    with pytest.raises(InputError, match="is a name that this campaign gives"):
        replace(plan, first=Campaign("twins", (run,)))


@pytest.fixture
def short(limits: SafetyLimits, monkeypatch: pytest.MonkeyPatch) -> SplitPlan:
    """Runs of a second on the emulated rig."""
    monkeypatch.setattr(until_split, "DURATION", 1.0)
    monkeypatch.setattr(until_split, "REFERENCE_PERIODS", 1)
    run = CampaignRun("sine", rig_motion(WAVE, 1.0, limits, described(WAVE)))
    return SplitPlan(Campaign("twins", (run,)), limits, repeats=3, patience=(0.0, 0.0))


def two_are_enough(runs: Sequence[Path]) -> Decision:
    return replace(decided(runs), mass=0.97 if len(runs) == 2 else 0.6)


class Disturbed:
    """The emulated rig's runner, with one deed a second after the first run of a name begins."""

    def __init__(self, make: Callable[[RigMotion, Path], Fault | None], name: str, deed: Callable[[], None]) -> None:
        self.make, self.name, self.deed, self.done = make, name, deed, False

    def __call__(self, motion: RigMotion, path: Path) -> Fault | None:
        if path.stem != self.name or self.done:
            return self.make(motion, path)
        self.done = True
        timer = threading.Timer(1.0, self.deed)
        timer.start()
        fault = self.make(motion, path)
        timer.join()
        return fault


def test_an_unplugged_board_costs_one_run_on_the_emulated_rig(
    emulator: Emulator, short: SplitPlan, limits: SafetyLimits, tmp_path: Path
) -> None:
    """Over a real pty: the board leaves in the first designed run; that run is set aside and made again."""
    setup, folder = setup_at(emulator.url, limits), tmp_path / "out"

    def pull() -> None:
        emulator.say("unplug")
        time.sleep(0.3)
        emulator.say("replug")

    with connected(setup) as board:
        make = Disturbed(motion_runner(setup, board, None), "experiment-0002", pull)
        found = run_until_split(folder, short, Bench(make, two_are_enough, lambda _runs: []))
    assert found.ending == "split"
    assert all(is_complete_run(path) for path in found.experiments)
    assert [path.name for path in folder.glob("*.unfinished-*")] == ["experiment-0002.unfinished-1.rrd"]
    failed = [line for line in journal_of(folder) if "failed" in line]
    assert [line["failed"] for line in failed] == ["experiment-0002"]
    assert failed[0]["kind"] in ("link_lost", "watchdog")  # whichever the host hears of first


def test_a_board_that_stays_away_is_told_and_the_campaign_goes_on_when_it_is_back(
    emulator: Emulator, short: SplitPlan, limits: SafetyLimits, tmp_path: Path
) -> None:
    """The attempts after the first leave no recording at all: the fault's own words say that the port is gone."""
    setup, folder, heard = setup_at(emulator.url, limits), tmp_path / "out", []
    with connected(setup) as board:
        make = Disturbed(motion_runner(setup, board, None), "sine", lambda: emulator.say("unplug"))
        bench = Bench(make, two_are_enough, lambda _runs: [])
        with pytest.raises(Fault, match=r"sine\.rrd: 3 attempts failed; the last: .*cannot be opened") as raised:
            run_until_split(folder, short, bench, told=heard.append)
    assert raised.value.kind == "link_lost"
    assert [words.split(";")[-1] for words in heard if words.startswith("sine.rrd: link_lost")] == [
        " attempt 2 of 3 in 0 s", " attempt 3 of 3 in 0 s",
    ]  # fmt: skip
    failed = [line for line in journal_of(folder) if "failed" in line]
    assert [(line["failed"], line["kind"]) for line in failed] == [("sine", "link_lost")] * 3
    assert "cannot be opened" in failed[2]["words"]
    emulator.say("replug")
    with connected(setup) as board:
        again = Bench(motion_runner(setup, board, None), two_are_enough, lambda _runs: [])
        assert run_until_split(folder, short, again).ending == "split"


def test_a_jammed_servo_ends_the_campaign_at_once_on_the_emulated_rig(
    emulator: Emulator, short: SplitPlan, limits: SafetyLimits, tmp_path: Path
) -> None:
    """The board has switched the servo off: an attempt more could not move it."""
    setup, folder = setup_at(emulator.url, limits), tmp_path / "out"
    with connected(setup) as board:
        make = Disturbed(motion_runner(setup, board, None), "sine", lambda: emulator.say("jam", 1))
        with pytest.raises(Fault, match=r"sine\.rrd: the board ended the run: OVERCURRENT") as raised:
            run_until_split(folder, short, Bench(make, two_are_enough, lambda _runs: []))
    assert raised.value.kind == "overcurrent"
    assert [line["kind"] for line in journal_of(folder)] == ["overcurrent"]

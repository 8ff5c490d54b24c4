"""Campaigns until the explanations are split: resumed after every fault, no sound run made twice, drift told."""

from __future__ import annotations

import json
import random
import threading
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
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
from rig.sentinel import changes, numbers_of
from rig.soundness import is_complete_run
from rig.split_decision import Decision
from rig.split_journal import NAME
from rig.until_split import Bench, Conclusion, SplitPlan, run_until_split
from tentacle.errors import InputError
from tentacle.recording import Declaration, LoadCellSignal, Recording, ShapeTrack
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Chirp, Sine
from tests.rig.test_campaign import setup_at

MOTION = Sine(0.3, 1.0)


@pytest.fixture
def plan(limits: SafetyLimits) -> SplitPlan:
    chirp = Chirp(0.3, 0.3, 2.0, 2.0)
    first = CampaignRun("chirp", rig_motion(chirp, 2.0, limits, described(chirp)))
    return SplitPlan(Campaign("twins", (first,)), limits)


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
    assert bench.made == 4 + 3  # references before the first and the third experiment, and before the conclusion
    assert go(tmp_path, plan, bench) == found
    assert bench.made == 7


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
    assert bench.made == 7 + len(FAULTS)  # a run more for each fault, none for anything else
    lines = [json.loads(line) for line in (tmp_path / NAME).read_text().splitlines()]
    assert [len(line["runs"]) for line in lines] == [1, 2, 3, 4]


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
    assert bench.made == 7


def test_a_rig_that_keeps_failing_is_a_fault(plan: SplitPlan, tmp_path: Path) -> None:
    bench = FaultyBench(["overcurrent"] * 9)
    with pytest.raises(Fault, match="3 attempts did not complete"):
        go(tmp_path, plan, bench)
    assert bench.made == 3


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
    bench = Bench(FaultyBench([]).make, decided, lambda runs: ["softer"] * (len(runs) > 1))
    found = run_until_split(tmp_path, plan, bench)
    assert (found.ending, found.drift, len(found.experiments)) == ("drifted", ("softer",), 2)


def test_a_name_that_the_campaign_gives_is_refused(plan: SplitPlan) -> None:
    run = replace(plan.first.runs[0], name="reference-0000")
    with pytest.raises(InputError, match="is a name that this campaign gives"):
        replace(plan, first=Campaign("twins", (run,)))


def reference(seed: int, swing: float = 0.5, lag: float = 0.4, mean: float = 0.0) -> Recording:
    """Twelve seconds of a tip that follows a sine of 1 Hz, seen with 0.003 rad of noise."""
    random = np.random.default_rng(seed)
    t, cell = np.arange(0, 12, 1 / 30), np.arange(0, 12, 0.0107)
    tip = mean + swing * np.sin(2 * np.pi * t - lag) + 0.003 * random.normal(size=t.size)
    shape = ShapeTrack(
        t, np.column_stack([np.zeros_like(t), tip]), np.zeros((t.size, 2, 2)), np.ones(t.size, dtype=bool),
        ("",) * t.size, 1.0, 0.0, np.zeros(2),
    )  # fmt: skip
    thrust = 0.02 * np.sin(4 * np.pi * cell) + 3e-4 * random.normal(size=cell.size)
    declaration = Declaration(Specimen(Cone(0.0125, 0.001), 0.14, 1070.0), WATER)
    return Recording("reference", declaration, load_cell=LoadCellSignal(cell, thrust), shape=shape)


@pytest.mark.parametrize(
    ("moved", "names"),
    [
        ({"swing": 0.47}, ["the tip's swing"]),
        ({"lag": 0.45}, ["the tip's lag"]),
        ({"mean": 0.02}, ["the tip's mean heading"]),
    ],
)
def test_the_sentinel_names_what_changed(moved: dict[str, float], names: list[str]) -> None:
    before, after = (numbers_of(r, MOTION) for r in (reference(1), reference(2, **moved)))
    found = changes(before, after, "reference-0000")
    assert [change.name for change in found] == names
    value = moved.get("swing", 0.5) / 0.5 - 1 or moved.get("lag", 0.4) - 0.4 or moved.get("mean", 0.0) / 0.5
    assert abs(found[0].change - value) < found[0].half_width


def test_the_sentinel_is_silent_where_nothing_changed() -> None:
    """A comparison has 0.001 false alarms: 96 % of such forty have none, and these seeds are fixed."""
    runs = [numbers_of(reference(seed), MOTION) for seed in range(41)]
    assert not [change for run in runs[1:] for change in changes(runs[0], run, "first")]


def test_a_reference_of_too_few_periods_is_refused() -> None:
    with pytest.raises(InputError, match="whole periods"):
        numbers_of(reference(1), Sine(0.3, 0.3))


def test_an_unplugged_board_costs_one_run_on_the_emulated_rig(
    emulator: Emulator, limits: SafetyLimits, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Over a real pty: the board leaves in the first designed run; that run is set aside and made again."""
    monkeypatch.setattr(until_split, "DURATION", 1.0)
    monkeypatch.setattr(until_split, "REFERENCE_PERIODS", 1)
    setup = setup_at(emulator.url, limits)
    wave = Sine(0.3, 1.0)
    plan = SplitPlan(Campaign("twins", (CampaignRun("sine", rig_motion(wave, 1.0, limits, described(wave))),)), limits)
    judged: list[int] = []

    def judge(runs: Sequence[Path]) -> Decision:
        judged.append(len(runs))
        return replace(decided(runs), mass=0.97 if len(runs) == 2 else 0.6)

    with connected(setup) as board:
        make, pulled = motion_runner(setup, board, None), threading.Event()

        def pull() -> None:
            emulator.say("unplug")
            time.sleep(0.3)
            emulator.say("replug")

        def run(motion: RigMotion, path: Path) -> None:
            timer = threading.Timer(1.0, pull)
            if path.stem == "experiment-0002" and not pulled.is_set():
                pulled.set()
                timer.start()
            make(motion, path)
            timer.cancel()

        found = run_until_split(tmp_path / "out", plan, Bench(run, judge, lambda _runs: []))
    assert (found.ending, judged) == ("split", [1, 2])
    assert all(is_complete_run(path) for path in found.experiments)
    assert [path.name for path in (tmp_path / "out").glob("*.unfinished-*")] == ["experiment-0002.unfinished-1.rrd"]

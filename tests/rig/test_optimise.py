"""Optimising: the gait space keeps the limits, the journal survives a kill, trials are recordings, the search
climbs.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rig.fault import Fault
from rig.gait_space import GaitSpace, TrialPlan
from rig.journal import JOURNAL
from rig.journal_file import JournalFile, cut_torn_end
from rig.optimise import STEP_FROM_BEST, RigTrial, StudyPlan, Suggestions, best, optimise_on_rig, propulsion
from rig.protocol import LoadSample
from rig.recorder import Recorder
from rig.run_file import read_run
from rig.safety import SafetyLimits, check_set_points, set_points
from rig.setup_file import LoadCellCalibration
from tentacle.errors import InputError
from tentacle.io.declaration_file import declaration_tables
from tentacle.recording import Declaration
from tentacle.specimen import WATER, Cone, Specimen

CELL = LoadCellCalibration(1000.0, 180000.0)
DECLARED = declaration_tables(Declaration(Specimen(Cone(0.0125, 0.001), 0.14, 1070.0), WATER))
TOP = 1.4  # Hz, where the bench below swims best


@pytest.fixture
def space(limits: SafetyLimits) -> GaitSpace:
    return GaitSpace(limits, (0.4, 3.0), harmonics=0)


class Bench:
    """A bench that swims best at TOP Hz and full effort; its runs are written as the rig writes them."""

    def __init__(self, noise: float = 0.0, fails: tuple[int, ...] = ()) -> None:
        self.runs = 0
        self.noise, self.fails = noise, fails
        self.random = np.random.default_rng(1)

    def propulsion(self, frequency: float, effort: float) -> float:
        return 0.05 * effort**2 * np.exp(-(((frequency - TOP) / 0.8) ** 2))

    def __call__(self, _gait, duration: float, path: Path, description: dict) -> None:
        self.runs += 1
        value = self.propulsion(description["frequency_hz"], description["effort"])
        value += self.noise * self.random.normal()
        start = {
            "name": path.stem, "recording": DECLARED, "lead_s": 0.0, "waveform": description,
            "load_cell": {"offset_counts": CELL.offset, "counts_per_newton": CELL.slope},
        }  # fmt: skip
        with Recorder(path, start, CELL.to_newtons) as recorder:
            recorder.begin(1_000_000)
            times = 1_000_000 + np.arange(0, duration + 0.05, 0.0107) * 1e6
            counts = round(CELL.offset - CELL.slope * value)
            recorder.samples([LoadSample(k, int(t), counts) for k, t in enumerate(times)])
            outcome = "overcurrent" if self.runs in self.fails else "complete"
            recorder.stop(outcome, {"start_us": 1_000_000, "rest_n": 0.0})


def test_every_point_is_within_the_limits(limits: SafetyLimits) -> None:
    space = GaitSpace(limits, (0.3, 3.0), harmonics=2)
    for point in space.sample(64, seed=5):
        gait = space.gait(point)
        points = set_points(gait, 3.0 / point["frequency_hz"], limits)
        # The lead from neutral is half a second long: with at most 0.8 rad it is slower than pi/2 0.8 / 0.5 = 2.5
        # rad/s, but it ends at rest and the gait does not: where they meet the difference is still a chord of the gait.
        check_set_points(points, 0.02, limits)


def test_points_outside_the_space_are_refused(space: GaitSpace) -> None:
    with pytest.raises(InputError, match="frequency_hz"):
        space.gait({"frequency_hz": 9.0, "effort": 1.0})
    with pytest.raises(InputError, match="effort"):
        space.gait({"frequency_hz": 1.0})


def test_the_search_climbs_and_every_trial_is_a_recording(space: GaitSpace, tmp_path: Path) -> None:
    bench = Bench(noise=2e-4)
    study = StudyPlan(space, trials=16, plan=TrialPlan(3, 1), seed=4)
    first = [{"frequency_hz": 2.4, "effort": 0.9}]  # a wrong model's best
    trials = list(optimise_on_rig(tmp_path, study, bench, Suggestions(first)))
    assert len(trials) == 16
    assert trials[0].source == "model"
    assert trials[0].point == pytest.approx(first[0])
    # 0.05 N is the best there is. Sixteen trials in two dimensions: within 5 % (benchmarks/rig.py, gap_after_30).
    assert bench.propulsion(**{k.removesuffix("_hz"): v for k, v in best(trials).point.items()}) > 0.95 * 0.05
    for trial in trials:
        run = read_run(trial.recording)
        assert run.outcome == "complete"
        assert run.start["waveform"]["trial"] == trial.number


def test_every_other_trial_steps_from_the_best(space: GaitSpace, tmp_path: Path) -> None:
    """The search alone spends its trials in corners: steps from the best are what betters a model's gait."""
    trials = list(optimise_on_rig(tmp_path, StudyPlan(space, trials=16, plan=TrialPlan(3, 1), seed=2), Bench()))
    near = [k for k, trial in enumerate(trials) if trial.source == "near the best"]
    assert near == [9, 11, 13, 15]
    width = np.ptp(np.array(list(space.bounds.values())), axis=1)
    for k in near:
        before = best(trials[:k]).point
        steps = [(trials[k].point[name] - before[name]) for name in space.bounds]
        assert np.abs(steps / width).max() < 4 * STEP_FROM_BEST


@pytest.mark.parametrize("damage", ["zeroed", "gone", "a line"])
def test_a_damaged_journal_is_made_again_from_the_recordings(space: GaitSpace, tmp_path: Path, damage: str) -> None:
    study = StudyPlan(space, trials=3, plan=TrialPlan(3, 1))
    before = list(optimise_on_rig(tmp_path, study, Bench()))
    contents = {path.name: path.read_bytes() for path in tmp_path.glob("*.rrd")}
    journal = tmp_path / JOURNAL
    if damage == "gone":
        journal.unlink()
    elif damage == "zeroed":
        journal.write_bytes(bytes(journal.stat().st_size))
    else:
        lines = journal.read_bytes().splitlines(keepends=True)
        journal.write_bytes(b"".join([*lines[:4], b"\x00\x01torn\n", *lines[5:]]))
    said: list[str] = []
    bench = Bench()
    again = list(optimise_on_rig(tmp_path, StudyPlan(space, trials=4, plan=TrialPlan(3, 1)), bench, told=said.append))
    assert [t.propulsion for t in again[:3]] == [t.propulsion for t in before]
    assert [t.recording for t in again[:3]] == [t.recording for t in before]
    assert bench.runs == 1
    assert "3 trials are recovered" in said[-1]
    for name, content in contents.items():
        assert (tmp_path / name).read_bytes() == content


def test_any_damage_of_the_journal_is_told_and_changes_no_answer(space: GaitSpace, tmp_path: Path) -> None:
    """A turned bit, a line that is missing, doubled or elsewhere, zeros, and a cut: the same trials, and none again."""
    study = StudyPlan(space, trials=4, plan=TrialPlan(3, 1))
    before = list(optimise_on_rig(tmp_path, study, Bench(fails=(2,))))  # numbers and files differ after a failed one
    whole = (tmp_path / JOURNAL).read_bytes()
    recordings = {path.name: path.read_bytes() for path in tmp_path.glob("*.rrd")}
    random = np.random.default_rng(3)
    for k in range(24):
        lines, at = whole.splitlines(keepends=True), int(random.integers(len(whole)))
        row = int(random.integers(len(lines)))
        damaged = (
            whole[:at] + bytes([whole[at] ^ (1 << int(random.integers(8)))]) + whole[at + 1 :],
            b"".join([*lines[:row], *lines[row + 1 :]]),
            b"".join([*lines[:row], lines[row], *lines[row:]]),
            whole[:at] + bytes(min(9, len(whole) - at)) + whole[at + 9 :],
            whole[:at],
            b"".join([*lines[row:], *lines[:row]]),
        )[k % 6]
        (tmp_path / JOURNAL).write_bytes(damaged)
        bench, said = Bench(), []
        again = list(optimise_on_rig(tmp_path, study, bench, told=said.append))
        assert bench.runs == 0
        assert sorted(t.recording for t in again) == sorted(t.recording for t in before)
        for one, other in zip(sorted(again, key=lambda t: t.recording), before, strict=True):
            assert (one.point, one.propulsion) == (other.point, other.propulsion)
        assert {path.name: path.read_bytes() for path in tmp_path.glob("*.rrd")} == recordings
        for aside in tmp_path.glob("*unfinished*"):
            aside.unlink()


def test_entries_of_a_journal_are_sound_up_to_the_first_that_is_not(tmp_path: Path) -> None:
    file = tmp_path / JOURNAL
    JournalFile(file).append_logs([{"a": 1}, {"a": 2}])
    JournalFile(file).append_logs([{"a": 3}])
    assert list(JournalFile(file).read_logs(1)) == [{"a": 2}, {"a": 3}]
    whole = file.read_bytes()
    for left in (b"0123456789abcdef {", bytes(50), b"\0\0\n"):  # as a crash or a power cut leaves it
        file.write_bytes(whole + left)
        assert cut_torn_end(file) is None
        assert file.read_bytes() == whole
    file.write_bytes(whole.replace(b'{"a":2}', b'{"a":7}'))
    assert cut_torn_end(file) == 2
    assert list(JournalFile(file).read_logs(0)) == [{"a": 1}]
    assert cut_torn_end(tmp_path / "none") is None


def test_a_killed_study_goes_on_where_it_was(space: GaitSpace, tmp_path: Path) -> None:
    study = StudyPlan(space, trials=4, plan=TrialPlan(3, 1))

    class Killed(BaseException):
        pass

    class Dying(Bench):
        def __call__(self, gait, duration: float, path: Path, description: dict) -> None:
            if self.runs == 2:
                raise Killed
            super().__call__(gait, duration, path, description)

    with pytest.raises(Killed):
        list(optimise_on_rig(tmp_path, study, Dying()))
    with (tmp_path / JOURNAL).open("ab") as journal:
        journal.write(b'{"op_code": 4, "wor')  # torn by the kill
    bench = Bench()
    trials = list(optimise_on_rig(tmp_path, study, bench))
    assert [t.number for t in trials[:2]] == [0, 1]
    assert len(trials) == 4
    assert bench.runs == 2  # what was finished is not run again
    assert "again" in [t.source for t in trials]  # what was running is
    assert list(optimise_on_rig(tmp_path, study, bench))[:4] == trials
    assert bench.runs == 2


def test_a_recording_that_was_whole_when_the_host_died_counts(space: GaitSpace, tmp_path: Path) -> None:
    class Killed(BaseException):
        pass

    class DyingLate(Bench):
        def __call__(self, gait, duration: float, path: Path, description: dict) -> None:
            super().__call__(gait, duration, path, description)
            if self.runs == 2:
                raise Killed

    study = StudyPlan(space, trials=3, plan=TrialPlan(3, 1))
    with pytest.raises(Killed):
        list(optimise_on_rig(tmp_path, study, DyingLate()))
    bench = Bench()
    assert len(list(optimise_on_rig(tmp_path, study, bench))) == 3
    assert bench.runs == 1


def test_failed_trials_are_tried_again_and_three_in_a_row_stop(space: GaitSpace, tmp_path: Path) -> None:
    study = StudyPlan(space, trials=3, plan=TrialPlan(3, 1))
    bench = Bench(fails=(2,))
    trials = list(optimise_on_rig(tmp_path / "one", study, bench))
    assert len(trials) == 3
    assert bench.runs == 4
    with pytest.raises(Fault, match="3 trials in a row"):
        list(optimise_on_rig(tmp_path / "all", study, Bench(fails=(1, 2, 3, 4))))


def test_the_model_is_asked_anew_after_every_k_trials(space: GaitSpace, tmp_path: Path) -> None:
    asked: list[int] = []

    def propose(recordings) -> list[dict[str, float]]:
        asked.append(len(recordings))
        return [{"frequency_hz": TOP, "effort": 1.0}]

    study = StudyPlan(space, trials=7, plan=TrialPlan(3, 1), reidentify_every=3)
    trials = list(optimise_on_rig(tmp_path, study, Bench(), suggestions=Suggestions(propose=propose)))
    assert asked == [3, 6]
    assert [t.source for t in trials][3] == "model after 3"


def test_a_folder_of_another_study_is_refused(space: GaitSpace, limits: SafetyLimits, tmp_path: Path) -> None:
    study = StudyPlan(space, trials=1, plan=TrialPlan(3, 1))
    list(optimise_on_rig(tmp_path, study, Bench()))
    other = StudyPlan(GaitSpace(limits, (0.5, 2.0), 0), trials=1)
    with pytest.raises(InputError, match="other bounds"):
        list(optimise_on_rig(tmp_path, other, Bench()))


def test_propulsion_is_minus_thrust_less_rest(tmp_path: Path) -> None:
    path = tmp_path / "run.rrd"
    bench = Bench()
    bench(None, 3.0, path, {"frequency_hz": TOP, "effort": 1.0})
    assert propulsion(read_run(path), 0.5, 3.0) == pytest.approx(0.05, abs=1e-5)  # counts are whole: 2.8e-6 N
    with pytest.raises(InputError, match="was not sampled"):
        propulsion(read_run(path), 0.5, 9.0)


def test_no_trial_has_no_best() -> None:
    with pytest.raises(InputError):
        best([])
    trial = RigTrial(0, {}, 0.1, "model", Path("a"))
    assert best([trial]) is trial

"""What the drift sentinel of a campaign finds on the emulated rig, and how often it is wrong without a drift.

The reference motion is recorded many times: board over a pty, MuJoCo arm, camera, load cell, each with its noise. Runs
are drawn at random as the first six and the five later ones of a campaign; none has changed, so that each change told
is a false alarm. An arm of another stiffness tells the numbers' slopes, and these the smallest change of stiffness that
one comparison finds with 90 %. Such arms are then recorded, and the share of their runs that is found is counted.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

# benchmarks/vision.py and benchmarks/rig.py must not stand for the rooms of those names.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks._figures import tell
from benchmarks.export import arm
from rig.connection import connected, opened_camera
from rig.emulated_setup import EmulatedArm, emulated_setup
from rig.emulator import Emulator
from rig.motion import rig_motion
from rig.record import motion_runner
from rig.reidentify import tracked
from rig.run_file import read_run
from rig.sentinel import NAMES, ReferenceRuns, sentinel_numbers
from rig.soundness import is_filmed_run
from rig.until_split import REFERENCE, REFERENCE_PERIODS, SplitPlan
from tentacle.io.model_file import write_model
from tentacle.io.waveform_file import waveform_table
from tentacle.model import Estimate
from tentacle.signals import Array

FIRST, COMPARISONS = SplitPlan.repeats, SplitPlan.most // SplitPlan.reference_every + 1
SOFTER = 0.05  # of the arm that tells the slopes
DRAWN = 4000  # campaigns


def recorded(folder: Path, softer: float, count: int, seed: int) -> Array:
    """The reference's numbers (count, 4) of an arm whose stiffness is less by this share. Runs in the folder stay."""
    folder.mkdir(parents=True, exist_ok=True)
    model = arm()
    value = model.parameters["elasticity"]["E"].value * (1.0 - softer)
    parameters = {**model.parameters, "elasticity": {"E": Estimate.exact(value)}}
    write_model(replace(model, parameters=parameters), folder / "model.toml")
    setup, settings = emulated_setup(folder, EmulatedArm(folder / "model.toml"), seed=seed, rate=1.0, camera=True)
    seconds = REFERENCE_PERIODS / REFERENCE.frequency
    motion = rig_motion(REFERENCE, seconds, setup.limits, waveform_table(REFERENCE))
    paths = [folder / f"reference-{k:04d}.rrd" for k in range(count)]
    if not all(is_filmed_run(path) for path in paths):
        with Emulator(folder, settings), connected(setup) as board, opened_camera(setup, board.time) as camera:
            record = motion_runner(setup, board, camera)
            for path in paths:
                while not is_filmed_run(path):  # a busy computer can miss the board's watchdog
                    path.unlink(missing_ok=True)
                    print(f"{path}: {record(motion, path) or 'complete'}", flush=True)
    return np.array([sentinel_numbers(tracked(read_run(path)), REFERENCE) for path in paths])


def false_alarms(numbers: Array, seed: int) -> float:
    """The share of campaigns drawn from runs (N, 4) of an arm that stays the same that are told of a drift."""
    random = np.random.default_rng(seed)
    told = 0
    for _ in range(DRAWN):
        drawn = random.permutation(len(numbers))[: FIRST + COMPARISONS]
        first = ReferenceRuns(numbers[drawn[:FIRST]], COMPARISONS)
        told += any(first.changes(numbers[k], "") for k in drawn[FIRST:])
    return told / DRAWN


def found(numbers: Array, later: Array, seed: int) -> float:
    """The share of comparisons of changed runs (M, 4) with six of the unchanged ones (N, 4) that are told."""
    random = np.random.default_rng(seed)
    told = 0
    for _ in range(DRAWN):
        first = ReferenceRuns(numbers[random.permutation(len(numbers))[:FIRST]], COMPARISONS)
        told += bool(first.changes(later[random.integers(len(later))], ""))
    return told / DRAWN


def figures(folder: Path, count: int, seed: int) -> dict[str, float]:
    same = recorded(folder / "same", 0.0, count, seed)
    all_runs = ReferenceRuns(same, COMPARISONS)
    spread = same.std(axis=0, ddof=1) / all_runs.scale
    for name, value in zip(NAMES, spread, strict=True):
        print(f"{name}: standard deviation {value:.2g} of its scale", flush=True)
    slope = recorded(folder / "softer", SOFTER, 4, seed + 1).mean(axis=0) - same.mean(axis=0)
    slope = slope / all_runs.scale / SOFTER
    print("relative change per relative loss of stiffness:", np.round(slope, 3).tolist(), flush=True)
    # Six runs, not all: the same scatter, and the quantile of a campaign.
    six = ReferenceRuns(_with_spread(same), COMPARISONS)
    smallest = float(np.min(six.found_by(0.9) / np.abs(slope)))
    print(f"smallest loss of stiffness that one comparison finds with 90 %: {100 * smallest:.2g} %", flush=True)
    changed = recorded(folder / "smallest", smallest, max(count // 4, 4), seed + 2)
    return {
        "sentinel_repeats": float(count),
        "sentinel_swing": float(spread[1]),
        "sentinel_lag_rad": float(spread[2]),
        "sentinel_false_alarms": false_alarms(same, seed),
        "sentinel_smallest_stiffness": smallest,
        "sentinel_found": found(same, changed, seed),
    }


def _with_spread(numbers: Array) -> Array:
    """Six rows of the same mean and standard deviation as all (N, 4)."""
    signs = np.where(np.arange(FIRST) % 2, 1.0, -1.0)[:, None] * np.sqrt((FIRST - 1) / FIRST)
    return numbers.mean(axis=0) + signs * numbers.std(axis=0, ddof=1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="for the recordings, which are not made again")
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        found = figures(arguments.keep or Path(name), arguments.repeats, arguments.seed)
    tell(found, arguments.json)


if __name__ == "__main__":
    main()

"""A soak of the emulated rig: run after run with faults drawn at random, and every recording read back.

python benchmarks/soak.py --json FILE [--seconds 600] [--seed 1]

A sample is lost untold where its number is missing in the recording and the run neither counts it as lost nor ends as
anything else than complete.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # before benchmarks/, which holds a rig.py too

from benchmarks._commit import commit_of
from benchmarks._rig_scene import setup_for
from rig.camera import CameraThread
from rig.connection import connected
from rig.emulated_camera import EmulatedOptics, EmulatedSource
from rig.emulator import Emulator, EmulatorSettings
from rig.fault import Fault
from rig.motion import described, rig_motion
from rig.record import Attendance, RunResult, record_run
from rig.run import Run
from rig.run_file import iterate_frames, read_run
from rig.settle import SettleRule
from tentacle.errors import InputError
from tentacle.waveform import Sine

SECONDS = 3.0  # of a run


def deeds(emulator: Emulator, random: np.random.Generator) -> list[tuple[str, Callable[[], None]]]:
    """What may happen in a run."""
    noise = float(random.uniform(0.0005, 0.006))

    def cell(seconds: float) -> None:
        emulator.say("cell_off", 1)
        time.sleep(min(seconds, 0.1))

    return [
        ("nothing", lambda: None),
        ("bad line", lambda: emulator.say("line", noise, noise, noise)),
        ("unplugged", lambda: (emulator.say("unplug"), time.sleep(0.2), emulator.say("replug"))[0]),
        ("reset", lambda: emulator.say("reset")),
        ("mute", lambda: emulator.say("mute", float(random.uniform(0.05, 0.6)))),
        ("cell off", lambda: cell(0.05)),
        ("cell glitch", lambda: emulator.say("cell_glitch")),
        ("jammed", lambda: emulator.say("jam", 1)),
        ("host hung", lambda: time.sleep(float(random.uniform(0.1, 0.8)))),
        ("disk full", lambda: None),
    ]


def one_run(folder: Path, number: int, random: np.random.Generator) -> tuple[str, RunResult | None, Path]:
    """A run on a fresh board with one fault at a random moment; None where it did not come to a recording."""
    path = folder / f"run-{number:04d}.rrd"
    with Emulator(folder / "emulator", EmulatorSettings(seed=number)) as emulator:
        name, deed = deeds(emulator, random)[int(random.integers(10))]
        at, done, begun = float(random.uniform(0.2, SECONDS)), [], [0.0]

        def progress(phase: str, _share: float) -> None:
            if phase != "running":
                return
            begun[0] = begun[0] or time.monotonic()
            if not done and time.monotonic() - begun[0] > at:
                done.append(True)
                deed()

        setup = setup_for(emulator, settle=SettleRule(threshold=5e-3, samples=40, timeout=20.0))
        wave = Sine(float(random.uniform(0.1, 0.5)), float(random.uniform(0.5, 1.5)))
        full = name == "disk full"
        try:
            with connected(setup) as board:
                camera = CameraThread(
                    lambda: EmulatedSource(emulator.trace, EmulatedOptics.of(setup.recording.declaration), board.time),
                    board.time,
                )
                try:
                    result = record_run(
                        setup,
                        board,
                        camera,
                        rig_motion(wave, SECONDS, setup.limits, described(wave)),
                        path,
                        Attendance(
                            name=path.stem, progress=progress, free_bytes=lambda _: 0 if full and done else 10**9
                        ),
                    )
                finally:
                    camera.close()
        except Fault:
            return name, None, path
    return name, result, path


def lost_untold(run: Run, result: RunResult) -> int:
    """Sample numbers that are missing in the file of a run that says it is complete and has lost none or fewer."""
    numbers = np.sort(np.concatenate([run.load_number, run.servo_number]))
    if result.outcome != "complete" or not len(numbers):
        return 0
    events = len(run.events)  # they share the samples' numbers
    missing = int(numbers[-1] - numbers[0] + 1 - len(set(numbers.tolist())))
    return max(missing - events - result.lost, 0)


def main() -> None:
    """Runs until the time is over; figures as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    commit = commit_of(Path(__file__).parent)
    random = np.random.default_rng(arguments.seed)
    outcomes: Counter[str] = Counter()
    unreadable = untold = runs = samples = 0
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        while time.monotonic() - begun < arguments.seconds:
            name, result, path = one_run(Path(folder), runs, random)
            runs += 1
            if result is None and not path.exists():
                outcomes[f"{name}: refused before the run"] += 1
                continue
            try:
                run = read_run(path)
                frames = sum(1 for _ in iterate_frames(path))
            except InputError as error:
                unreadable += 1
                print(f"unreadable after {name}: {error}")
                continue
            samples += len(run.load_t) + len(run.servo_t)
            if result is not None:
                untold += lost_untold(run, result)
                unreadable += frames != len(run.frame_host_t) or run.outcome != result.outcome
            outcomes[f"{name}: {run.outcome}"] += 1
            path.unlink()
    for words, count in sorted(outcomes.items()):
        print(f"{count:4d}  {words}")
    figures = {
        "soak_minutes": (time.monotonic() - begun) / 60,
        "soak_runs": float(runs),
        "soak_samples": float(samples),
        "soak_unreadable": float(unreadable),
        "soak_lost_untold": float(untold),
    }
    print(figures)
    arguments.json.write_text(json.dumps({"figures": figures, "commit": commit}, indent=1))


if __name__ == "__main__":
    main()

"""`tentacle rig optimise` while the host, or the board, is killed (-9): the same command goes on where it was."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from benchmarks._rig_faults import Outcome
from benchmarks._rig_scene import NEUTRAL_US, setup_for, to_neutral
from rig.emulator import Emulator, EmulatorSettings
from rig.run_file import read_run
from rig.setup_file import write_setup
from tentacle.errors import InputError

TRIALS = 3


def _command(folder: Path) -> list[str]:
    words = f"rig optimise {folder / 'rig.toml'} --out {folder / 'study'} --trials {TRIALS} --frequency 2 3"
    return [sys.executable, "-m", "tentacle", *words.split()]


def _until_second_trial_moves(process: subprocess.Popen[bytes], emulator: Emulator, folder: Path) -> None:
    path = folder / "study" / "trial-0001.rrd"
    until = time.monotonic() + 90.0
    while not path.exists() or abs(emulator.truth().pulse_us - NEUTRAL_US) < 50:
        if process.poll() is not None or time.monotonic() > until:
            raise RuntimeError(f"the second trial did not begin (exit status {process.poll()})")
        time.sleep(0.005)


def _finished(folder: Path) -> tuple[int, int]:
    """How many recordings of the study are complete, and how many are not."""
    outcomes = []
    for path in sorted((folder / "study").glob("*.rrd")):
        try:
            outcomes.append(read_run(path).outcome)
        except InputError:
            outcomes.append("unreadable")
    return outcomes.count("complete"), len(outcomes) - outcomes.count("complete")


@contextmanager
def _in_second_trial(folder: Path, seed: int) -> Iterator[tuple[Emulator, subprocess.Popen[bytes]]]:
    """An emulated rig, and the process that optimises on it, in the middle of its second trial."""
    with Emulator(folder / "emulator", EmulatorSettings(seed=seed)) as emulator:
        write_setup(setup_for(emulator), folder / "rig.toml")
        with subprocess.Popen(_command(folder), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
            _until_second_trial_moves(process, emulator, folder)
            yield emulator, process


def _again(folder: Path) -> tuple[int, int, int]:
    """The same command once more: its exit status, and how many recordings are complete, and are not."""
    status = subprocess.run(_command(folder), capture_output=True, check=False, timeout=180).returncode
    return status, *_finished(folder)


def killed_host(folder: Path) -> Outcome:
    """kill -9 of the optimising process in its second trial, then the same command again."""
    with _in_second_trial(folder, 21) as (emulator, process):
        process.kill()
        neutral = to_neutral(emulator)
        process.wait()
        status, complete, broken = _again(folder)
    words = f"at neutral after {neutral:.2f} s; resumed (exit status {status}): {complete} complete, {broken} not"
    good = neutral <= 0.5 and (status, complete) == (0, TRIALS) and broken >= 1  # more where the computer is busy
    return Outcome("optimise: host killed -9 and started again", words, good)


def killed_board(folder: Path) -> Outcome:
    """kill -9 of the board in the second trial; the host must say so and end, and go on when the board is back."""
    with _in_second_trial(folder, 22) as (emulator, process):
        emulator.kill()
        said = process.communicate(timeout=90)[1].decode().strip().splitlines()[-1]
    with Emulator(folder / "emulator", EmulatorSettings(seed=23)):
        status, complete, broken = _again(folder)
    words = f"exit status {process.returncode}, {said!r}; resumed ({status}): {complete} complete, {broken} not"
    good = process.returncode == 3 and said.startswith("tentacle: link_lost") and (status, complete) == (0, TRIALS)
    return Outcome("optimise: board killed -9 and started again", words, good)

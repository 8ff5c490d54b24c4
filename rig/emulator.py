"""A rig without hardware: the board's compiled core behind a pty, a plant it moves, and faults on demand."""

from __future__ import annotations

import contextlib
import os
import select
import struct
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from rig.build_core import compiled
from tentacle.errors import InputError
from tentacle.signals import Array

ARM_POINTS = 24
_STATE = struct.Struct(f"<Q{10 + 3 + 2 * ARM_POINTS}d")  # TraceState in firmware/host/trace.hpp
_PAST = (512, 1 + 2 * ARM_POINTS)  # after it, TracePast: board_us and points
EmulatedPlant = Literal["paddle", "arm"]
Said = Literal["unplug", "replug", "reset", "line", "mute", "cell_off", "cell_glitch", "jam", "load"]


@dataclass(frozen=True)
class Truth:
    """The true state at board_us [us]: the clock's zero and rate, the last flash, the pin, and the plant.

    angle [rad], force [N], current [mA], points (24, 2) [m] in the base frame, base to tip.
    """

    host_zero: float
    rate: float
    boot_offset_us: float
    board_us: float
    led_on_us: float
    led_off_us: float
    pulse_us: float
    pulse_since_us: float
    conversions: int
    boots: int
    angle: float
    force: float
    current: float
    points: Array

    def board_time(self, monotonic: float) -> float:
        """The board's clock [s] at CLOCK_MONOTONIC `monotonic` [s]."""
        return 1e-6 * self.boot_offset_us + self.rate * (monotonic - self.host_zero)


def read_truth(path: Path) -> Truth:
    """The emulator's trace file, read between two of its writes."""
    values = _STATE.unpack(_at_rest(path, _STATE.size))
    head, plant = values[1:11], values[11:]
    points = np.array(plant[3:]).reshape(ARM_POINTS, 2)
    zero, rate, boot, now, on, off, pulse, since, conversions, boots = head
    counted = (int(conversions), int(boots))
    return Truth(zero, rate, boot, now, on, off, pulse, since, *counted, plant[0], plant[1], plant[2], points)


def read_past(path: Path, board_s: float) -> Array:
    """True places of the arm's points (24, 2) [m] at board time `board_s` [s], less than half a second ago. InputError
    if that is longer ago, or in the future.
    """
    data = np.frombuffer(_at_rest(path, _STATE.size + 8 * _PAST[0] * _PAST[1])[_STATE.size :]).reshape(_PAST)
    data = data[data[:, 0] >= 0]
    data = data[np.argsort(data[:, 0])]
    place = int(np.searchsorted(data[:, 0], 1e6 * board_s))
    if not 0 < place < len(data):
        raise InputError(f"does not hold board time {board_s:.3f} s", file=path, expected="a time less than 0.5 s ago")
    early, late = data[place - 1], data[place]
    share = (1e6 * board_s - early[0]) / (late[0] - early[0])
    return (early[1:] + share * (late[1:] - early[1:])).reshape(ARM_POINTS, 2)


def _at_rest(path: Path, size: int) -> bytes:
    """The first `size` bytes of a trace, none of them from a write that was under way."""
    for _ in range(1000):
        with path.open("rb") as file:
            data = file.read(size)
            file.seek(0)
            after = file.read(8)
        if data[:8] == after and data[0] % 2 == 0:
            return data
        time.sleep(0.0002)
    raise InputError("is never at rest", file=path, expected="the trace of a running emulator")


@dataclass(frozen=True)
class EmulatorSettings:
    """Settings of the emulated rig. seed: of noise, faults and boot ids; rate: emulated seconds per real second;
    skew_ppm: of the board's crystal; boot_s: the board's clock at the start; load cell: period [s], offset [counts],
    slope [counts/N], noise [counts]; plant: "paddle" (two links, built in) or "arm" (MuJoCo); plant_options: for "arm".
    """

    seed: int = 1
    rate: float = 1.0
    skew_ppm: float = 40.0
    boot_s: float = 3.0
    cell_period: float = 0.0107
    cell_offset: float = 52000.0
    counts_per_newton: float = 180000.0
    noise_counts: float = 60.0
    plant: EmulatedPlant = "paddle"
    plant_options: tuple[str, ...] = field(default=())


class Emulator:
    """A running emulated rig in `folder`: `url` is its port, `trace` its truth. Use as a context manager."""

    def __init__(self, folder: Path, settings: EmulatorSettings | None = None) -> None:
        self.folder, self.settings = folder, settings or EmulatorSettings()
        self.url = str(folder / "port")
        self.trace = folder / "truth"
        self._board: subprocess.Popen[bytes] | None = None
        self._plant: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> Emulator:
        program = compiled("rig_host")
        self.folder.mkdir(parents=True, exist_ok=True)
        s = self.settings
        values = {
            "--link": self.url,
            "--trace": str(self.trace),
            "--seed": s.seed,
            "--rate": s.rate,
            "--skew-ppm": s.skew_ppm,
            "--boot-s": s.boot_s,
            "--period-us": 1e6 * s.cell_period,
            "--offset": s.cell_offset,
            "--counts-per-newton": s.counts_per_newton,
            "--noise-counts": s.noise_counts,
        }
        ends = self._start_plant() if s.plant == "arm" else ()
        if ends:
            values |= {"--plant-in": ends[0], "--plant-out": ends[1]}
        command = [str(program), *(str(word) for pair in values.items() for word in pair)]
        self._board = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, pass_fds=ends)
        for end in ends:
            os.close(end)
        self._expect("ready")
        return self

    def __exit__(self, *_: object) -> None:
        for process in (self._board, self._plant):
            if process is None:
                continue
            if process.stdin is not None:
                with contextlib.suppress(OSError):
                    process.stdin.close()
            try:
                process.wait(5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            if process.stdout is not None:
                process.stdout.close()
        self._board = self._plant = None

    def say(self, verb: Said, *numbers: float) -> None:
        """Brings about a fault: unplug, replug, reset, line CORRUPT DROP DOUBLE (shares of bytes), mute SECONDS,
        cell_off 0|1, cell_glitch, jam 0|1, load NEWTONS (hung on the load cell).
        """
        assert self._board is not None
        assert self._board.stdin is not None
        self._board.stdin.write(" ".join([verb, *(f"{n!r}" for n in numbers)]).encode() + b"\n")
        self._board.stdin.flush()
        self._expect(f"done {verb}")

    def kill(self) -> None:
        """The board's power is cut: its process ends at once (-9), and its port with it."""
        assert self._board is not None
        self._board.kill()
        self._board.wait()

    def truth(self) -> Truth:
        """The true state now."""
        return read_truth(self.trace)

    def exit_status(self) -> int | None:
        """None while the emulator runs."""
        return None if self._board is None else self._board.poll()

    def _start_plant(self) -> tuple[int, int]:
        plant_in, board_out = os.pipe()
        board_in, plant_out = os.pipe()
        command = [sys.executable, "-m", "rig.arm_plant", str(plant_in), str(plant_out), *self.settings.plant_options]
        self._plant = subprocess.Popen(command, pass_fds=(plant_in, plant_out))
        os.close(plant_in)
        os.close(plant_out)
        return board_in, board_out

    def _expect(self, line: str) -> None:
        assert self._board is not None
        assert self._board.stdout is not None
        if not select.select([self._board.stdout], [], [], 60.0)[0]:
            raise InputError(f"said nothing; {line!r} was expected", field="rig emulator")
        said = self._board.stdout.readline().decode().strip()
        if said != line:
            raise InputError(f"said {said!r} instead of {line!r}", field="rig emulator")

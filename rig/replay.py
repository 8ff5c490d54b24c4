"""A run played once more: the logged set points on an emulated board, and how far what it does is from the log."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rig.board import Board
from rig.interrupts import Interrupts
from rig.motion import RigMotion
from rig.record import Attendance, RunResult, record_run
from rig.run import Run
from rig.run_file import read_run
from rig.setup_file import RigSetup
from tentacle.errors import InputError
from tentacle.io.reading import read_recording
from tentacle.signals import Array, MotorSignal

END_SECONDS = 0.2  # s left out at either end, where a run and its replay come from rest and go to it differently


@dataclass(frozen=True)
class ReplayComparison:
    """Root mean square differences between a run and its replay at equal times: command, angle [rad], thrust [N];
    over `seconds` [s] in common, None where the log does not hold the signal.
    """

    command: float
    angle: float
    thrust: float | None
    seconds: float


def logged_motion(path: Path, period: float = 0.02) -> RigMotion:
    """The commands of a recording (a rig's run, an import folder or any .rrd) as set points one every `period` [s].

    InputError where it holds no motor signal, or one that does not start near neutral.
    """
    motor = read_recording(path).motor
    if motor is None or len(motor.t) < 3:
        raise InputError("holds no motor signal", file=path, expected="a recording with commands")
    first = int(np.ceil(motor.t[0] / period))
    t = period * np.arange(first, int(motor.t[-1] / period) + 1)
    command = np.interp(t, motor.t, motor.command)
    lead = round(0.5 / period)
    rise = command[0] * (0.5 - 0.5 * np.cos(np.pi * np.arange(lead) / lead))
    fall = command[-1] * (0.5 + 0.5 * np.cos(np.pi * np.arange(1, lead + 1) / lead))
    points = np.concatenate([rise, command, fall])
    return RigMotion(points, period, lead - first, {"kind": "replay", "of": path.name})


def drive_rig(
    path: Path,
    setup: RigSetup,
    board: Board,
    out: Path,
    *,
    interrupts: Interrupts | None = None,
    progress: Callable[[str, float], None] = lambda _phase, _share: None,
) -> tuple[RunResult, ReplayComparison | None]:
    """Plays a recording's commands on a rig, records that, and compares; None where a fault of the rig ended it within
    its first second. InputError where the commands are beyond the rig's limits.
    """
    motion = logged_motion(path)
    result = record_run(
        setup,
        board,
        None,
        motion,
        out,
        Attendance(name=f"replay of {path.stem}", interrupts=interrupts, progress=progress),
    )
    try:
        return result, compare_replay(path, read_run(out))
    except InputError:
        if result.outcome == "complete":
            raise
        return result, None


def compare_replay(path: Path, replayed: Run) -> ReplayComparison:
    """A recording beside its replay; InputError where they have less than a second in common."""
    logged = read_recording(path)
    assert logged.motor is not None
    zero = replayed.zero
    again = MotorSignal(replayed.servo_t - zero, replayed.command, replayed.angle)
    start, stop = max(logged.motor.t[0], again.t[0]), min(logged.motor.t[-1], again.t[-1])
    if stop - start < 1.0:
        raise InputError(f"only {stop - start:.2f} s in common with its replay", file=path, expected="a second or more")
    t = np.arange(start + END_SECONDS, stop - END_SECONDS, 0.01)
    thrust = None
    if logged.load_cell is not None and len(replayed.load_t):
        cell = replayed.start["load_cell"]
        newtons = (replayed.load - cell["offset_counts"]) / cell["counts_per_newton"]
        thrust = _rms(_at(t, logged.load_cell.t, logged.load_cell.thrust) - _at(t, replayed.load_t - zero, newtons))
    return ReplayComparison(
        command=_rms(_at(t, logged.motor.t, logged.motor.command) - _at(t, again.t, again.command)),
        angle=_rms(_at(t, logged.motor.t, logged.motor.angle) - _at(t, again.t, again.angle)),
        thrust=thrust,
        seconds=float(stop - start),
    )


def _at(t: Array, times: Array, values: Array) -> Array:
    return np.interp(t, times, values)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))

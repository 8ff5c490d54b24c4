"""A run as a rig recorded it: what the board said, and how it ended."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rig.clock import ClockFit
from rig.protocol import EventCode
from tentacle.signals import Array


@dataclass(frozen=True)
class RunEvent:
    """Something that happened on the board, at board_s [s]."""

    board_s: float
    code: EventCode
    value: int


@dataclass(frozen=True)
class Run:
    """A run as recorded. Times are the board's [s]; numbers are the board's sample numbers.

    load (N,) counts at load_t, load_number; command, angle, current (M,) [rad, rad, A] at servo_t, servo_number;
    frame_host_t (F,) [s] of arrival (iterate_frames gives the pictures); clocks in the order in which they were fitted.
    stop is None where the host died; missing: one line on what was cut off, "" where nothing was.
    """

    path: Path
    start: dict[str, Any]
    stop: dict[str, Any] | None
    load_t: Array
    load_number: Array
    load: Array
    servo_t: Array
    servo_number: Array
    command: Array
    angle: Array
    current: Array
    events: tuple[RunEvent, ...]
    frame_host_t: Array
    clocks: tuple[ClockFit, ...]
    missing: str = ""

    @property
    def outcome(self) -> str:
        """How it ended; "crashed" where there is no stop record."""
        return "crashed" if self.stop is None else str(self.stop["outcome"])

    @property
    def zero(self) -> float:
        """Board time [s] of the waveform's time 0; the first sample's where the run never started."""
        lead = float(self.start.get("lead_s", 0.0))
        if self.stop is not None and self.stop.get("start_us"):
            return 1e-6 * float(self.stop["start_us"]) + lead
        started = [e.board_s for e in self.events if e.code == EventCode.STARTED]
        if started:  # the servo frame in which the first set point went out: up to 20 ms after it was due
            return started[-1] + lead
        return float(min([*self.load_t[:1], *self.servo_t[:1]], default=0.0))

"""A live run: settle, flash for the camera's clock, play, and pass everything to the recorder."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any

import numpy as np

from rig import command_bodies
from rig.board import Board
from rig.camera import CameraThread
from rig.camera_watch import FLASH_EVERY, FLASH_MS, CameraWatch
from rig.coverage import told_gaps
from rig.fault import Fault
from rig.interrupts import Interrupts
from rig.motion import RigMotion
from rig.play import PlayEnd, PlayStart, play
from rig.protocol import BoardEvent, LoadSample, Sample, ServoSample, Type
from rig.recorder import Recorder
from rig.settle import Settling
from rig.setup_file import RigSetup

SYNC_FLASHES = 6  # at the start of each run
CLOCK_EVERY = 1.0  # s

Progress = Callable[[str, float], None]  # is told a phase, and the share of it that is done


class LiveRun:
    """The state of one run. count: samples so far; rest [N]: the load cell's reading before it."""

    def __init__(
        self,
        setup: RigSetup,
        board: Board,
        camera: CameraThread | None,
        motion: RigMotion,
        progress: Progress,
        interrupts: Interrupts | None,
    ) -> None:
        self.setup, self.board, self.motion = setup, board, motion
        self.progress, self.interrupts = progress, interrupts
        self.count = 0
        self.rest = 0.0
        self._watch: CameraWatch | None = None
        if camera is not None and setup.camera is not None:
            self._watch = CameraWatch(camera, setup.camera, board.time)
        self._load: list[tuple[int, int]] = []
        self._servo_us: list[int] = []
        self._clocked_at = -1e9

    def perform(self, recorder: Recorder) -> PlayEnd:
        """Settles and plays. Fault if the run does not start to play; a later fault is the outcome of the end."""
        self._settle(recorder)
        end: PlayEnd | None = None
        begun = self.board.time.now()
        for item in play(self.board, self.motion.points, self.setup.limits, period=self.motion.period,
                         interrupts=self.interrupts):  # fmt: skip
            if isinstance(item, PlayEnd):
                end = item
            elif isinstance(item, PlayStart):
                recorder.begin(item.start_us + round(1e6 * self.motion.lead))
            else:
                self._take(recorder, list(item))
                share = (self.board.time.now() - begun) / (self.motion.duration + 0.5)
                self.progress("running", min(share, 1.0))
        assert end is not None
        return told_gaps(end, [us for us, _ in self._load], self._servo_us, self.motion.duration)

    def _settle(self, recorder: Recorder) -> None:
        """The paper's rule, with its time-out; the LED flashes meanwhile, for the camera's clock."""
        rule = self.setup.settle
        settling = Settling(rule)
        self.board.take()
        begun = self.board.time.now()
        spacing = np.random.default_rng(1)
        next_flash, flashes = begun, SYNC_FLASHES if self._watch is not None else 0
        while not settling.settled or flashes > 0:
            batch = self._listen(recorder)
            settling.add(self.setup.load_cell.to_newtons(s.counts) for s in batch if isinstance(s, LoadSample))
            now = self.board.time.now()
            if flashes and now >= next_flash:
                flashes -= self._flash()
                next_flash = now + 1e-3 * FLASH_MS + float(spacing.uniform(*FLASH_EVERY))
            self.progress("settling", min((now - begun) / rule.timeout, 1.0))
            if self.interrupts is not None and self.interrupts.pause:
                raise Fault("interrupted", "stopped by hand before the run")
            if now - begun > rule.timeout:
                raise Fault(
                    "not_settled",
                    f"readings still scatter by {settling.deviation:.2g} N after {rule.timeout:g} s "
                    f"(threshold {rule.threshold:g} N)",
                )
        self.rest = settling.level
        if self._watch is not None:
            until = self.board.time.now() + 0.5
            while self.board.time.now() < until:  # the last frames are still on their way
                self._listen(recorder)
            self._watch.synchronise(self.board.clock.fit())

    def _flash(self) -> bool:
        """Whether the lamp was switched on; False if it is still on because the board is late."""
        try:
            self.board.command(Type.FLASH, command_bodies.flash(FLASH_MS))
        except Fault as fault:
            if fault.kind != "refused":
                raise
            return False
        return True

    def _listen(self, recorder: Recorder) -> list[Sample]:
        self.board.service()
        batch = self.board.take()
        self._take(recorder, batch)
        return batch

    def _take(self, recorder: Recorder, batch: list[Sample]) -> None:
        recorder.samples(batch)
        self.count += len(batch)
        for sample in batch:
            if isinstance(sample, LoadSample):
                self._load.append((sample.board_us, sample.counts))
            elif isinstance(sample, ServoSample):
                self._servo_us.append(sample.board_us)
            elif isinstance(sample, BoardEvent) and self._watch is not None:
                self._watch.event(sample)
        if self._watch is not None:
            recorder.frames(self._watch.take())
        if time.monotonic() - self._clocked_at > CLOCK_EVERY and len(self.board.clock) > 3:
            self._clocked_at = time.monotonic()
            recorder.clock(self.board.clock.fit())
        recorder.flush_if_due()

    def to_neutral(self) -> None:
        """Sends the arm to neutral; a board that cannot be reached goes there by its watchdog."""
        with suppress(Fault):
            self.board.command(Type.NEUTRAL)

    def mean_thrust(self, end: PlayEnd) -> float:
        """Mean force over the waveform [N], minus the reading at rest; NaN if the run is not complete."""
        if end.outcome != "complete":
            return float("nan")
        begin = end.start_us + 1e6 * self.motion.lead
        last = end.start_us + 1e6 * self.motion.duration
        counts = [c for us, c in self._load if begin <= us < last]
        return float(self.setup.load_cell.to_newtons(np.mean(counts)) - self.rest) if counts else float("nan")

    def stop_record(self, end: PlayEnd) -> dict[str, Any]:
        """The stop record as plain data."""
        fit = self.board.clock.fit() if len(self.board.clock) else None
        return {
            "words": end.words,
            "start_us": end.start_us,
            "ended_utc": datetime.now(UTC).isoformat(timespec="milliseconds"),
            "counters": asdict(self.board.counters),
            "clock": asdict(fit) if fit else None,
            "camera": self._watch.record() if self._watch is not None else None,
            "rest_n": self.rest,
        }

"""One run from start to stop: settle, flash for the camera's clock, play the waveform, and record all of it as it
happens.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from rig import protocol
from rig.board import Board
from rig.camera import Camera, CameraFrame, FileSource, FrameSource, WebcamSource
from rig.camera_offset import CameraOffset, combined, estimate_offset, lit_frames
from rig.emulated_camera import EmulatedOptics, EmulatedSource
from rig.fault import Fault
from rig.host_time import HostTime
from rig.interrupts import Interrupts
from rig.link import Link
from rig.play import PlayEnd, PlayStart, arm, play
from rig.protocol import Event, EventCode, LoadSample, Sample, Type
from rig.recorder import Recorder
from rig.run_file import read_run, write_video
from rig.safety import SERVO_FRAME, check_set_points, lead_samples, set_points
from rig.settle import Settling
from rig.setup_file import RigSetup, setup_tables
from tentacle.errors import InputError
from tentacle.signals import Array
from tentacle.waveform import Waveform

FLASH_MS = 120
FLASH_EVERY = (0.3, 0.5)  # s, at random in between: flashes must not keep step with the frames
SYNC_FLASHES = 6  # at the start of each run


@dataclass(frozen=True)
class Motion:
    """What the base is to do: set points (N,) [rad] every `period` [s]; zero_index, where the waveform's time 0 is."""

    points: Array
    period: float
    zero_index: int
    description: dict[str, Any]

    @property
    def duration(self) -> float:
        """From the first set point to the last [s]."""
        return (len(self.points) - 1) * self.period


@dataclass(frozen=True)
class RunResult:
    """outcome: "complete", "interrupted" or a fault's kind; mean_thrust [N] between set point zero_index and the end,
    less the reading at rest before the run; samples and lost: counts; words: one line on what went wrong.
    """

    path: Path
    outcome: str
    words: str
    mean_thrust: float
    samples: int
    lost: int


def motion_of(waveform: Waveform, duration: float, setup: RigSetup, description: dict[str, Any]) -> Motion:
    """A waveform as set points within the setup's limits; InputError where it is beyond them."""
    points = set_points(waveform, duration, setup.limits)
    return Motion(points, SERVO_FRAME, lead_samples(waveform), description)


@contextmanager
def connected(setup: RigSetup) -> Iterator[Board]:
    """A board that was greeted and armed with the setup's limits; at neutral and closed afterwards."""
    board = Board(Link(setup.port), HostTime(setup.rate))
    try:
        board.connect()
        arm(board, setup.limits, setup.servo)
        yield board
    finally:
        board.close()


@contextmanager
def opened_camera(setup: RigSetup, host_time: HostTime) -> Iterator[Camera | None]:
    """The setup's camera, running; None where it has none."""
    if setup.camera is None:
        yield None
        return
    camera = Camera(lambda: _source(setup, host_time), host_time)
    try:
        yield camera
    finally:
        camera.close()


def record(
    setup: RigSetup,
    board: Board,
    camera: Camera | None,
    motion: Motion,
    path: Path,
    *,
    name: str,
    interrupts: Interrupts | None = None,
    viewer: str | None = None,
    progress: Callable[[str, float], None] = lambda _phase, _share: None,
    free_bytes: Callable[[Path], int] | None = None,
) -> RunResult:
    """Settles, runs and records into `path`. A fault of the rig ends the run safely and is the result's outcome.

    progress is told a phase and the share of it that is done. InputError (before anything moves) where the path is
    taken or the motion is beyond the limits.
    """
    if path.exists():
        raise InputError("is there already", file=path, expected="a path that is free")
    check_set_points(motion.points, motion.period, setup.limits)
    run = _Run(setup, board, camera, motion, progress, interrupts)
    with Recorder(path, _start_record(setup, board, motion, name), setup.load_cell.to_newtons, viewer=viewer,
                  free_bytes=free_bytes) as recorder:  # fmt: skip
        try:
            end = run.perform(recorder)
        except Fault as fault:
            end = PlayEnd(fault.kind, str(fault), 0)
            _neutral(board)
        stop = run.stop_record(end)
        _film(recorder, path, {"outcome": end.outcome, **stop})
        recorder.stop(end.outcome, stop)
    return RunResult(path, end.outcome, end.words, run.mean_thrust(end), run.count, board.counters.samples_lost)


def trial_runner(
    setup: RigSetup,
    board: Board,
    camera: Camera | None,
    interrupts: Interrupts | None = None,
    progress: Callable[[str, float], None] = lambda _phase, _share: None,
) -> Callable[[Waveform, float, Path, dict[str, Any]], None]:
    """A function that tries a gait on the rig, as rig.optimise wants it; a board that was lost is connected again."""

    def run_trial(gait: Waveform, duration: float, path: Path, description: dict[str, Any]) -> None:
        if not board.link.is_open:
            board.connect()
            arm(board, setup.limits, setup.servo)
        motion = motion_of(gait, duration, setup, description)
        record(setup, board, camera, motion, path, name=path.stem, interrupts=interrupts, progress=progress)

    return run_trial


class _Run:
    """The state of one run while it lasts."""

    def __init__(
        self,
        setup: RigSetup,
        board: Board,
        camera: Camera | None,
        motion: Motion,
        progress: Callable[[str, float], None],
        interrupts: Interrupts | None,
    ) -> None:
        self.setup, self.board, self.camera, self.motion = setup, board, camera, motion
        self.progress, self.interrupts = progress, interrupts
        self.count = 0
        self.rest = 0.0
        self.offset: CameraOffset | None = None
        self.gaps: list[tuple[float, float]] = []
        self._stalled_since: float | None = None
        self._load: list[tuple[int, int]] = []
        self._flashes: list[tuple[int, bool]] = []
        self._sync: list[CameraFrame] = []
        self._clocked_at = -1e9
        self._synchronised = camera is None

    def perform(self, recorder: Recorder) -> PlayEnd:
        self._settle(recorder)
        end: PlayEnd | None = None
        begun = self.board.time.now()
        for item in play(self.board, self.motion.points, self.setup.limits, period=self.motion.period,
                         interrupts=self.interrupts):  # fmt: skip
            if isinstance(item, PlayEnd):
                end = item
            elif isinstance(item, PlayStart):
                recorder.begin(item.start_us + round(1e6 * self.motion.zero_index * self.motion.period))
            else:
                self._take(recorder, list(item))
                share = (self.board.time.now() - begun) / (self.motion.duration + 0.5)
                self.progress("running", min(share, 1.0))
        assert end is not None
        return end

    def _settle(self, recorder: Recorder) -> None:
        """The paper's rule, with its time-out; the LED flashes meanwhile, for the camera's clock."""
        rule = self.setup.settle
        settling = Settling(rule)
        self.board.take()
        begun = self.board.time.now()
        spacing = np.random.default_rng(1)
        next_flash, flashes = begun, SYNC_FLASHES if self.camera is not None else 0
        while not settling.settled or flashes > 0:
            self.board.service()
            batch = self.board.take()
            self._take(recorder, batch)
            settling.add(self.setup.load_cell.to_newtons(s.counts) for s in batch if isinstance(s, LoadSample))
            now = self.board.time.now()
            if flashes and now >= next_flash:
                self.board.command(Type.FLASH, protocol.flash(FLASH_MS))
                flashes -= 1
                next_flash = now + 1e-3 * FLASH_MS + float(spacing.uniform(*FLASH_EVERY))
            self.progress("settling", min((now - begun) / rule.timeout, 1.0))
            if self.interrupts is not None and self.interrupts.pause:
                raise Fault("not_settled", "stopped by hand before the run")
            if now - begun > rule.timeout:
                raise Fault(
                    "not_settled",
                    f"readings still scatter by {settling.deviation:.2g} N after {rule.timeout:g} s "
                    f"(threshold {rule.threshold:g} N)",
                )
        self.rest = settling.level
        if self.camera is not None:
            self._synchronise_camera(recorder)

    def _synchronise_camera(self, recorder: Recorder) -> None:
        until = self.board.time.now() + 0.5
        while self.board.time.now() < until:  # the last frames are still on their way
            self.board.service()
            self._take(recorder, self.board.take())
        on, off = ([1e-6 * us for us, lit in self._flashes if lit is which] for which in (True, False))
        fit = self.board.clock.fit()
        try:
            lit = lit_frames(np.array([f.thumbnail for f in self._sync]))
            times = np.array([fit.to_board(f.host_s) for f in self._sync])
            self.offset = combined(estimate_offset(times, lit, np.array(on), np.array(off)), self._calibrated())
        except Fault:
            self.offset = None  # the lamp is out of sight: the calibrated offset stands, and the stop record says so
        self._synchronised = True
        self._sync.clear()

    def _calibrated(self) -> CameraOffset | None:
        camera = self.setup.camera
        return CameraOffset(camera.offset, camera.sigma, 0) if camera is not None and camera.sigma > 0 else None

    def _take(self, recorder: Recorder, batch: list[Sample]) -> None:
        recorder.samples(batch)
        self.count += len(batch)
        for sample in batch:
            if isinstance(sample, LoadSample):
                self._load.append((sample.board_us, sample.counts))
            elif isinstance(sample, Event) and sample.code in (EventCode.FLASH_ON, EventCode.FLASH_OFF):
                self._flashes.append((sample.board_us, sample.code == EventCode.FLASH_ON))
        if self.camera is not None:
            frames = self.camera.take()
            recorder.frames(frames)
            if not self._synchronised:
                self._sync += frames
            self._watch_camera()
        if time.monotonic() - self._clocked_at > 1.0 and len(self.board.clock) > 3:
            self._clocked_at = time.monotonic()
            recorder.clock(self.board.clock.fit())
        recorder.flush_if_due()

    def _watch_camera(self) -> None:
        """A stalled camera does not end a run: motor and load cell are whole; the gap is written down."""
        assert self.camera is not None
        now = self.board.time.now()
        if self.camera.stalled and self._stalled_since is None:
            self._stalled_since = now
        elif not self.camera.stalled and self._stalled_since is not None:
            self.gaps.append((self._stalled_since, now))
            self._stalled_since = None

    def mean_thrust(self, end: PlayEnd) -> float:
        """Mean force over the waveform [N], less what the cell read at rest; NaN where the run is not complete."""
        if end.outcome != "complete":
            return float("nan")
        begin = end.start_us + 1e6 * self.motion.zero_index * self.motion.period
        last = end.start_us + 1e6 * self.motion.duration
        counts = [c for us, c in self._load if begin <= us < last]
        return float(self.setup.load_cell.to_newtons(np.mean(counts)) - self.rest) if counts else float("nan")

    def stop_record(self, end: PlayEnd) -> dict[str, Any]:
        board = self.board
        fit = board.clock.fit() if len(board.clock) else None
        gaps = self.gaps + ([(self._stalled_since, board.time.now())] if self._stalled_since is not None else [])
        return {
            "words": end.words,
            "start_us": end.start_us,
            "ended_utc": datetime.now(UTC).isoformat(timespec="milliseconds"),
            "counters": asdict(board.counters),
            "clock": asdict(fit) if fit else None,
            "camera": self._camera_record(gaps),
            "rest_n": self.rest,
        }

    def _camera_record(self, gaps: list[tuple[float, float]]) -> dict[str, Any] | None:
        if self.setup.camera is None:
            return None
        offset, sigma, source = self.setup.camera.offset, self.setup.camera.sigma, "calibrated"
        if self.offset is not None:
            offset, sigma, source = self.offset.offset, self.offset.sigma, "flashes of this run"
        return {"offset_s": offset, "offset_sigma_s": sigma, "offset_from": source, "gaps_host_s": gaps}


def _start_record(setup: RigSetup, board: Board, motion: Motion, name: str) -> dict[str, Any]:
    tables = setup_tables(setup)
    return {
        "name": name,
        "started_utc": datetime.now(UTC).isoformat(timespec="milliseconds"),
        "waveform": motion.description,
        "lead_s": motion.zero_index * motion.period,
        "duration_s": motion.duration,
        "period_s": motion.period,
        "board": asdict(board.boot) if board.boot else None,
        "rig": tables,
        "recording": tables["recording"],
        "load_cell": tables["load_cell"],
        "camera": tables.get("camera"),
    }


def _film(recorder: Recorder, path: Path, stop: dict[str, Any]) -> None:
    """The frames of the run as one video with true times, so that tracking can read it; the frames themselves stay."""
    if not stop["start_us"] or stop["camera"] is None:
        return
    recorder.flush()
    run = replace(read_run(path), stop=stop)
    with tempfile.TemporaryDirectory() as folder:
        video = Path(folder) / "video.mp4"
        try:
            write_video(run, video)
        except InputError:
            return  # a camera that gave nothing: its gap is in the stop record
        recorder.video(video)


def _neutral(board: Board) -> None:
    with suppress(Fault):  # a board that cannot be reached goes to neutral by its watchdog
        board.command(Type.NEUTRAL)


def _source(setup: RigSetup, host_time: HostTime) -> FrameSource:
    assert setup.camera is not None
    source = setup.camera.source
    if source.isdigit():
        return WebcamSource(int(source), host_time)
    if source == "emulated":
        declared = setup.recording.declaration.camera
        if declared is None:
            raise InputError("an emulated camera needs the declaration's camera", field="recording.camera")
        return EmulatedSource(Path(setup.port).parent / "truth", EmulatedOptics(declared), host_time)
    return FileSource(Path(source), host_time)

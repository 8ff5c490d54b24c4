"""Streams a run into an .rrd as it happens: a start record, samples appended, a stop record with how it ended.

Start without stop means that the host died: what was flushed up to then (every FLUSH_EVERY) is in the file.
Under /rig stands what the board said (rig/run_file.py reads it). Beside it the same file holds the recording as
tentacle.io.recording_rrd lays it out (/declaration, /motor, /load_cell), from the first sample on, so that every other
command takes the file as it is, crashed or not.
"""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr

from rig.camera import CameraFrame
from rig.clock import ClockFit
from rig.fault import Fault
from rig.live_feed import APPLICATION, BOARD_TIME, LiveFeed
from rig.protocol import NO_ANGLE, Event, EventCode, LoadSample, Sample, ServoSample
from tentacle.io.declaration_file import format_recording_file, parse_recording_file

FORMAT = "tentacle-rig-run"
VERSION = 1
START, STOP = "/rig/start", "/rig/stop"
LOAD, THRUST = "/rig/load_cell/counts", "/rig/load_cell/thrust"
COMMAND, ANGLE, CURRENT = "/rig/servo/command", "/rig/servo/angle", "/rig/servo/current"
EVENTS, CLOCK, CAMERA = "/rig/events", "/rig/clock", "/rig/camera"
HOST_TIME, SAMPLE = "host_time", "sample"
FLUSH_EVERY = 0.15  # s; so much and what is on its way is lost when the host is killed
FLUSH_WITHIN = 5.0  # s; a disk that takes longer is lost
LEAST_FREE = 64 * 2**20  # bytes; under this a run is ended while there is still room to end it properly


class Recorder:
    """Writes one run. `stop` must be called; a context manager that is left by an exception stops as "crashed"."""

    def __init__(
        self,
        path: Path,
        start: dict[str, Any],
        to_newtons: Callable[[Any], Any],
        *,
        viewer: str | None = None,
        free_bytes: Callable[[Path], int] | None = None,
    ) -> None:
        """start: what is known before (plain data); to_newtons: counts to N; viewer: url of a Rerun viewer to feed
        too.
        """
        self.path = path
        self._to_newtons = to_newtons
        self._free = free_bytes or (lambda where: shutil.disk_usage(where).free)
        self._flushed_at = time.monotonic()
        self._writer = ThreadPoolExecutor(1, "recorder")  # a slow disk must not keep the board waiting
        self._writing: Future[None] | None = None
        self._size = -1
        self._written_since = False
        self._stopped = False
        self._pending: list[Sample] = []
        path.parent.mkdir(parents=True, exist_ok=True)
        self._require_space()
        self._stream = rr.RecordingStream(APPLICATION, send_properties=True)
        self._stream.set_sinks(rr.FileSink(str(path)))
        self._live = None if viewer is None else LiveFeed(viewer)
        self._stream.set_log_time_enabled(False)
        self._stream.set_log_tick_enabled(False)
        self._declaration = parse_recording_file(start["recording"])
        self._name = str(start["name"])
        self._zero_us: int | None = None
        self._rows = {"motor": 0, "load_cell": 0}
        self._text(START, {"format": FORMAT, "version": VERSION, **start})
        self._declare("crashed")
        self.flush()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _trace: object) -> None:
        if not self._stopped:
            self.stop("crashed", {"words": f"{kind.__name__ if kind else 'no stop'}: {error}"})

    def samples(self, batch: Sequence[Sample]) -> None:
        """Appends samples, in order."""
        self._pending += batch
        self._written_since |= bool(batch)

    def _send(self, batch: Sequence[Sample]) -> None:
        loads = [s for s in batch if isinstance(s, LoadSample)]
        servos = [s for s in batch if isinstance(s, ServoSample)]
        if loads:
            counts = np.array([s.counts for s in loads], dtype=float)
            self._scalars(LOAD, loads, counts)
            thrust = np.asarray(self._to_newtons(counts), dtype=float)
            self._scalars(THRUST, loads, thrust)
            self._recording_rows("load_cell", loads, {"thrust": thrust})
        if servos:
            command = 1e-6 * np.array([s.command_urad for s in servos], dtype=float)
            angle = np.array([np.nan if s.angle_urad == NO_ANGLE else 1e-6 * s.angle_urad for s in servos])
            self._scalars(COMMAND, servos, command)
            self._scalars(ANGLE, servos, angle)
            self._recording_rows(
                "motor", servos, {"command": command, "angle": np.where(np.isnan(angle), command, angle)}
            )
            self._scalars(CURRENT, servos, 1e-3 * np.array([s.current_ma for s in servos], dtype=float))
        for event in (s for s in batch if isinstance(s, Event)):
            self._stream.set_time(BOARD_TIME, duration=np.timedelta64(1000 * event.board_us, "ns"))
            self._stream.set_time(SAMPLE, sequence=event.number)
            words = f"{EventCode(event.code).name} {event.value}"
            self._stream.log(EVENTS, rr.TextLog(words, level="INFO"))
            self._stream.reset_time()
            if self._live is not None:
                self._live.event(EVENTS, event.board_us, words)

    def begin(self, zero_us: int) -> None:
        """The waveform's time 0 is at board time zero_us [us]: samples from now on also go into the recording."""
        self._hand_over()
        self._zero_us = zero_us

    def frames(self, frames: Sequence[CameraFrame]) -> None:
        """Appends camera frames at their host time."""
        for frame in frames:
            self._stream.set_time(HOST_TIME, duration=np.timedelta64(round(1e9 * frame.host_s), "ns"))
            self._stream.log(CAMERA, rr.EncodedImage(contents=frame.jpeg, media_type="image/jpeg"))
            self._stream.reset_time()
        self._written_since |= bool(frames)
        if self._live is not None:
            self._live.frames(frames)

    def video(self, file: Path) -> None:
        """Puts a video of the run beside its signals, as tentacle.io.recording_rrd lays it out."""
        asset = rr.AssetVideo(path=file)
        self._stream.log("/camera/video", asset, rr.AnyValues(suffix=file.suffix), static=True)
        stamps = asset.read_frame_timestamps_nanos()
        references = rr.VideoFrameReference.columns_nanos(stamps)
        self._stream.send_columns("/camera/video", [rr.TimeColumn("time", duration=1e-9 * stamps)], references)

    def clock(self, fit: ClockFit) -> None:
        """Appends the clock's present fit: without it a crashed run could not place its frames."""
        self._stream.set_time(BOARD_TIME, duration=np.timedelta64(round(1e9 * fit.board_zero), "ns"))
        values = [fit.host_zero, fit.board_zero, fit.skew, fit.sigma, fit.round_trip]
        self._stream.log(CLOCK, rr.Scalars(values))
        self._stream.reset_time()
        if self._live is not None:
            self._live.clock(fit)

    def flush_if_due(self) -> None:
        """Call often; every FLUSH_EVERY it begins to write what was appended, and does not wait for it.

        Fault("disk") when the file does not take what was begun before.
        """
        now = time.monotonic()
        if now - self._flushed_at < FLUSH_EVERY:
            return
        if self._writing is not None:
            if self._writing.done():
                self._written()
            elif now - self._flushed_at < FLUSH_WITHIN:
                return
            else:
                raise Fault("disk", f"{self.path} was not written within {FLUSH_WITHIN:g} s")
        self._begin_to_write()

    def flush(self) -> None:
        """Writes everything appended so far, and waits for it. Fault("disk") when the file does not take it."""
        self._written()
        self._begin_to_write()
        self._written()

    def _hand_over(self) -> None:
        """What was appended, in one block: many small ones would make a large file."""
        batch, self._pending = self._pending, []
        self._send(batch)

    def _begin_to_write(self) -> None:
        self._hand_over()
        self._flushed_at = time.monotonic()
        grows, self._written_since = self._written_since, False
        self._writing = self._writer.submit(self._write, grows)

    def _written(self) -> None:
        """Waits for what is being written."""
        writing, self._writing = self._writing, None
        if writing is not None:
            writing.result()

    def _write(self, grows: bool) -> None:
        """In the writer's thread. grows: whether the file must be longer afterwards."""
        try:
            self._stream.flush(timeout_sec=FLUSH_WITHIN)
        except Exception as error:  # rerun raises its own, undocumented, kinds here
            raise Fault("disk", f"{self.path} cannot be written: {error}") from None
        size = self.path.stat().st_size if self.path.exists() else 0
        if grows and size <= self._size:
            raise Fault("disk", f"{self.path} does not grow: is the disk full?")
        self._size = size
        self._require_space()

    def stop(self, outcome: str, record: dict[str, Any]) -> None:
        """The stop record, and the end of the file. A full disk cannot make this fail: the run then reads as
        crashed.
        """
        self._stopped = True
        self._writer.shutdown()
        self._hand_over()
        if self._live is not None:
            self._live.close()
        self._text(STOP, {"outcome": outcome, **record})
        self._declare(outcome)
        counts = {name: count for name, count in self._rows.items() if count}
        if counts:
            self._stream.log("/rows", rr.AnyValues(signal=list(counts), count=list(counts.values())), static=True)
        try:
            self._stream.flush(timeout_sec=5.0)
        finally:
            self._stream.disconnect()

    def _require_space(self) -> None:
        free = self._free(self.path.parent)
        if free < LEAST_FREE:
            raise Fault(
                "disk", f"{free / 2**20:.0f} MB are free at {self.path.parent}; {LEAST_FREE // 2**20} MB are needed"
            )

    def _scalars(self, entity: str, samples: Sequence[Sample], values: Any) -> None:
        board = np.array([s.board_us for s in samples], dtype=np.int64) * 1000
        indexes = [
            rr.TimeColumn(BOARD_TIME, duration=board.astype("timedelta64[ns]")),
            rr.TimeColumn(SAMPLE, sequence=[s.number for s in samples]),
        ]
        columns = rr.Scalars.columns(scalars=values)
        self._stream.send_columns(entity, indexes=indexes, columns=columns)
        if self._live is not None:
            self._live.columns(entity, indexes, columns)

    def _recording_rows(self, name: str, samples: Sequence[Sample], columns: dict[str, Any]) -> None:
        """Rows of a signal in the layout of tentacle.io.recording_rrd; only from the waveform's time 0 on."""
        if self._zero_us is None:
            return
        t = 1e-6 * np.array([s.board_us - self._zero_us for s in samples], dtype=float)
        kept = t >= 0.0
        count = int(kept.sum())
        if not count:
            return
        first = self._rows[name]
        self._rows[name] = first + count
        index = [
            rr.TimeColumn("time", duration=t[kept]),
            rr.TimeColumn("row", sequence=np.arange(first, first + count)),
        ]
        self._stream.send_columns(f"/{name}", index, rr.AnyValues.columns(t_s=t[kept]))
        for column, values in columns.items():
            self._stream.send_columns(f"/{name}/{column}", index, rr.Scalars.columns(scalars=values[kept]))

    def _declare(self, outcome: str) -> None:
        notes = {**self._declaration.notes, "outcome": outcome}
        text = format_recording_file(replace(self._declaration, name=self._name, notes=notes))
        self._stream.log("/declaration", rr.TextDocument(text, media_type="text/plain"), static=True)

    def _text(self, entity: str, content: dict[str, Any]) -> None:
        self._stream.log(entity, rr.TextDocument(json.dumps(content), media_type="application/json"), static=True)

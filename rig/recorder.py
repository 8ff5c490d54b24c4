"""Streams a run into an .rrd as it happens: a start record, samples appended, a stop record with how it ended.

Start without stop means that the host died: what was flushed up to then (every FLUSH_EVERY) is in the file.
Under /rig stands what the board said (rig/run_file.py reads it). Beside it the same file holds the recording as
tentacle.io.recording_rrd lays it out (/declaration, /motor, /load_cell), from the first sample on, so that every other
command takes the file as it is, crashed or not. Every block has its checksum (tentacle.io.checksums).
"""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr

from rig import run_layout as layout
from rig.camera import CameraFrame
from rig.clock import ClockFit
from rig.disk_writer import DiskWriter
from rig.fault import Fault
from rig.live_feed import RIG_APPLICATION, LiveFeed
from rig.protocol import NO_ANGLE, BoardEvent, LoadSample, Sample, ServoSample
from rig.stop_file import release, reserve, write_stop
from rig.written_rows import WrittenRows
from tentacle.io.checksums import log_sums, log_text
from tentacle.io.declaration_file import format_recording_file, parse_recording_file
from tentacle.io.direct_file import way_to_disk
from tentacle.io.film_pieces import log_film
from tentacle.io.recording_from_rrd import PLANNED
from tentacle.io.rrd_chunks import just_written

FLUSH_EVERY = 0.15  # s; so much and what is on its way is lost when the host is killed
WRITE_WITHIN = 3.0  # s, for Rerun and for the disk: less than the writer's patience, so that their words are heard
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
        self.lead = float(start.get("lead_s", 0.0))  # s from the first set point to the waveform's time 0
        self.last_clock: ClockFit | None = None
        self._to_newtons = to_newtons
        self._free = free_bytes or (lambda where: shutil.disk_usage(where).free)
        self._flushed_at = time.monotonic()
        self._stopped = False
        self._pending: list[Sample] = []
        self._queue: list[Callable[[], None]] = []
        self._rows = WrittenRows()
        self._pending_frames: list[CameraFrame] = []
        path.parent.mkdir(parents=True, exist_ok=True)
        self._require_space()
        try:
            reserve(path)
            self._disk = way_to_disk(path)
        except OSError as error:
            raise Fault("disk", f"{path} cannot be written: {error.strerror}") from None
        self._stream = rr.RecordingStream(RIG_APPLICATION, send_properties=True)
        self._stream.set_sinks(rr.FileSink(self._disk.entrance))
        self._disk.opened()
        self._live = None if viewer is None else LiveFeed(viewer)
        self._stream.set_log_time_enabled(False)
        self._stream.set_log_tick_enabled(False)
        self._writer = DiskWriter(path)
        self._declaration = parse_recording_file(start["recording"])
        self._name = str(start["name"])
        self._zero_us: int | None = None
        self._text(layout.START, {"format": layout.RUN_FORMAT, "version": layout.VERSION, **start})
        if "duration_s" in start:
            seconds = repr(float(start["duration_s"]))
            self._queue.append(partial(log_text, self._stream, PLANNED, seconds, "text/plain"))
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

    def begin(self, zero_us: int) -> None:
        """The waveform's time 0 is at board time zero_us [us]: samples from now on also go into the recording."""
        self._hand_over()
        self._zero_us = zero_us

    def frames(self, frames: Sequence[CameraFrame]) -> None:
        """Appends camera frames at their host time."""
        self._pending_frames += frames
        self._rows.count(layout.CAMERA, len(frames))
        if self._live is not None:
            self._live.frames(frames)

    def video(self, file: Path) -> None:
        """Puts a video of the run beside its signals, as tentacle.io.recording_rrd lays it out."""
        self._rows.count("camera", 1)
        log_film(self._stream, file)

    def clock(self, fit: ClockFit) -> None:
        """Appends the clock's present fit: without it a crashed run could not place its frames."""
        self.last_clock = fit
        self._rows.count(layout.CLOCK, 1)
        index, columns = layout.clock_rows(fit)
        self._queue.append(partial(self._stream.send_columns, layout.CLOCK, index, columns))
        if self._live is not None:
            self._live.clock(fit)

    def flush_if_due(self) -> None:
        """Call often; every FLUSH_EVERY it begins to write what was appended, and does not wait for it.

        Fault("disk") when the file does not take what was begun before.
        """
        now = time.monotonic()
        if now - self._flushed_at >= FLUSH_EVERY and self._begin_to_write():
            self._flushed_at = now

    def flush(self) -> None:
        """Writes everything appended so far, and waits for it. Fault("disk") when the file does not take it."""
        self._writer.wait()
        self._begin_to_write()
        self._writer.wait()

    def stop(self, outcome: str, record: dict[str, Any]) -> None:
        """The stop record, and the end of the file.

        A disk that takes nothing more cannot make this fail: the record then goes into a file beside the run's.
        """
        self._stopped = True
        if self._live is not None:
            self._live.close()
        self._hand_over()
        self._text(layout.STOP, {"outcome": outcome, "rows": self._rows.ends, **record})
        self._declare(outcome)
        counts = {name: rows for name, rows in self._rows.ends.items() if not name.startswith("/rig/")}
        if counts:
            rows = rr.AnyValues(signal=list(counts), count=list(counts.values()))
            self._queue.append(partial(self._stream.log, "/rows", rows, static=True))
        try:
            if outcome == "disk":
                raise Fault("disk", "")
            self.flush()
            self._end_file()
            release(self.path)
            just_written(self.path)
        except Fault:
            write_stop(self.path, {"outcome": outcome if outcome != "complete" else "disk", **record})
            if outcome == "disk":
                self._last_try()
            self._disk.abandon()
        self._writer.close(self._stream.disconnect)

    def _last_try(self) -> None:
        """After a disk fault: what may still go into the file, if it does at once."""
        try:
            self.flush()
            self._end_file()
        except Fault:
            return  # the stop document lies beside the file

    def _end_file(self) -> None:
        """Closes the file. Fault("disk") when it does not take its end."""

        def end() -> None:
            self._stream.disconnect()
            self._disk.finish()

        self._writer.begin(end)
        self._writer.wait()

    def _begin_to_write(self) -> bool:
        """Hands what is queued to the writer, unless that is still busy."""
        self._hand_over()
        jobs = self._queue
        if not self._writer.begin(partial(self._write, jobs)):
            return False
        self._queue = []
        return True

    def _write(self, jobs: Sequence[Callable[[], None]]) -> None:
        """In the writer's thread."""
        for job in jobs:
            job()
        self._stream.flush(timeout_sec=WRITE_WITHIN)
        self._disk.settle(WRITE_WITHIN)
        self._require_space()

    def _hand_over(self) -> None:
        """What was appended, in one block: many small ones would make a large file."""
        batch, self._pending = self._pending, []
        loads = [s for s in batch if isinstance(s, LoadSample)]
        servos = [s for s in batch if isinstance(s, ServoSample)]
        if loads:
            counts = np.array([s.counts for s in loads], dtype=float)
            self._scalars(layout.LOAD, loads, counts)
            thrust = np.asarray(self._to_newtons(counts), dtype=float)
            self._scalars(layout.THRUST, loads, thrust)
            self._recording_rows("load_cell", loads, {"thrust": thrust})
        if servos:
            command = 1e-6 * np.array([s.command_urad for s in servos], dtype=float)
            angle = np.array([np.nan if s.angle_urad == NO_ANGLE else 1e-6 * s.angle_urad for s in servos])
            self._scalars(layout.COMMAND, servos, command)
            self._scalars(layout.ANGLE, servos, angle)
            self._recording_rows(
                "motor", servos, {"command": command, "angle": np.where(np.isnan(angle), command, angle)}
            )
            self._scalars(layout.CURRENT, servos, 1e-3 * np.array([s.current_ma for s in servos], dtype=float))
        for event in (s for s in batch if isinstance(s, BoardEvent)):
            self._event(event)
        frames, self._pending_frames = self._pending_frames, []
        if frames:
            index, columns = layout.frame_rows(frames)
            self._queue.append(partial(self._stream.send_columns, layout.CAMERA, index, columns))
        sums, block = self._rows.take()
        if sums:
            self._queue.append(partial(log_sums, self._stream, sums, block))

    def _event(self, event: BoardEvent) -> None:
        self._rows.count(layout.EVENTS, 1)
        words, index, columns = layout.event_rows(event)
        self._queue.append(partial(self._stream.send_columns, layout.EVENTS, index, columns))
        if self._live is not None:
            self._live.event(layout.EVENTS, event.board_us, words)

    def _require_space(self) -> None:
        free = self._free(self.path.parent)
        if free < LEAST_FREE:
            raise Fault(
                "disk", f"{free / 2**20:.0f} MB are free at {self.path.parent}; {LEAST_FREE // 2**20} MB are needed"
            )

    def _scalars(self, entity: str, samples: Sequence[Sample], values: Any) -> None:
        board, number, indexes = layout.sample_index(samples)
        columns = rr.Scalars.columns(scalars=values)
        self._queue.append(partial(self._stream.send_columns, entity, indexes, columns))
        self._rows.sum(entity, {"board_ns": board, "sample": number, "value": values})
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
        first = self._rows.sum(name, {"t_s": t[kept], **{column: values[kept] for column, values in columns.items()}})
        index = [
            rr.TimeColumn("time", duration=t[kept]),
            rr.TimeColumn("row", sequence=np.arange(first, first + count)),
        ]
        self._queue.append(partial(self._stream.send_columns, f"/{name}", index, rr.AnyValues.columns(t_s=t[kept])))
        for column, values in columns.items():
            scalars = rr.Scalars.columns(scalars=values[kept])
            self._queue.append(partial(self._stream.send_columns, f"/{name}/{column}", index, scalars))

    def _declare(self, outcome: str) -> None:
        notes = {**self._declaration.notes, "outcome": outcome}
        text = format_recording_file(replace(self._declaration, name=self._name, notes=notes))
        self._queue.append(partial(log_text, self._stream, "/declaration", text, "text/plain"))

    def _text(self, entity: str, content: dict[str, Any]) -> None:
        self._queue.append(partial(log_text, self._stream, entity, json.dumps(content), "application/json"))

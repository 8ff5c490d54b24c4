"""Reads a run back from its .rrd, whole or cut off: what was sampled, and what tentacle makes of it as a recording."""

from __future__ import annotations

import json
import warnings
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from rig import recorder
from rig.clock import ClockFit
from rig.protocol import EventCode
from rig.stills import encode_video
from tentacle.errors import InputError
from tentacle.io.declaration_file import parse_recording_file
from tentacle.recording import Recording
from tentacle.signals import Array, LoadCellSignal, MotorSignal, Video


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
    frame_host_t (F,) [s] of arrival with frames as JPEG; clocks in the order in which they were fitted. stop is None
    where the host died.
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
    frames: tuple[bytes, ...]
    clocks: tuple[ClockFit, ...]

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


def read_run(path: Path) -> Run:
    """The run in an .rrd. InputError where the file is missing, no .rrd, or none of a rig; a cut end is no error."""
    columns = _read_columns(path)
    start = _document(columns, recorder.START, path)
    if start is None or start.get("format") != recorder.FORMAT:
        raise InputError("holds no start record", file=path, expected="a run that `tentacle rig record` wrote")
    if start.get("version") != recorder.VERSION:
        raise InputError(f"is of version {start.get('version')}", file=path, expected=f"version {recorder.VERSION}")
    load_t, load_number, load = _series(columns, recorder.LOAD)
    servo_t, servo_number, command = _series(columns, recorder.COMMAND)
    frames = sorted(columns.get(recorder.CAMERA, []), key=lambda row: row[recorder.HOST_TIME])
    events = sorted(columns.get(recorder.EVENTS, []), key=lambda row: row[recorder.SAMPLE])
    clocks = [ClockFit(*row["Scalars:scalars"]) for row in columns.get(recorder.CLOCK, [])]
    return Run(
        path=path,
        start=start,
        stop=_document(columns, recorder.STOP, path),
        load_t=load_t,
        load_number=load_number,
        load=load,
        servo_t=servo_t,
        servo_number=servo_number,
        command=command,
        angle=_series(columns, recorder.ANGLE)[2],
        current=_series(columns, recorder.CURRENT)[2],
        events=tuple(_event(row) for row in events),
        frame_host_t=np.array([1e-9 * row[recorder.HOST_TIME] for row in frames]),
        frames=tuple(bytes(np.asarray(row["EncodedImage:blob"][0], dtype=np.uint8)) for row in frames),
        clocks=tuple(clocks),
    )


def to_recording(run: Run, *, video: Path | None = None) -> Recording:
    """The run as every other command takes it, time 0 where the waveform began.

    video: where to write the frames (an .mp4, one time stamp a frame); without it the recording has no video.
    InputError where nothing was sampled.
    """
    if not len(run.load_t) and not len(run.servo_t):
        raise InputError("holds no sample", file=run.path, expected="a run that got as far as its first sample")
    declared = parse_recording_file(run.start["recording"])
    calibration = run.start["load_cell"]
    measured = np.isfinite(run.angle)
    motor = MotorSignal(run.servo_t - run.zero, run.command, np.where(measured, run.angle, run.command))
    thrust = (run.load - calibration["offset_counts"]) / calibration["counts_per_newton"]
    filmed = None
    if video is not None and run.frames:
        write_video(run, video)
        filmed = Video(video)
    notes = {"outcome": run.outcome, "source": run.path.name, "angle": "measured" if measured.any() else "commanded"}
    return Recording(
        name=str(run.start.get("name", run.path.stem)),
        declaration=replace(declared.declaration, motor_mode="prescribed"),
        motor=motor if len(run.servo_t) else None,
        load_cell=LoadCellSignal(run.load_t - run.zero, thrust) if len(run.load_t) else None,
        video=filmed,
        notes={**declared.notes, **notes},
    )


def frame_times(run: Run) -> Array:
    """Time (F,) [s] of the middle of each frame's exposure, zero where the waveform began.

    InputError where the run holds no clock.
    """
    if not run.clocks:
        raise InputError("holds no clock fit", file=run.path, expected="a run that lasted a second")
    camera = (run.stop or {}).get("camera") or run.start.get("camera") or {}
    fit = run.clocks[-1]
    host = run.frame_host_t - float(camera.get("offset_s", 0.0))
    return np.array([fit.to_board(t) for t in host]) - run.zero


def write_video(run: Run, path: Path) -> None:
    """The frames as H.264, each with its own time stamp; frames from before the waveform's time 0 are left out."""
    times = frame_times(run)
    kept = times >= 0
    if not kept.any():
        raise InputError("no frame was taken during the run", file=run.path)
    encode_video(times[kept], [data for data, keep in zip(run.frames, kept, strict=True) if keep], path)


def _read_columns(path: Path) -> dict[str, list[dict[str, Any]]]:
    """Every entity's rows: times as whole nanoseconds or numbers, components as lists."""
    if not path.is_file():
        raise InputError("no such file", file=path, expected="an .rrd")
    rows: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for chunk in _chunks(path):
        if chunk.entity_path.startswith("/rig/"):
            rows[chunk.entity_path] += _rows(chunk.to_record_batch())
    return rows


def _chunks(path: Path) -> Iterator[Any]:
    """The file's chunks up to its end, or up to where it was cut."""
    from rerun.chunk import RrdReader

    count = 0
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it warns of a file that was not closed; run.outcome says so too
            for count, chunk in enumerate(RrdReader(str(path)).stream(), start=1):  # noqa: B007 (counted for the except)
                yield chunk
    except Exception as error:  # the reader's own kinds: a message that was cut in the middle
        if count == 0:
            raise InputError(f"cannot be read: {error}", file=path, expected="an .rrd") from None


def _rows(batch: Any) -> list[dict[str, Any]]:
    columns = {name: batch.column(k) for k, name in enumerate(batch.schema.names) if name != "rerun.controls.RowId"}
    values = {}
    for name, column in columns.items():
        if str(column.type).startswith(("duration", "timestamp")):
            values[name] = column.cast("int64").to_pylist()
        else:
            values[name] = column.to_pylist()
    return [dict(zip(values, row, strict=True)) for row in zip(*values.values(), strict=True)]


def _document(columns: dict[str, list[dict[str, Any]]], entity: str, path: Path) -> dict[str, Any] | None:
    rows = columns.get(entity)
    if not rows:
        return None
    try:
        return json.loads(rows[-1]["TextDocument:text"][0])
    except (ValueError, KeyError, TypeError, IndexError):
        raise InputError("is not JSON", file=path, field=entity) from None


def _series(columns: dict[str, list[dict[str, Any]]], entity: str) -> tuple[Array, Array, Array]:
    rows = sorted(columns.get(entity, []), key=lambda row: row[recorder.SAMPLE])
    time = np.array([1e-9 * row[recorder.BOARD_TIME] for row in rows], dtype=float)
    number = np.array([row[recorder.SAMPLE] for row in rows], dtype=float)
    return time, number, np.array([row["Scalars:scalars"][0] for row in rows], dtype=float)


def _event(row: dict[str, Any]) -> RunEvent:
    name, value = row["TextLog:text"][0].split()
    return RunEvent(1e-9 * row[recorder.BOARD_TIME], EventCode[name], int(value))

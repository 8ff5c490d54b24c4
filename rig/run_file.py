"""Reads a run back from its .rrd, whole or cut off: what was sampled, and what tentacle makes of it as a recording."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from rig import run_layout as layout
from rig.clock import ClockFit
from rig.frame_times import steadied
from rig.protocol import EventCode
from rig.run import Run, RunEvent
from rig.stills import write_film
from rig.stop_file import read_stop
from tentacle.errors import InputError
from tentacle.io.checksums import CHECKSUM_ENTITY as SUMS
from tentacle.io.checksums import Sum, columns_digest, covered, first_unsound, frame_digest, read_sums, sound_text
from tentacle.io.declaration_file import parse_recording_file
from tentacle.io.recording_from_rrd import DAMAGE
from tentacle.io.rrd_chunks import Chunk, bytes_lost, read_chunks
from tentacle.io.rrd_columns import EntityColumns, add, whole_numbers
from tentacle.recording import Recording
from tentacle.signals import Array, LoadCellSignal, MotorSignal, Video


def read_run(path: Path) -> Run:
    """The run in an .rrd, whole or up to where it was cut off (Run.missing).

    InputError where the file is missing, no .rrd, none of a rig, or where something disagrees with its checksum.
    """
    try:
        return _run_of(*_read_columns(path), path)
    except InputError:
        raise
    except DAMAGE as error:
        raise InputError(f"damaged: {error}", file=path, expected="a run that `tentacle rig record` wrote") from None


def _run_of(columns: dict[str, EntityColumns], frame_t: Array, bytes_gone: int, path: Path) -> Run:
    start = _document(columns, layout.START, path)
    if start is None or start.get("format") != layout.RUN_FORMAT:
        raise InputError("holds no start record", file=path, expected="a run that `tentacle rig record` wrote")
    if start.get("version") != layout.VERSION:
        raise InputError(f"is of version {start.get('version')}", file=path, expected=f"version {layout.VERSION}")
    sums = read_sums(columns.get(SUMS))
    load_t, load_number, load = _series(columns, layout.LOAD, sums, path)
    servo_t, servo_number, command = _series(columns, layout.COMMAND, sums, path)
    angle, current = (_series(columns, entity, sums, path)[2] for entity in (layout.ANGLE, layout.CURRENT))
    count = min(map(len, (command, angle, current)))  # a cut can fall between the entities of one block
    in_file = _document(columns, layout.STOP, path)
    stop = in_file if in_file is not None else read_stop(path)
    _series(columns, layout.THRUST, sums, path)  # it is there to be looked at; what is looked at must be sound too
    held = {**_rows(columns, sums), layout.CAMERA: len(frame_t)}
    short = "" if in_file is None or bytes_gone else _require_every_row(in_file, held, path)
    run = Run(
        path=path,
        start=start,
        stop=stop,
        load_t=load_t,
        load_number=load_number,
        load=load,
        servo_t=servo_t[:count],
        servo_number=servo_number[:count],
        command=command[:count],
        angle=angle[:count],
        current=current[:count],
        events=_events(columns.get(layout.EVENTS), path),
        frame_host_t=frame_t,
        clocks=_clocks(columns.get(layout.CLOCK), path),
    )
    whole = in_file is not None and not bytes_gone
    return replace(run, missing=short if whole else _missing(run, bytes_gone))


def _rows(columns: dict[str, EntityColumns], sums: list[Sum]) -> dict[str, int]:
    """How many rows of each entity are there with a checksum: one of their own, or one of their block."""
    counted = {
        entity: found
        for entity, found in columns.items()
        if entity.startswith("/rig/") and entity not in (layout.START, layout.STOP)
    }
    return {
        entity: min(len(found.times(layout.BOARD_TIME)), len(found.texts("sha256")) or covered(sums, entity))
        for entity, found in counted.items()
    }


def _require_every_row(stop: dict[str, Any], held: dict[str, int], path: Path) -> str:
    """Compares the rows held with those that the stop record states: a damaged block can vanish whole.

    InputError where some are missing. A disk that was full may have taken less: a line then says so, else "".
    """
    stated = stop.get("rows") or {
        layout.CAMERA: stop.get("frames", held[layout.CAMERA])
    }  # older runs count frames only
    for entity, count in stated.items():
        if entity.startswith("/rig/") and (found := held.get(entity, 0)) != count:
            if stop["outcome"] == "disk":
                return f"the full disk took {found} of {count} rows of {entity}"
            raise InputError(f"damaged: holds {found} of {count} rows", file=path, field=entity)
    return ""


def _missing(run: Run, bytes_gone: int) -> str:
    """One line on what a cut took, in seconds."""
    ends = [float(t[-1]) for t in (run.load_t, run.servo_t) if len(t)]
    planned = run.start.get("duration_s")
    reached = max(ends, default=run.zero) - run.zero
    torn = f", its last {bytes_gone} bytes are no whole message" if bytes_gone else ""
    if not isinstance(planned, int | float):
        return f"the file is cut off{torn}; it reaches to {reached:.2f} s, its length is unknown"
    left = max(float(planned) - reached, 0.0)
    return f"the file is cut off{torn}; it reaches to {reached:.2f} s, {left:.2f} of {float(planned):.2f} s are missing"


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
    if video is not None and len(run.frame_host_t) and run.clocks:
        write_run_video(run, video)
        filmed = Video(video)
    notes = {"outcome": run.outcome, "source": run.path.name, "angle": "measured" if measured.any() else "commanded"}
    if run.missing:
        notes["cut_off"] = run.missing
    return Recording(
        name=str(run.start.get("name", run.path.stem)),
        declaration=replace(declared.declaration, motor_mode="prescribed"),
        motor=motor if len(run.servo_t) else None,
        load_cell=LoadCellSignal(run.load_t - run.zero, thrust) if len(run.load_t) else None,
        video=filmed,
        notes={**declared.notes, **notes},
    )


def write_run_video(run: Run, path: Path) -> None:
    """The frames as one film, each with its own time stamp; frames from before the waveform's time 0 are left out.

    InputError where the run holds no clock, or no frame.
    """
    if not run.clocks:
        raise InputError("holds no clock fit", file=run.path, expected="a run that lasted a second")
    camera = (run.stop or {}).get("camera") or run.start.get("camera") or {}
    write_run_film(run.path, path, run.clocks[-1], float(camera.get("offset_s", 0.0)), run.zero)


def write_run_film(run: Path, path: Path, clock: ClockFit, offset: float, zero: float) -> None:
    """A run's frames as one film (rig.stills); offset [s] by which they came late, zero: board time [s] of time 0.

    Their times are on the camera's own rhythm where it has one (rig.frame_times).
    """
    taken = steadied(_arrivals(run)) - offset
    stills = (
        (clock.to_board(float(host_s)) - zero, jpeg)
        for host_s, (_, jpeg) in zip(taken, iterate_frames(run), strict=True)
    )
    if not write_film(((t, jpeg) for t, jpeg in stills if t >= 0.0), path):
        raise InputError("no frame was taken during the run", file=run)


def _arrivals(run: Path) -> Array:
    """Host times (F,) [s] of the frames' arrival, in the file's order."""
    found = [np.empty(0)]
    for chunk in read_chunks(run):
        if chunk.entity == layout.CAMERA and not chunk.static:
            found.append(np.asarray(1e-9 * whole_numbers(chunk.batch.column(layout.HOST_TIME)), dtype=float))
    return np.concatenate(found)


def iterate_frames(run: Path) -> Iterator[tuple[float, bytes]]:
    """Host time [s] of arrival and JPEG of each frame, in the file's order. InputError where one is damaged."""
    for chunk in read_chunks(run):
        if chunk.entity != layout.CAMERA or chunk.static:
            continue
        try:
            times, blobs, sums = _frames_of(chunk)
        except DAMAGE as error:
            raise InputError(f"damaged: {error}", file=run, field="camera") from None
        for k, (host_ns, jpeg) in enumerate(zip(times, blobs, strict=True)):
            # an older run has a checksum of the picture alone
            if sums and sums[k] not in (frame_digest(host_ns, jpeg), hashlib.sha256(jpeg).hexdigest()):
                raise InputError(f"damaged: the frame at {1e-9 * host_ns:.3f} s", file=run, field="camera")
            yield 1e-9 * host_ns, jpeg


def _frames_of(chunk: Chunk) -> tuple[list[int], list[bytes], list[str]]:
    """Host times [ns], JPEGs and checksums of a chunk's frames; an exception of DAMAGE where they do not fit."""
    rows = EntityColumns()
    add(rows, chunk.batch, static=False)
    times, blobs, sums = rows.times(layout.HOST_TIME), rows.row_bytes("EncodedImage:blob"), rows.texts("sha256")
    if len(times) != len(blobs) or (sums and len(sums) != len(blobs)):
        raise ValueError(f"{len(times)} times, {len(blobs)} pictures and {len(sums)} checksums in one block")
    return times.tolist(), blobs, sums


def _read_columns(path: Path) -> tuple[dict[str, EntityColumns], Array, int]:
    """Every entity of the rig but its pictures; the frames' host times (F,) [s]; bytes at the end that are torn."""
    if not path.is_file():
        raise InputError("no such file", file=path, expected="an .rrd")
    columns: dict[str, EntityColumns] = {}
    frames: list[Array] = [np.empty(0)]
    for chunk in read_chunks(path):
        if chunk.entity == layout.CAMERA:
            frames.append(np.asarray(1e-9 * whole_numbers(chunk.batch.column(layout.HOST_TIME)), dtype=float))
        elif chunk.entity.startswith("/rig/") or chunk.entity == SUMS:
            add(columns.setdefault(chunk.entity, EntityColumns()), chunk.batch, static=chunk.static)
    return columns, np.sort(np.concatenate(frames)), bytes_lost(path)


def _document(columns: dict[str, EntityColumns], entity: str, path: Path) -> dict[str, Any] | None:
    found = columns.get(entity)
    if found is None or not found.has_static("TextDocument:text"):
        return None
    text = sound_text(found)
    try:
        document = None if text is None else json.loads(text)
    except (ValueError, RecursionError):
        document = None
    if not isinstance(document, dict):
        raise InputError("damaged: does not agree with its checksum, or is no JSON", file=path, field=entity)
    return document


def _series(columns: dict[str, EntityColumns], entity: str, sums: list[Sum], path: Path) -> tuple[Array, Array, Array]:
    """Times [s], sample numbers and values (N,), as far as they are covered by checksums; in order of numbers."""
    found = columns.get(entity)
    if found is None:
        return np.empty(0), np.empty(0), np.empty(0)
    table = {
        "board_ns": found.times(layout.BOARD_TIME),
        "sample": found.times(layout.SAMPLE),
        "value": found.flat("Scalars:scalars"),
    }
    if sums:
        count = covered(sums, entity)
        table = {name: values[:count] for name, values in table.items()}
        unsound = first_unsound(sums, entity, table)
        if unsound is not None:
            seconds = 1e-9 * table["board_ns"][unsound.first]
            raise InputError(f"damaged: from {seconds:.3f} s on the board's clock", file=path, field=entity)
    order = np.argsort(table["sample"], kind="stable")
    return 1e-9 * table["board_ns"][order], table["sample"][order].astype(float), table["value"][order]


def _events(columns: EntityColumns | None, path: Path) -> tuple[RunEvent, ...]:
    if columns is None:
        return ()
    times, sums = columns.times(layout.BOARD_TIME), columns.texts("sha256")
    events = []
    for k, words in enumerate(columns.texts("TextLog:text")):
        if sums and columns_digest({"event": [words], "board_us": times[k : k + 1] // 1000}) != sums[k]:
            raise InputError(f"damaged: event {k + 1}", file=path, field=layout.EVENTS)
        name, value = words.split()
        if name in EventCode.__members__:  # a newer board's own events mean nothing to this program
            events.append(RunEvent(1e-9 * float(times[k]), EventCode[name], int(value)))
    return tuple(events)


def _clocks(columns: EntityColumns | None, path: Path) -> tuple[ClockFit, ...]:
    if columns is None:
        return ()
    values, sums = columns.rows("Scalars:scalars"), columns.texts("sha256")
    for k, sha256 in enumerate(sums):
        if columns_digest({"fit": values[k : k + 1]}) != sha256:
            raise InputError(f"damaged: clock fit {k + 1}", file=path, field=layout.CLOCK)
    return tuple(ClockFit(*row) for row in values.tolist())

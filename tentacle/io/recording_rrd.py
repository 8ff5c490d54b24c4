"""A recording as one complete .rrd file: reading it gives back the recording that was written.

| entity | what is there (columns by name; rows on the timelines `time` [s] and `row`) |
|---|---|
| /declaration | static TextDocument: recording.toml, markers' (s, d), sensors, name, notes included; format |
| /rows | static: signal, count of rows (camera: frames, 1 for a video file), start_s, stop_s: to know a cut |
| /planned | static text, where it is written as it is measured: the seconds that it is to last |
| /sums | a checksum of each block of each signal (tentacle.io.checksums) |
| /motor | t_s; /motor/command and /motor/angle: Scalars [rad] |
| /travel | t_s, x_m, y_m of a base that travels |
| /load_cell | t_s; /load_cell/thrust: Scalars [N] |
| /midline | t_s, x_m, y_m, sigma_m (P each); static s (P) |
| /markers | t_s, x_m, y_m (M each) |
| /strain | t_s, Scalars (G: one a gauge) |
| /acceleration | t_s, Scalars (A: one an axis of an accelerometer) |
| /shape | t_s, coefficients (K), covariance (K K), accepted, reason; static scale, scale_sigma, base_shift (2) |
| | and, as each frame tells by itself, frames_coefficients (N), frames_covariance (N N) |
| /camera/video | a video file: static AssetVideo with its own bytes, suffix, sha256; VideoFrameReference rows |
| /camera/film | a video file over LARGE_VIDEO: its bytes in pieces, one a row; static suffix |
| /camera/frames | numbered PNG frames: EncodedImage rows with their own bytes |

`time` is rounded to whole nanoseconds by Rerun, so the exact times are in t_s. Signals are written in the order of time
and before the video: a file that was cut off (a full disk, a killed recorder) is recovered up to the cut, and says so
in notes["cut_off"]. Reading: tentacle.io.recording_from_rrd.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.io.checksums import Sum, columns_digest, log_sums, log_text
from tentacle.io.declaration_file import format_recording_file
from tentacle.io.film_pieces import LARGE_VIDEO, log_film
from tentacle.io.recording_from_rrd import read_rrd
from tentacle.io.rrd_chunks import has_header, just_written
from tentacle.io.rrd_stream import new_stream, saved
from tentacle.io.video_file import frame_files, frame_stamps
from tentacle.io.write_folder import describe
from tentacle.io.written_file import written_file
from tentacle.recording import Recording

__all__ = ["log_recording", "read_rrd", "require_replaceable", "write_rrd"]

MEDIA_TYPES = {
    ".mp4": "video/mp4",
    ".mkv": "video/x-matroska",
    ".avi": "video/x-msvideo",
    ".mov": "video/quicktime",
    ".webm": "video/webm",
    ".gif": "image/gif",
}
SECONDS_PER_BLOCK = 1.0  # a cut costs at most this much, and the whole video


def write_rrd(recording: Recording, file: Path) -> None:
    """Write a recording; the file appears whole or not at all.

    InputError where its folder is missing, or where the file is there and is no .rrd: that would be lost.
    """
    file = Path(file)
    if not file.parent.is_dir():
        raise InputError("no such folder", file=file.parent)
    require_replaceable(file)
    with written_file(file) as partial:
        stream = new_stream(_identity(recording))
        with saved(stream, partial):
            log_recording(recording, stream)
    just_written(file)


def require_replaceable(file: Path) -> None:
    """InputError where the file is there and is no .rrd."""
    if file.is_file() and file.stat().st_size and not has_header(file):
        raise InputError("is there, and is no .rrd", file=file, expected="a name that is free, or an .rrd to replace")


def _identity(recording: Recording) -> str:
    """The same for the same declaration and signals: the viewer takes two files of one identity as one recording."""
    digest = hashlib.sha256(format_recording_file(describe(recording)).encode())
    for columns in signal_rows(recording).values():
        for values in columns.values():
            digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()[:32]


def log_recording(recording: Recording, stream: rr.RecordingStream) -> None:
    """Log a recording to an open stream, so that other things can stand beside it in the same file."""
    signals = signal_rows(recording)
    declaration = format_recording_file(describe(recording))
    stream.send_recording_name(recording.name)
    log_text(stream, "declaration", declaration, "text/plain")
    counts = {name: len(next(iter(columns.values()))) for name, columns in signals.items()}
    if recording.video is not None:
        counts["camera"] = len(frame_files(recording.video.path)) if recording.video.path.is_dir() else 1
    if counts:
        ends = [
            signals[name]["t_s"][[0, -1]].tolist() if counts[name] and name in signals else [0.0, 0.0]
            for name in counts
        ]
        starts, stops = [start for start, _ in ends], [stop for _, stop in ends]
        rows = rr.AnyValues(signal=list(counts), count=list(counts.values()), start_s=starts, stop_s=stops)
        stream.log("rows", rows, static=True)
    sums = [Sum(name, 0, 0, columns_digest(columns)) for name, columns in once(recording).items()]
    if sums:
        log_sums(stream, sums)
    _log_statics(recording, stream)
    stream.flush()  # single logs travel in a batch of their own: the declaration is to come first in the file
    for number, blocks in _blocks(signals):
        block_sums = []
        for name, rows in blocks:
            _send(stream, name, signals[name], rows)
            part = {column: values[rows] for column, values in signals[name].items()}
            block_sums.append(Sum(name, rows.start, rows.stop - rows.start, columns_digest(part)))
        log_sums(stream, block_sums, number)
    if recording.video is not None:
        _log_video(recording, stream)


def once(recording: Recording) -> dict[str, dict[str, NDArray[Any]]]:
    """The static data of a recording as columns: the midline's points, the shape's scale."""
    found = {}
    if recording.midline is not None:
        found["midline"] = {"s": recording.midline.s}
    if recording.shape is not None:
        shape = recording.shape
        sizes = np.array([shape.scale, shape.scale_sigma])
        found["shape"] = {"sizes": sizes, "base_shift": shape.base_shift}
    return found


def signal_rows(recording: Recording) -> dict[str, dict[str, NDArray[Any]]]:
    """Signal -> column -> (rows, ...), the first column the times."""
    signals: dict[str, dict[str, NDArray[Any]]] = {}
    motor, load_cell, midline = recording.motor, recording.load_cell, recording.midline
    markers, strain, acceleration = recording.markers, recording.strain, recording.acceleration
    shape = recording.shape
    if motor is not None:
        signals["motor"] = {"t_s": motor.t, "command": motor.command, "angle": motor.angle}
    if recording.travel is not None:
        xy = recording.travel.xy
        signals["travel"] = {"t_s": recording.travel.t, "x_m": xy[:, :1], "y_m": xy[:, 1:]}
    if load_cell is not None:
        signals["load_cell"] = {"t_s": load_cell.t, "thrust": load_cell.thrust}
    if midline is not None:
        x, y = midline.xy[..., 0], midline.xy[..., 1]
        signals["midline"] = {"t_s": midline.t, "x_m": x, "y_m": y, "sigma_m": midline.sigma}
    if markers is not None:
        signals["markers"] = {"t_s": markers.t, "x_m": markers.xy[..., 0], "y_m": markers.xy[..., 1]}
    if strain is not None:
        signals["strain"] = {"t_s": strain.t, "strain": strain.values}
    if acceleration is not None:
        signals["acceleration"] = {"t_s": acceleration.t, "acceleration": acceleration.values}
    if shape is not None:
        covariance = shape.covariance.reshape(len(shape.t), -1)
        signals["shape"] = {
            "t_s": shape.t,
            "coefficients": shape.coefficients,
            "covariance": covariance,
            "accepted": shape.accepted,
            "reason": np.array(shape.reason),
        }
        if shape.by_frames is not None:
            covariance = shape.by_frames.covariance.reshape(len(shape.t), -1)
            found = {"frames_coefficients": shape.by_frames.coefficients, "frames_covariance": covariance}
            signals["shape"] |= found
    return signals


def _blocks(signals: dict[str, dict[str, NDArray[Any]]]) -> Iterator[tuple[int, list[tuple[str, slice]]]]:
    """The signals' rows in blocks of time, so that all of them end together where a file is cut."""
    times = {name: columns["t_s"] for name, columns in signals.items() if len(columns["t_s"])}
    if not times:
        return
    start = min(float(t[0]) for t in times.values())
    block = {name: np.floor((t - start) / SECONDS_PER_BLOCK).astype(int) for name, t in times.items()}
    for number in np.unique(np.concatenate(list(block.values()))).tolist():
        rows = {name: slice(*np.searchsorted(found, [number, number + 1]).tolist()) for name, found in block.items()}
        yield number, [(name, part) for name, part in rows.items() if part.stop > part.start]


def _send(stream: rr.RecordingStream, name: str, columns: dict[str, NDArray[Any]], rows: slice) -> None:
    times = columns["t_s"][rows]
    count = len(times)
    index = [
        rr.TimeColumn("time", duration=times),
        rr.TimeColumn("row", sequence=np.arange(rows.start, rows.stop)),
    ]
    plain = {}
    for column, values in columns.items():
        if name in ("motor", "load_cell") and column != "t_s":
            stream.send_columns(f"{name}/{column}", index, rr.Scalars.columns(scalars=values[rows]))
        elif column in ("strain", "acceleration"):
            lines = rr.Scalars.columns(scalars=values[rows].ravel())
            stream.send_columns(name, index, lines.partition(np.full(count, values.shape[1])))
        else:
            plain[column] = values[rows].reshape(count, -1)
    for column, values in plain.items():
        flat = values.ravel().tolist() if values.dtype.kind in "US" else values.ravel()
        batch = [part.partition(np.full(count, values.shape[1])) for part in rr.AnyValues.columns(**{column: flat})]
        stream.send_columns(name, index, batch)


def _log_statics(recording: Recording, stream: rr.RecordingStream) -> None:
    if recording.midline is not None:
        stream.log("midline", rr.AnyValues(s=recording.midline.s), static=True)
    if recording.shape is not None:
        shape = recording.shape
        sizes = rr.AnyValues(
            scale=np.array([shape.scale]), scale_sigma=np.array([shape.scale_sigma]), base_shift=shape.base_shift
        )
        stream.log("shape", sizes, static=True)


def _log_video(recording: Recording, stream: rr.RecordingStream) -> None:
    assert recording.video is not None
    path, camera = recording.video.path, recording.declaration.camera
    if path.is_dir():
        files = frame_files(path)
        fps = 1.0 if camera is None else camera.fps
        for number, file in enumerate(files):
            index = [
                rr.TimeColumn("time", duration=[number / fps]),
                rr.TimeColumn("row", sequence=[number]),
            ]
            content = file.read_bytes()
            columns = rr.EncodedImage.columns(blob=[content], media_type=["image/png"])
            sums = rr.AnyValues.columns(sha256=[hashlib.sha256(content).hexdigest()])
            stream.send_columns("camera/frames", index, [*columns, *sums])
        return
    (log_film if path.stat().st_size > LARGE_VIDEO else log_video_file)(stream, path)


def log_video_file(stream: rr.RecordingStream, path: Path) -> None:
    """A video file's bytes with their checksum, as one message that the viewer plays."""
    content = path.read_bytes()
    asset = rr.AssetVideo(contents=content, media_type=MEDIA_TYPES[path.suffix])
    more = rr.AnyValues(suffix=path.suffix, sha256=hashlib.sha256(content).hexdigest())
    stream.log("camera/video", asset, more, static=True)
    stamps = frame_stamps(path)
    if len(stamps) and path.suffix == ".mp4":  # of others Rerun shows no picture
        references = rr.VideoFrameReference.columns_nanos(stamps)
        stream.send_columns("camera/video", [rr.TimeColumn("time", duration=1e-9 * stamps)], references)

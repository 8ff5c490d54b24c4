"""A recording as one .rrd file, complete: what is read back from it alone equals the recording that was written.

| entity | what is there (columns by name; rows on the timelines `time` [s] and `row`) |
|---|---|
| /declaration | static TextDocument: recording.toml, markers' (s, d), name and notes included |
| /rows | static: signal names, and how many rows each has; so that a file that was cut off is known to be |
| /motor | t_s; /motor/command and /motor/angle: Scalars [rad] |
| /load_cell | t_s; /load_cell/thrust: Scalars [N] |
| /midline | t_s, x_m, y_m, sigma_m (P each); static s (P) |
| /markers | t_s, x_m, y_m (M each) |
| /shape | t_s, coefficients (K), covariance (K K), accepted, reason; static scale, scale_sigma, base_shift (2) |
| /camera/video | a video file: static AssetVideo with its own bytes, suffix; VideoFrameReference rows on `time` |
| /camera/frames | numbered PNG frames: EncodedImage rows with their own bytes |

`time` is rounded to whole nanoseconds by Rerun, so the exact times are in t_s. Signals are written in the order of time
and before the video: a file that was cut off (a full disk, a killed recorder) is recovered up to the cut, and says so
in notes["cut_off"].
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from tentacle.declaration_file import RecordingFile, format_recording_file, parse_recording_file
from tentacle.errors import InputError
from tentacle.recording import Recording
from tentacle.rrd_columns import Columns, read_entities
from tentacle.signals import LoadCellSignal, Markers, Midline, MotorSignal, ShapeTrack, Video
from tentacle.toml_table import parse_toml
from tentacle.video_file import check_frames, frame_files
from tentacle.video_store import store_frames, store_video
from tentacle.write_folder import describe

APPLICATION = "tentacle-twin"
MEDIA_TYPES = {
    ".mp4": "video/mp4",
    ".mkv": "video/x-matroska",
    ".avi": "video/x-msvideo",
    ".mov": "video/quicktime",
    ".webm": "video/webm",
}
SECONDS_PER_BLOCK = 1.0  # a cut costs at most this much, and the whole video


def write_rrd(recording: Recording, file: Path) -> None:
    """Write a recording; the file appears whole or not at all. InputError where its folder is missing."""
    file = Path(file)
    if not file.parent.is_dir():
        raise InputError("no such folder", file=file.parent)
    partial = file.with_name(f".{file.name}.{os.getpid()}.partial")
    stream = rr.RecordingStream(APPLICATION, recording_id=_identity(recording))
    try:
        stream.save(partial)
        log_recording(recording, stream)
        stream.flush()
        stream.disconnect()
        partial.replace(file)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


def _identity(recording: Recording) -> str:
    """The same for the same declaration and signals: the viewer takes two files of one identity as one recording."""
    digest = hashlib.sha256(format_recording_file(describe(recording)).encode())
    for columns in _signal_rows(recording).values():
        for values in columns.values():
            digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()[:32]


def log_recording(recording: Recording, stream: rr.RecordingStream) -> None:
    """Log a recording to an open stream, so that other things can stand beside it in the same file."""
    signals = _signal_rows(recording)
    declaration = format_recording_file(describe(recording))
    stream.send_recording_name(recording.name)
    stream.log("declaration", rr.TextDocument(declaration, media_type="text/plain"), static=True)
    counts = {name: len(next(iter(columns.values()))) for name, columns in signals.items()}
    stream.log("rows", rr.AnyValues(signal=list(counts), count=list(counts.values())), static=True)
    _log_statics(recording, stream)
    stream.flush()  # single logs travel in a batch of their own: the declaration is to come first in the file
    for name, columns, rows in _blocks(signals):
        _send(stream, name, columns, rows)
    if recording.video is not None:
        _log_video(recording, stream)


def _signal_rows(recording: Recording) -> dict[str, dict[str, NDArray[Any]]]:
    """Signal -> column -> (rows, ...), the first column the times."""
    signals: dict[str, dict[str, NDArray[Any]]] = {}
    motor, load_cell, midline = recording.motor, recording.load_cell, recording.midline
    markers, shape = recording.markers, recording.shape
    if motor is not None:
        signals["motor"] = {"t_s": motor.t, "command": motor.command, "angle": motor.angle}
    if load_cell is not None:
        signals["load_cell"] = {"t_s": load_cell.t, "thrust": load_cell.thrust}
    if midline is not None:
        x, y = midline.xy[..., 0], midline.xy[..., 1]
        signals["midline"] = {"t_s": midline.t, "x_m": x, "y_m": y, "sigma_m": midline.sigma}
    if markers is not None:
        signals["markers"] = {"t_s": markers.t, "x_m": markers.xy[..., 0], "y_m": markers.xy[..., 1]}
    if shape is not None:
        covariance = shape.covariance.reshape(len(shape.t), -1)
        signals["shape"] = {
            "t_s": shape.t,
            "coefficients": shape.coefficients,
            "covariance": covariance,
            "accepted": shape.accepted,
            "reason": np.array(shape.reason),
        }
    return signals


def _blocks(
    signals: dict[str, dict[str, NDArray[Any]]],
) -> Iterator[tuple[str, dict[str, NDArray[Any]], slice]]:
    """The signals' rows in blocks of time, so that all of them end together where a file is cut."""
    times = {name: columns["t_s"] for name, columns in signals.items() if len(columns["t_s"])}
    if not times:
        return
    start, stop = min(float(t[0]) for t in times.values()), max(float(t[-1]) for t in times.values())
    for edge in np.arange(start, stop + SECONDS_PER_BLOCK, SECONDS_PER_BLOCK):
        for name, t in times.items():
            rows = slice(*np.searchsorted(t, [edge, edge + SECONDS_PER_BLOCK]).tolist())
            if rows.stop > rows.start:
                yield name, signals[name], rows


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
            columns = rr.EncodedImage.columns(blob=[file.read_bytes()], media_type=["image/png"])
            stream.send_columns("camera/frames", index, columns)
        return
    content = path.read_bytes()
    asset = rr.AssetVideo(contents=content, media_type=MEDIA_TYPES[path.suffix])
    stream.log("camera/video", asset, rr.AnyValues(suffix=path.suffix), static=True)
    try:
        stamps = asset.read_frame_timestamps_nanos()
    except RuntimeError:  # a container that Rerun does not play: the bytes are kept, the viewer shows no picture
        return
    references = rr.VideoFrameReference.columns_nanos(stamps)
    stream.send_columns("camera/video", [rr.TimeColumn("time", duration=1e-9 * stamps)], references)


def read_rrd(file: Path) -> Recording:
    """The recording in an .rrd file; its video's bytes are put in a cache folder (tentacle.video_store).

    InputError where there is none in it. A file that was cut off gives what lies before the cut and
    notes["cut_off"], one line that says how much that is.
    """
    file = Path(file)
    entities, bytes_lost = read_entities(file)
    if "/declaration" not in entities:
        raise InputError("holds no recording", file=file, expected="an .rrd of `tentacle import`, not cut off at once")
    text = str(entities["/declaration"].static("TextDocument:text")[0])
    declared = parse_recording_file(parse_toml(text, file), file=file, text=text)
    recording = Recording(
        name=declared.name or file.stem,
        declaration=declared.declaration,
        motor=_motor(entities),
        load_cell=_load_cell(entities),
        midline=_midline(entities.get("/midline")),
        markers=_markers(entities.get("/markers"), declared),
        shape=_shape(entities.get("/shape")),
        video=_video(entities),
        notes=declared.notes,
    )
    note = _what_is_missing(entities, bytes_lost)
    return recording if note is None else replace(recording, notes={**recording.notes, "cut_off": note})


def _motor(entities: dict[str, Columns]) -> MotorSignal | None:
    command, angle = entities.get("/motor/command"), entities.get("/motor/angle")
    if "/motor" not in entities or command is None or angle is None:
        return None
    columns = [entities["/motor"].flat("t_s"), command.flat("Scalars:scalars"), angle.flat("Scalars:scalars")]
    rows = min(map(len, columns))  # a cut can fall between the entities of one block
    return MotorSignal(*(column[:rows] for column in columns))


def _load_cell(entities: dict[str, Columns]) -> LoadCellSignal | None:
    thrust = entities.get("/load_cell/thrust")
    if "/load_cell" not in entities or thrust is None:
        return None
    columns = [entities["/load_cell"].flat("t_s"), thrust.flat("Scalars:scalars")]
    rows = min(map(len, columns))
    return LoadCellSignal(*(column[:rows] for column in columns))


def _midline(columns: Columns | None) -> Midline | None:
    if columns is None or not columns.has_rows("t_s", "x_m", "y_m", "sigma_m"):
        return None
    s = np.array(columns.static("s"), dtype=float)
    t, x, y, sigma = columns.aligned("t_s", "x_m", "y_m", "sigma_m")
    return Midline(t[:, 0].copy(), s, np.stack([x, y], axis=-1), sigma)


def _markers(columns: Columns | None, declared: RecordingFile) -> Markers | None:
    if columns is None or not columns.has_rows("t_s", "x_m", "y_m"):
        return None
    t, x, y = columns.aligned("t_s", "x_m", "y_m")
    positions = np.array(list(declared.markers.values()), dtype=float)
    names = tuple(declared.markers)
    return Markers(t[:, 0].copy(), names, positions[:, 0].copy(), positions[:, 1].copy(), np.stack([x, y], axis=-1))


def _shape(columns: Columns | None) -> ShapeTrack | None:
    if columns is None or not columns.has_rows("t_s", "coefficients", "covariance", "accepted", "reason"):
        return None
    t, coefficients, covariance, accepted, reason = columns.aligned(
        "t_s", "coefficients", "covariance", "accepted", "reason"
    )
    count = coefficients.shape[1]
    return ShapeTrack(
        t=t[:, 0].copy(),
        coefficients=coefficients,
        covariance=covariance.reshape(-1, count, count),
        accepted=accepted[:, 0].astype(bool),
        reason=tuple(str(words) for words in reason[:, 0]),
        scale=float(columns.static("scale")[0]),
        scale_sigma=float(columns.static("scale_sigma")[0]),
        base_shift=np.array(columns.static("base_shift"), dtype=float),
    )


def _video(entities: dict[str, Columns]) -> Video | None:
    video, frames = entities.get("/camera/video"), entities.get("/camera/frames")
    if video is not None and video.has_static("AssetVideo:blob", "suffix"):
        return Video(store_video(video.static_bytes("AssetVideo:blob"), str(video.static("suffix")[0])))
    if frames is not None and frames.has_rows("EncodedImage:blob"):
        folder = store_frames(frames.row_bytes("EncodedImage:blob"))
        check_frames(folder)
        return Video(folder)
    return None


def _what_is_missing(entities: dict[str, Columns], bytes_lost: int) -> str | None:
    """One line about a cut, or None where all rows that were announced are there."""
    words = []
    if "/rows" in entities:
        rows = entities["/rows"]
        for name, count in zip(rows.static("signal"), rows.static("count"), strict=True):
            columns = entities.get(f"/{name}")
            found = columns.row_count if columns is not None else 0
            if found < int(count):
                words.append(f"{name} {found} of {count} rows")
    if not words and not bytes_lost:
        return None
    head = "the file is cut off" + (f", its last {bytes_lost} bytes are no whole message" if bytes_lost else "")
    return head + ("; left: " + ", ".join(words) if words else "; every signal is whole, a video may be lost")

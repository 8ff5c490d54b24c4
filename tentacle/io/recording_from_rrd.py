"""A recording out of its .rrd file, whole or up to where the file was cut off (entities: tentacle.io.recording_rrd)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.io.declaration_file import RecordingFile, parse_recording_file
from tentacle.io.rrd_columns import Columns, read_entities
from tentacle.io.toml_table import parse_toml
from tentacle.io.video_file import check_frames
from tentacle.io.video_store import store_frames, store_video
from tentacle.recording import Recording
from tentacle.signals import LoadCellSignal, Markers, Midline, MotorSignal, ShapeTrack, Video


def read_rrd(file: Path) -> Recording:
    """The recording in an .rrd file; its video's bytes are put in a cache folder (tentacle.io.video_store).

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
            found = _stored_frames(entities) if name == "camera" else entities.get(f"/{name}", Columns()).row_count
            if found < int(count):
                words.append(f"{name} {found} of {count}")
    if not words and not bytes_lost:
        return None
    head = "the file is cut off" + (f", its last {bytes_lost} bytes are no whole message" if bytes_lost else "")
    return head + ("; left: " + ", ".join(words) if words else "; nothing of the recording is lost")


def _stored_frames(entities: dict[str, Columns]) -> int:
    """Numbered frames that are there, or 1 for a video file."""
    if "/camera/frames" in entities:
        return entities["/camera/frames"].row_count
    return int("/camera/video" in entities and entities["/camera/video"].has_static("AssetVideo:blob"))

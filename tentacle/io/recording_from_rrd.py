"""A recording out of its .rrd file, whole or up to where the file was cut off (entities: tentacle.io.recording_rrd).

Every block of every signal is compared with its checksum, and the whole obeys what an import folder must obey.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.io.checksums import CHECKSUM_ENTITY as SUMS
from tentacle.io.checksums import Sum, columns_digest, covered, first_unsound, read_sums, sound_text
from tentacle.io.declaration_file import RecordingFile, parse_recording_file
from tentacle.io.film_pieces import FILM_ENTITY as FILM
from tentacle.io.film_pieces import stored_film
from tentacle.io.rrd_columns import EntityColumns, read_entities
from tentacle.io.sound_recording import check_recording
from tentacle.io.toml_table import parse_toml
from tentacle.io.video_file import VIDEO_SUFFIXES, check_frames
from tentacle.io.video_store import store_frames, store_video
from tentacle.recording import Recording
from tentacle.signals import (
    AccelerationSignal,
    Array,
    BaseTravel,
    FrameShapes,
    LoadCellSignal,
    Markers,
    Midline,
    MotorSignal,
    ShapeTrack,
    StrainSignal,
    Video,
)

BY_FRAMES = ("frames_coefficients", "frames_covariance")
PLANNED = "/planned"  # s that the recording is to last, where it is written as it is measured
# Exceptions from damaged files: a wrong number of values, a missing value, a wrong type.
DAMAGE = (ValueError, KeyError, IndexError, TypeError, AttributeError, OverflowError)


def read_rrd(file: Path) -> Recording:
    """The recording in an .rrd file; its video's bytes are put in a cache folder (tentacle.io.video_store).

    InputError where there is none in it, or where something does not agree with its checksum. A file that was cut off
    gives what lies before the cut and notes["cut_off"], one line that says how much that is.
    """
    file = Path(file)
    entities, bytes_lost = read_entities(file, lambda entity: not entity.startswith("/rig/") and entity != FILM)
    if "/declaration" not in entities:
        raise InputError("holds no recording", file=file, expected="an .rrd of `tentacle import`, not cut off at once")
    try:
        recording = _assembled(entities, file)
        note = _what_is_missing(entities, recording, bytes_lost)
    except InputError:
        raise
    except DAMAGE as error:
        raise InputError(f"damaged: {error}", file=file, expected="an .rrd of `tentacle import`") from None
    if note is not None:
        kept = {name: None for name in ("motor", "load_cell", "midline", "markers", "strain", "acceleration", "shape")
                if (signal := getattr(recording, name)) is not None and not len(signal.t)}  # fmt: skip
        recording = replace(recording, notes={**recording.notes, "cut_off": note}, **kept)
    return check_recording(recording, file)


def _assembled(entities: dict[str, EntityColumns], file: Path) -> Recording:
    """The recording, every part of it compared with its checksum."""
    head, sums = entities["/declaration"], read_sums(entities.get(SUMS))
    compare = _Comparison(sums, file, has_sums=head.has_static("format"))
    text = sound_text(head)
    if text is None:
        raise compare.error("the declaration")
    declared = parse_recording_file(parse_toml(text, file), file=file, text=text)
    return Recording(
        name=declared.name or file.stem,
        declaration=declared.declaration,
        motor=_motor(entities, compare),
        travel=_travel(entities.get("/travel"), compare),
        load_cell=_load_cell(entities, compare),
        midline=_midline(entities.get("/midline"), compare),
        markers=_markers(entities.get("/markers"), declared, compare),
        strain=_strain(entities.get("/strain"), declared, compare),
        acceleration=_acceleration(entities.get("/acceleration"), declared, compare),
        shape=_shape(entities.get("/shape"), compare),
        video=_video(entities, file, compare),
        notes=declared.notes,
    )


class _Comparison:
    """Compares a file's checksums with the data. In an older file without checksums everything passes."""

    def __init__(self, sums: list[Sum], file: Path, *, has_sums: bool) -> None:
        self.has_sums = has_sums
        self._file = file
        self._static = {one.signal: one.sha256 for one in sums if not one.count}
        self._blocks = [one for one in sums if one.count]

    def once(self, signal: str, columns: dict[str, Array]) -> None:
        """InputError if static data do not agree."""
        if self.has_sums and self._static.get(signal) != columns_digest(columns):
            raise self.error(signal)

    def content(self, signal: str, content: bytes, sha256: Sequence[str]) -> None:
        """InputError where a file's bytes do not agree."""
        if self.has_sums and [hashlib.sha256(content).hexdigest()] != list(sha256):
            raise self.error(signal)

    def rows(self, signal: str, columns: dict[str, Array]) -> dict[str, Array]:
        """The columns' rows up to where all of them, and a checksum, are there. InputError where one disagrees."""
        count = min(map(len, columns.values()))
        if self.has_sums:
            count = min(count, covered(self._blocks, signal))
        columns = {name: values[:count] for name, values in columns.items()}
        unsound = first_unsound(self._blocks, signal, columns)
        if unsound is not None:
            t = columns["t_s"][unsound.first]
            raise self.error(f"{signal} from {float(t.ravel()[0]):.3f} s on")
        return columns

    def error(self, what: str) -> InputError:
        """To be raised: something does not agree."""
        problem = f"damaged: {what} does not agree with its checksum"
        return InputError(problem, file=self._file, expected="the file as it was written")


def _motor(entities: dict[str, EntityColumns], compare: _Comparison) -> MotorSignal | None:
    command, angle = entities.get("/motor/command"), entities.get("/motor/angle")
    if "/motor" not in entities or command is None or angle is None:
        return None
    columns = {
        "t_s": entities["/motor"].flat("t_s"),
        "command": command.flat("Scalars:scalars"),
        "angle": angle.flat("Scalars:scalars"),
    }
    found = compare.rows("motor", columns)  # a cut can fall between the entities of one block
    return MotorSignal(found["t_s"], found["command"], found["angle"])


def _travel(columns: EntityColumns | None, compare: _Comparison) -> BaseTravel | None:
    if columns is None or not columns.has_rows("t_s", "x_m", "y_m"):
        return None
    found = _tables(columns, "travel", ("t_s", "x_m", "y_m"), compare)
    return BaseTravel(found["t_s"], np.stack([found["x_m"][:, 0], found["y_m"][:, 0]], axis=-1))


def _load_cell(entities: dict[str, EntityColumns], compare: _Comparison) -> LoadCellSignal | None:
    thrust = entities.get("/load_cell/thrust")
    if "/load_cell" not in entities or thrust is None:
        return None
    columns = {"t_s": entities["/load_cell"].flat("t_s"), "thrust": thrust.flat("Scalars:scalars")}
    found = compare.rows("load_cell", columns)
    return LoadCellSignal(found["t_s"], found["thrust"])


def _tables(columns: EntityColumns, signal: str, names: tuple[str, ...], compare: _Comparison) -> dict[str, Array]:
    """Columns of one entity, compared; the times as (rows,)."""
    tables = dict(zip(names, columns.aligned(*names), strict=True))
    for name in ("t_s", "accepted", "reason"):
        if name in tables:
            tables[name] = np.ascontiguousarray(tables[name][:, 0])
    return compare.rows(signal, tables)


def _midline(columns: EntityColumns | None, compare: _Comparison) -> Midline | None:
    if columns is None or not columns.has_rows("t_s", "x_m", "y_m", "sigma_m"):
        return None
    s = np.array(columns.static("s"), dtype=float)
    compare.once("midline", {"s": s})
    found = _tables(columns, "midline", ("t_s", "x_m", "y_m", "sigma_m"), compare)
    return Midline(found["t_s"], s, np.stack([found["x_m"], found["y_m"]], axis=-1), found["sigma_m"])


def _markers(columns: EntityColumns | None, declared: RecordingFile, compare: _Comparison) -> Markers | None:
    if columns is None or not columns.has_rows("t_s", "x_m", "y_m"):
        return None
    found = _tables(columns, "markers", ("t_s", "x_m", "y_m"), compare)
    positions = np.array(list(declared.markers.values()), dtype=float).reshape(-1, 2)
    xy = np.stack([found["x_m"], found["y_m"]], axis=-1)
    return Markers(found["t_s"], tuple(declared.markers), positions[:, 0].copy(), positions[:, 1].copy(), xy)


def _strain(columns: EntityColumns | None, declared: RecordingFile, compare: _Comparison) -> StrainSignal | None:
    found = _readings(columns, "strain", compare)
    return found and StrainSignal(found[0], tuple(declared.strain), tuple(declared.strain.values()), found[1])


def _acceleration(
    columns: EntityColumns | None, declared: RecordingFile, compare: _Comparison
) -> AccelerationSignal | None:
    found, sensors = _readings(columns, "acceleration", compare), declared.acceleration
    return found and AccelerationSignal(found[0], tuple(sensors), tuple(sensors.values()), found[1])


def _readings(columns: EntityColumns | None, signal: str, compare: _Comparison) -> tuple[Array, Array] | None:
    """Times (T,) and values (T, G) of sensors on the arm."""
    if columns is None or not columns.has_rows("t_s", "Scalars:scalars"):
        return None
    t, values = columns.aligned("t_s", "Scalars:scalars")
    found = compare.rows(signal, {"t_s": np.ascontiguousarray(t[:, 0]), signal: values})
    return found["t_s"], found[signal]


def _shape(columns: EntityColumns | None, compare: _Comparison) -> ShapeTrack | None:
    names = ("t_s", "coefficients", "covariance", "accepted", "reason")
    if columns is None or not columns.has_rows(*names):
        return None
    by_frames = BY_FRAMES if columns.has_rows(*BY_FRAMES) else ()
    scale, sigma = float(columns.static("scale")[0]), float(columns.static("scale_sigma")[0])
    shift = np.array(columns.static("base_shift"), dtype=float)
    compare.once("shape", {"sizes": np.array([scale, sigma]), "base_shift": shift})
    found = _tables(columns, "shape", (*names, *by_frames), compare)
    return ShapeTrack(
        t=found["t_s"],
        coefficients=found["coefficients"],
        covariance=_square(found["covariance"]),
        accepted=found["accepted"].astype(bool),
        reason=tuple(str(words) for words in found["reason"]),
        scale=scale,
        scale_sigma=sigma,
        base_shift=shift,
        by_frames=FrameShapes(found[by_frames[0]], _square(found[by_frames[1]])) if by_frames else None,
    )


def _square(flat: Array) -> Array:
    """Square matrices (T, K, K) from their rows (T, K K)."""
    size = math.isqrt(flat.shape[1])
    return flat.reshape(-1, size, size)


def _video(entities: dict[str, EntityColumns], file: Path, compare: _Comparison) -> Video | None:
    video, frames = entities.get("/camera/video"), entities.get("/camera/frames")
    if video is not None and video.has_static("AssetVideo:blob", "suffix"):
        content, suffix = video.static_bytes("AssetVideo:blob"), str(video.static("suffix")[0])
        compare.content("the video", content, video.static("sha256") if video.has_static("sha256") else ())
        if suffix not in VIDEO_SUFFIXES:
            raise InputError(f"{suffix!r} is no kind of video", file=file, field="camera")
        return Video(store_video(content, suffix))
    if frames is not None and frames.has_rows("EncodedImage:blob"):
        blobs = frames.row_bytes("EncodedImage:blob")
        sums = frames.texts("sha256") if compare.has_sums else [hashlib.sha256(blob).hexdigest() for blob in blobs]
        for number, (blob, sha256) in enumerate(zip(blobs, sums, strict=True)):
            compare.content(f"frame {number}", blob, [sha256])
        folder = store_frames(blobs)
        check_frames(folder)
        return Video(folder)
    film = stored_film(file) if video is None else None
    return None if film is None else Video(film)


def _what_is_missing(entities: dict[str, EntityColumns], recording: Recording, bytes_lost: int) -> str | None:
    """One line about a cut, or None where all rows that were announced are there."""
    words = []
    if "/rows" in entities:
        rows = entities["/rows"]
        names, counts = rows.static("signal"), rows.static("count")
        ends = zip(rows.static("start_s"), rows.static("stop_s"), strict=True) if rows.has_static("stop_s") else None
        spans = list(ends) if ends is not None else [(0.0, 0.0)] * len(names)
        for name, count, (start, stop) in zip(names, counts, spans, strict=True):
            if name == "camera":
                found, t = _stored_frames(entities, recording), np.empty(0)
            else:
                signal = getattr(recording, name)
                t = np.empty(0) if signal is None else signal.t
                found = len(t)
            if found < int(count):
                seconds = f", {stop - (t[-1] if len(t) else start):.2f} of {stop - start:.2f} s are missing"
                words.append(f"{name} {found} of {int(count)}" + (seconds if stop > start else ""))
    elif bytes_lost or entities["/declaration"].has_static("format"):
        ends = [float(s.t[-1]) for s in (recording.motor, recording.load_cell) if s is not None and len(s.t)]
        words += [f"what was measured up to {max(ends):.2f} s; {_left(entities, max(ends))}"] if ends else []
        words += ["a video; length unknown"] if recording.video is not None and not ends else []
    if not words and not bytes_lost:
        return None
    head = "the file is cut off" + (f", its last {bytes_lost} bytes are no whole message" if bytes_lost else "")
    return head + ("; left: " + ", ".join(words) if words else "; all rows that were announced are there")


def _left(entities: dict[str, EntityColumns], reached: float) -> str:
    """How much is missing of what was to be measured, where its length was written at the start."""
    text = sound_text(entities[PLANNED]) if PLANNED in entities else None
    if text is None:
        return "length unknown"
    planned = float(text)
    return f"{max(planned - reached, 0.0):.2f} of {planned:.2f} s are missing"


def _stored_frames(entities: dict[str, EntityColumns], recording: Recording) -> int:
    """Numbered frames that are there, or 1 for a video file."""
    if "/camera/frames" in entities:
        return entities["/camera/frames"].row_count
    return int(recording.video is not None)

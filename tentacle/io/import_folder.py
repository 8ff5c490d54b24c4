"""A lab's folder as a recording: recording.toml, and a video, a midline or markers, with motor and load cell logs.

| file | columns or content | absent |
|---|---|---|
| recording.toml | the declaration (tentacle.io.declaration_file) | an error |
| video.mp4 (.mkv .avi .mov .webm .gif) or frames/00000.png | dark arm on a light ground; needs [camera] | not filmed |
| motor.csv | t_s, command_rad, angle_rad | clamped |
| base.csv | t_s, x_m, y_m: where the base is, if it travels | it stands |
| load_cell.csv | t_s, thrust_n | not measured |
| midline.csv | t_s, s, x_m, y_m, sigma_m, one point a row; sigma_m may be left out | no midline |
| markers.csv | t_s, then NAME_x_m, NAME_y_m (and NAME_z_m); [markers] NAME = {s, d} in recording.toml | no markers |
| strain.csv | t_s, then NAME_strain; [strain] NAME = {s, d} in recording.toml (tentacle.io.strain_file) | no gauges |
| acceleration.csv | t_s, then NAME_m_s2; [acceleration] NAME = {s, d, axis} (tentacle.io.acceleration_file) | none |

A blank cell in x_m, y_m, sigma_m or a marker's columns means: not seen.
One of video, midline and markers must be there.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from tentacle.base_motion import FEWEST_SAMPLES
from tentacle.errors import InputError
from tentacle.io.acceleration_file import read_acceleration
from tentacle.io.csv_table import CsvTable, column_names, read_csv
from tentacle.io.declaration_file import RecordingFile, read_recording_file
from tentacle.io.plain_file import is_there
from tentacle.io.sound_recording import (
    LARGEST_ANGLE,
    LARGEST_THRUST,
    LONGEST_TRAVEL,
    check_recording,
    reach_of,
    reach_words,
)
from tentacle.io.strain_file import read_strain
from tentacle.io.video_file import find_video, misnamed_video
from tentacle.plane import plane_of_motion
from tentacle.recording import Recording
from tentacle.signals import Array, BaseTravel, LoadCellSignal, Markers, Midline, MotorSignal

OPTIONAL = ("sigma_m", "curvature_1_m", "width_m")  # of midline.csv; the last two, which track writes, are not used


def read_folder(folder: Path) -> Recording:
    """The recording in an import folder. InputError names file, line and field of the first thing that is wrong."""
    folder = Path(folder)
    if not folder.is_dir():
        raise InputError("no such folder", file=folder, expected="an import folder with recording.toml")
    declared = read_recording_file(folder / "recording.toml")
    video = find_video(folder)
    if video is not None and declared.declaration.camera is None:
        raise InputError(
            f"missing, and there is {video.path.name}",
            file=folder / "recording.toml",
            field="camera",
            expected="[camera] with fps, m_per_px, base_px, arm_px",
        )
    travel = read_travel(folder / "base.csv")
    reach = reach_of(declared.declaration, travel)
    markers, out_of_plane = _read_markers(folder / "markers.csv", declared, reach)
    if out_of_plane is not None:
        declared = replace(declared, declaration=replace(declared.declaration, out_of_plane=out_of_plane))
    recording = Recording(
        name=declared.name or folder.resolve().name,
        declaration=declared.declaration,
        motor=_read_motor(folder / "motor.csv"),
        travel=travel,
        load_cell=_read_load_cell(folder / "load_cell.csv"),
        midline=_read_midline(folder / "midline.csv", reach),
        markers=markers,
        strain=read_strain(folder / "strain.csv", declared.strain, declared.declaration.specimen.length),
        acceleration=read_acceleration(folder / "acceleration.csv", declared.acceleration),
        video=video,
        notes=declared.notes,
    )
    if recording.video is None and recording.midline is None and recording.markers is None:
        film = misnamed_video(folder)
        if film is not None:
            name = f"video{film.suffix.lower()}"
            raise InputError("a film is not read under this name", file=film, expected=f"{name}: rename it")
        raise InputError(
            "nothing shows the arm", file=folder, expected="video.mp4, frames/00000.png, midline.csv or markers.csv"
        )
    return check_recording(recording, folder)


def _read_motor(file: Path) -> MotorSignal | None:
    if not is_there(file):
        return None
    try:
        table = read_csv(file, ("t_s", "command_rad", "angle_rad"), extra_allowed=True)
    except InputError as error:
        if not error.problem.startswith("column"):
            raise
        expected = f"{error.expected}; `tentacle new FOLDER --motor LOG` reads a log as it is"
        raise InputError(error.problem, file=error.file, row=error.row, field=error.field, expected=expected) from error
    table.require_rising("t_s")
    for name in ("command_rad", "angle_rad"):
        table.require_within(name, LARGEST_ANGLE, "an angle in rad; degrees? then multiply by 0.0174533")
    return MotorSignal(table["t_s"], table["command_rad"], table["angle_rad"])


def read_travel(file: Path) -> BaseTravel | None:
    """The path of a base out of its CSV; None where there is no such file."""
    if not is_there(file):
        return None
    table = read_csv(file, ("t_s", "x_m", "y_m"))
    table.require_rising("t_s")
    if len(table["t_s"]) < FEWEST_SAMPLES:
        raise InputError(f"{len(table['t_s'])} samples", file=file, field="t_s", expected=f"at least {FEWEST_SAMPLES}")
    for name in ("x_m", "y_m"):
        table.require_within(name, LONGEST_TRAVEL, f"metres, within {LONGEST_TRAVEL:g} m of where the base begins")
    return BaseTravel(table["t_s"], np.stack([table["x_m"], table["y_m"]], axis=-1))


def _read_load_cell(file: Path) -> LoadCellSignal | None:
    if not is_there(file):
        return None
    table = read_csv(file, ("t_s", "thrust_n"), extra_allowed=True)
    table.require_rising("t_s")
    table.require_within("thrust_n", LARGEST_THRUST, "a force in N")
    return LoadCellSignal(table["t_s"], table["thrust_n"])


def _read_midline(file: Path, reach: float) -> Midline | None:
    if not is_there(file):
        return None
    table = read_csv(file, ("t_s", "s", "x_m", "y_m"), optional=OPTIONAL, blank_allowed=True)
    table.require_values("t_s", "s")
    table.require_rising("t_s", repeats=True)
    _check_points(table, [("x_m", "y_m")], reach)
    arc = table["s"]
    outside = (arc < 0) | (arc > 1)
    if outside.any():
        index = int(np.argmax(outside))
        raise table.error(index, "s", f"{arc[index]:g} is out of range", "0 <= s <= 1, the arc length over the arm's")
    sigma = table["sigma_m"] if "sigma_m" in table else np.full(len(arc), np.nan)
    if (sigma <= 0).any():
        index = int(np.argmax(sigma <= 0))
        raise table.error(index, "sigma_m", f"{sigma[index]:g} is out of range", "a number > 0, or a blank cell")
    if "sigma_m" in table:
        table.require_within("sigma_m", reach, "metres")
    return _group_frames(table, sigma)


def _group_frames(table: CsvTable, sigma: Array) -> Midline:
    """The long form as frames: rows of one time are one frame; the fullest frame gives s, others may lack points."""
    t, arc = table["t_s"], table["s"]
    new_frame = np.concatenate([[True], np.diff(t) > 0])
    falls = ~new_frame[1:] & (np.diff(arc) <= 0)
    if falls.any():
        index = int(np.argmax(falls)) + 1
        raise table.error(
            index, "s", f"{arc[index]:g} after {arc[index - 1]:g} in one frame", "s that rises within a frame"
        )
    frame = np.cumsum(new_frame) - 1
    starts, counts = np.flatnonzero(new_frame), np.bincount(frame)
    fullest = int(np.argmax(counts))
    grid = arc[starts[fullest] : starts[fullest] + counts[fullest]]
    point = np.minimum(np.searchsorted(grid, arc), len(grid) - 1)
    stray = grid[point] != arc
    if stray.any():
        index = int(np.argmax(stray))
        problem = f"{arc[index]:g} is none of the {len(grid)} points of the frame at {t[starts[fullest]]:g} s"
        raise table.error(index, "s", problem, "the same s in every frame")
    xy, spread = np.full((len(starts), len(grid), 2), np.nan), np.full((len(starts), len(grid)), np.nan)
    xy[frame, point, 0], xy[frame, point, 1], spread[frame, point] = table["x_m"], table["y_m"], sigma
    return Midline(t[starts], grid.copy(), xy, spread)


def _read_markers(file: Path, declared: RecordingFile, reach: float) -> tuple[Markers | None, float | None]:
    """The markers; of markers in space, those in their plane of motion, and the share of the motion that leaves it."""
    declaration_file = file.parent / "recording.toml"
    if not is_there(file):
        if declared.markers:
            raise InputError("no such file, and [markers] declares some", file=file)
        return None, None
    if not declared.markers:
        raise InputError(
            "missing, and there is markers.csv", file=declaration_file, field="markers", expected="name = {s, d}"
        )
    names = tuple(declared.markers)
    pairs = [(f"{name}_x_m", f"{name}_y_m") for name in names]
    columns = ("t_s", *(column for pair in pairs for column in pair))
    deep = tuple(f"{name}_z_m" for name in names)
    try:
        table = read_csv(file, columns, optional=deep, blank_allowed=True)
    except InputError as error:
        if "column" not in error.problem or (told := _other_markers(file, names, error)) is None:
            raise
        raise told from error
    table.require_values("t_s")
    table.require_rising("t_s")
    _check_points(table, pairs, reach)
    xy = np.stack([np.stack([table[x], table[y]], axis=-1) for x, y in pairs], axis=1)
    share = None
    if any(name in table for name in deep):
        xy, share = _in_plane(xy, table, deep, reach)
    positions = np.array([declared.markers[name] for name in names])
    return Markers(table["t_s"], names, positions[:, 0].copy(), positions[:, 1].copy(), xy), share


def _other_markers(file: Path, declared: tuple[str, ...], error: InputError) -> InputError | None:
    """The error in words, where markers.csv and [markers] do not have the same markers; None where they do."""
    columns = column_names(file)
    found = [name.removesuffix("_x_m") for name in columns if name.endswith("_x_m") and f"{name[:-4]}_y_m" in columns]
    lacking, further = ([name for name in a if name not in b] for a, b in ((declared, found), (found, declared)))
    if not found or not (lacking or further):
        return None
    told = f"markers.csv has {', '.join(found)}, and [markers] of recording.toml has {', '.join(declared)}"
    remedies = []
    if lacking:
        remedies.append(f"columns {lacking[0]}_x_m and {lacking[0]}_y_m, or no {lacking[0]} in [markers]")
    if further:
        remedies.append(f"{further[0]} = {{ s = ..., d = ... }} in [markers], or no columns of {further[0]}")
    field = ", ".join([*lacking, *further])
    return InputError(told, file=file, row=error.row, field=field, expected="; ".join(remedies))


def _in_plane(xy: Array, table: CsvTable, deep: tuple[str, ...], reach: float) -> tuple[Array, float]:
    """Markers in space (T, M, 2), y along the straight arm, in the plane in which they move about their means."""
    for name in deep:
        if name not in table:
            raise InputError("no such column", file=table.file, field=name, expected="z of all markers, or of none")
        table.require_within(name, reach, f"metres, within {reach:g} m of the clamp")
    points = np.concatenate([xy, np.stack([table[name] for name in deep], axis=-1)[..., None]], axis=-1)
    plane = plane_of_motion(points - np.nanmean(points, axis=0), np.array([0.0, 1.0, 0.0]))
    return plane.coordinates(points), plane.out_of_plane


def _check_points(table: CsvTable, pairs: list[tuple[str, str]], reach: float) -> None:
    expected = reach_words(np.stack([np.stack([table[x], table[y]], axis=-1) for x, y in pairs], axis=1), reach)
    for x, y in pairs:
        half = np.isnan(table[x]) != np.isnan(table[y])
        if half.any():
            index = int(np.argmax(half))
            blank = x if np.isnan(table[x][index]) else y
            raise table.error(index, blank, "blank cell", f"{x} and {y} together, or neither")
        for name in (x, y):
            table.require_within(name, reach, expected)

"""A recording as an import folder: the same files as from a lab, with all digits."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.io.acceleration_file import write_acceleration
from tentacle.io.csv_table import write_csv
from tentacle.io.declaration_file import RecordingFile, format_recording_file
from tentacle.io.strain_file import write_strain
from tentacle.io.video_file import VIDEO_SUFFIXES, frame_files
from tentacle.recording import Recording
from tentacle.signals import Markers, Midline


def write_folder(recording: Recording, folder: Path) -> Path:
    """Write an import folder that read_folder gives back; the folder appears whole or not at all.

    Raises InputError if the path is taken, or if the recording has a shape track. A track is a result of vision and not
    a measurement; only .rrd files have it.
    """
    folder = Path(folder)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError("is there already", file=folder, expected="a path that is free, or an empty folder")
    if recording.shape is not None:
        raise InputError("an import folder holds no shape track", field="shape", expected="an .rrd file")
    folder.parent.mkdir(parents=True, exist_ok=True)
    partial = folder.with_name(f".{folder.name}.{os.getpid()}.partial")
    partial.mkdir()
    try:
        _write_files(recording, partial, folder.resolve().name)
        partial.replace(folder)
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        raise
    return folder


def describe(recording: Recording, *, default_name: str = "") -> RecordingFile:
    """What recording.toml says of a recording; its name is left out where it is the default one."""
    markers, strain, acceleration = recording.markers, recording.strain, recording.acceleration
    positions = {} if markers is None else dict(zip(markers.names, zip(markers.s, markers.d, strict=True), strict=True))
    return RecordingFile(
        declaration=recording.declaration,
        markers={name: (float(s), float(d)) for name, (s, d) in positions.items()},
        strain={} if strain is None else dict(zip(strain.names, strain.gauges, strict=True)),
        acceleration={}
        if acceleration is None
        else dict(zip(acceleration.names, acceleration.accelerometers, strict=True)),
        name=None if recording.name == default_name else recording.name,
        notes=recording.notes,
    )


def _write_files(recording: Recording, folder: Path, name: str) -> None:
    text = format_recording_file(describe(recording, default_name=name))
    (folder / "recording.toml").write_text(text, encoding="utf-8", newline="\n")
    motor, load_cell = recording.motor, recording.load_cell
    if motor is not None:
        write_csv(folder / "motor.csv", {"t_s": motor.t, "command_rad": motor.command, "angle_rad": motor.angle})
    if recording.travel is not None:
        xy = recording.travel.xy
        write_csv(folder / "base.csv", {"t_s": recording.travel.t, "x_m": xy[:, 0], "y_m": xy[:, 1]})
    if load_cell is not None:
        write_csv(folder / "load_cell.csv", {"t_s": load_cell.t, "thrust_n": load_cell.thrust})
    if recording.midline is not None:
        _write_midline(recording.midline, folder / "midline.csv")
    if recording.markers is not None:
        _write_markers(recording.markers, folder / "markers.csv")
    if recording.strain is not None:
        write_strain(recording.strain, folder / "strain.csv")
    if recording.acceleration is not None:
        write_acceleration(recording.acceleration, folder / "acceleration.csv")
    if recording.video is not None:
        _copy_video(recording.video.path, folder)


def _write_midline(midline: Midline, file: Path) -> None:
    frames, points = midline.xy.shape[:2]
    columns = {
        "t_s": np.repeat(midline.t, points),
        "s": np.tile(midline.s, frames),
        "x_m": midline.xy[..., 0].ravel(),
        "y_m": midline.xy[..., 1].ravel(),
    }
    if not np.isnan(midline.sigma).all():
        columns["sigma_m"] = midline.sigma.ravel()
    write_csv(file, columns)


def _write_markers(markers: Markers, file: Path) -> None:
    columns = {"t_s": markers.t}
    for index, name in enumerate(markers.names):
        columns[f"{name}_x_m"] = markers.xy[:, index, 0]
        columns[f"{name}_y_m"] = markers.xy[:, index, 1]
    write_csv(file, columns)


def _copy_video(source: Path, folder: Path) -> None:
    if source.is_dir():
        (folder / "frames").mkdir()
        for file in frame_files(source):
            shutil.copyfile(file, folder / "frames" / file.name)
    elif source.suffix in VIDEO_SUFFIXES:
        shutil.copyfile(source, folder / f"video{source.suffix}")
    else:
        raise InputError("not a kind of video that is known", file=source, expected=" ".join(VIDEO_SUFFIXES))

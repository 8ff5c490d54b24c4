"""A test video whose truth is known: a swaying cone or a recording's midline, rendered into an import folder."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.io.csv_table import write_csv
from tentacle.io.write_folder import write_folder
from tentacle.io.written_file import write_text
from tentacle.recording import Declaration, Recording
from tentacle.signals import Array, Midline, MotorSignal, Video
from validation.film import MUJOCO
from vision.encode import write_video
from vision.lens import Lens
from vision.lens_file import format_lens
from vision.looks import look_named
from vision.render import RenderSettings, frame_times, render
from vision.scene import Swing, swaying


@dataclass(frozen=True)
class RenderOptions:
    """look of the tank (or "mujoco"), size [px], seed of sway and pictures, compress: H.264 quality, 0 lossless."""

    look: str
    size: tuple[int, int]
    seed: int
    compress: int = 0


@dataclass(frozen=True)
class Sway:
    """The swaying cone: seconds [s], fps [1/s], order, amplitude of curvature [rad], frequency [Hz], exposure [s]."""

    seconds: float
    fps: float
    order: int
    amplitude: float
    frequency: float
    exposure: float


@dataclass(frozen=True)
class Subject:
    """What is rendered: a recording with a camera, its midline, theta (T,) [rad] or None, further columns of truth."""

    recording: Recording
    midline: Midline
    theta: Array | None
    truth: Mapping[str, Array]


def swaying_subject(name: str, sway: Sway, options: RenderOptions) -> Subject:
    """A cone that sways smoothly; its coordinates are part of the truth."""
    frames = max(round(sway.seconds * sway.fps), 1)
    scene = swaying(
        options.seed, frames, sway.fps, options.size, Swing(sway.order, sway.amplitude, sway.frequency), sway.exposure
    )
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    recording = Recording(name, Declaration(scene.specimen, camera=scene.camera), motor=motor)
    truth = {"theta_rad": scene.theta, "offset_rad": np.full(frames, scene.offset)}
    truth |= {f"q{j + 1}_rad": scene.q[:, j] for j in range(scene.q.shape[1])}
    return Subject(recording, scene.midline, scene.theta, truth)


def recorded_subject(recording: Recording) -> Subject:
    """The midline of a recording. InputError where it has no midline or no camera."""
    midline, motor = recording.midline, recording.motor
    if midline is None or recording.declaration.camera is None:
        raise InputError("has no midline or no [camera]", file=recording.name, expected="both")
    theta = None if motor is None else np.interp(midline.t, motor.t, motor.angle)
    return Subject(recording, midline, theta, {})


def write_test_video(subject: Subject, options: RenderOptions, out: Path) -> int:
    """Write the import folder, OUT.truth.csv and, where the look has one, OUT.lens.toml; the number of frames."""
    mujoco = options.look == MUJOCO
    look = look_named("clean" if mujoco else options.look)
    recording, midline = subject.recording, subject.midline
    camera, specimen = recording.declaration.camera, recording.declaration.specimen
    assert camera is not None
    out.absolute().parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        video = Path(folder) / "video.mp4"
        if mujoco:
            from mujoco_ref.camera import mujoco_film

            pictures = mujoco_film(midline, specimen, camera, options.size)
        else:
            pictures = render(
                midline, specimen, camera, RenderSettings(options.size, look, options.seed), subject.theta
            )
        count = write_video(video, pictures, frame_times(midline.t, look, options.seed), options.compress)
        filmed = replace(recording, name=out.name, midline=None, markers=None, shape=None, video=Video(video))
        write_folder(filmed, out)
    points = {f"{'xy'[k]}{j}_m": midline.xy[:, j, k] for j in range(len(midline.s)) for k in (0, 1)}
    write_csv(out.with_name(out.name + ".truth.csv"), {"t_s": midline.t, **subject.truth, **points})
    if look.lens or look.refraction:
        size = np.array(options.size, dtype=float)
        u, v = 0.5 * (size - 1.0)
        lens = Lens((float(u), float(v)), 0.5 * float(np.linalg.norm(size)), look.lens + look.refraction)
        write_text(out.with_name(out.name + ".lens.toml"), format_lens(lens))
    return count

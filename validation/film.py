"""A recording's midline replaced by a rendered video, with the camera declared."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from vision.render import RenderSettings

if TYPE_CHECKING:
    from tentacle.recording import Recording

# The arm hangs from a little below the upper edge, and fills this share of the height.
ARM_SHARE, BASE_SHARE = 0.66, 0.14
MUJOCO = "mujoco"  # the look of MuJoCo's own camera
CRF = 6  # of H.264: half the lossless file; from 12 on the tracker loses edges to compression


def filmed(recording: Recording, file: Path, look_name: str, size: tuple[int, int], seed: int) -> Recording:
    """The recording with a video of its midline (file, .mp4) in the midline's place; size (width, height) [px]."""
    from tentacle.recording import Camera
    from tentacle.signals import Video
    from vision.encode import write_video
    from vision.looks import look_named
    from vision.render import frame_times, render

    midline = recording.midline
    if midline is None:
        raise ValueError("there is no midline to film")
    width, height = size
    specimen = recording.declaration.specimen
    fps = (midline.t.size - 1) / float(midline.t[-1] - midline.t[0])
    scale = specimen.length / (ARM_SHARE * height)
    camera = Camera(fps, scale, (0.5 * width, BASE_SHARE * height), (0.0, 1.0))
    if look_name == MUJOCO:
        from mujoco_ref.camera import mujoco_film

        write_video(file, mujoco_film(midline, specimen, camera, size), midline.t, crf=CRF)
    else:
        look = look_named(look_name)
        frames = render(midline, specimen, camera, RenderSettings(size, look, seed))
        write_video(file, frames, frame_times(midline.t, look, seed), crf=CRF)
    declaration = replace(recording.declaration, camera=camera)
    return replace(recording, declaration=declaration, midline=None, video=Video(file))

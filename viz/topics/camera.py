"""The camera's view: the video, what was measured as a line along the arm, each model as an outline beside it, and a
frame around pictures that the vision rejected.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from tentacle.recording import Recording
from tentacle.signals import Array, ShapeTrack
from tentacle.specimen import Section
from viz.midline import perimeter
from viz.palette import WARNING, Role
from viz.scene import Party, ViewedRun
from viz.topics.paths import seconds
from viz.tube import thin
from viz.video import SmallVideo, small_video

WIDE, NARROW = -2.0, -1.0  # radii [ui points] (negative, as Rerun has it): the same on the screen at every zoom
DRAWN = 32  # pieces along the arm


def drawn_points(scene: ViewedRun, party: Party, section: Section) -> Array:
    """What of a party is drawn (T, N, 2) [m]: the subject's midline, a model's outline; the line between markers."""
    kept = thin(len(scene.s), DRAWN)
    line = party.xy[:, kept]
    if party is scene.subject or scene.points == "markers":
        return line
    return perimeter(line, scene.s[kept], section)


def log_overlay(session: rr.RecordingStream, path: str, t: Array, pixels: Array, role: Role, width: float) -> None:
    """A line (T, N, 2) [px] over the video; instants with missing points show what is present."""
    present = np.asarray(np.isfinite(pixels).all(axis=-1))
    strips = [row[kept].astype(np.float32) for row, kept in zip(pixels, present, strict=True)]
    enough = present.sum(axis=1) > 1
    session.log(path, rr.LineStrips2D.from_fields(colors=[role.colour], radii=[width]), static=True)
    columns = rr.LineStrips2D.columns(strips=[s for s, kept in zip(strips, enough, strict=True) if kept])
    session.send_columns(path, [seconds(t)], columns.partition(enough.astype(int)))


def log_rejected(session: rr.RecordingStream, path: str, shape: ShapeTrack, video: SmallVideo) -> None:
    """A frame around every rejected picture, labelled with the reason."""
    rejected = ~shape.accepted
    if not rejected.any():
        return
    half = np.array([video.width / 2, video.height / 2])
    style = rr.Boxes2D.from_fields(colors=[WARNING.colour], radii=[3.0])
    session.log(path, style, static=True)
    count = int(rejected.sum())
    columns = rr.Boxes2D.columns(
        centers=np.tile(half, (count, 1)),
        half_sizes=np.tile(half - 3, (count, 1)),
        labels=[f"rejected: {reason}" for reason, bad in zip(shape.reason, rejected, strict=True) if bad],
    )
    session.send_columns(path, [seconds(shape.t)], columns.partition(rejected.astype(int)))


def log_names(session: rr.RecordingStream, path: str, scene: ViewedRun, video: SmallVideo) -> None:
    """The names and colours of what is drawn, above the video; short ones, which fit side by side in a small view."""
    drawn = [party for party in scene.parties if np.isfinite(party.xy).any()]
    places = [[(index + 0.5) / len(drawn) * video.width, -0.09 * video.height] for index in range(len(drawn))]
    names = [party.role.name.removesuffix(" model") for party in drawn]
    colours = [party.role.colour for party in drawn]
    session.log(path, rr.Points2D(places, labels=names, colors=colours, radii=0.0, show_labels=True), static=True)


def log_camera(session: rr.RecordingStream, path: str, scene: ViewedRun, recording: Recording) -> bool:
    """The video with every party over it; False where the recording has none."""
    camera = recording.declaration.camera
    if recording.video is None or camera is None:
        return False
    video = small_video(recording)
    asset = rr.AssetVideo(contents=video.contents, media_type="video/mp4")
    session.log(f"{path}/camera", asset, static=True)
    frames = rr.VideoFrameReference.columns_nanos(asset.read_frame_timestamps_nanos())
    session.send_columns(f"{path}/camera", [seconds(video.t)], frames)

    for party in scene.parties:
        points = drawn_points(scene, party, recording.declaration.specimen.section)
        width = WIDE if party is scene.subject else NARROW
        pixels = video.scale * camera.to_pixels(points)
        log_overlay(session, f"{path}/camera/{party.key}", scene.t, pixels, party.role, width)
    log_names(session, f"{path}/camera/names", scene, video)
    if recording.shape is not None:
        log_rejected(session, f"{path}/camera/rejected", recording.shape, video)
    return True

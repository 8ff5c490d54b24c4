"""What `tentacle track` prints and writes: the summary, each frame as it comes, the fit drawn over the video."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from tentacle.cli._output import say
from tentacle.io.recording_rrd import write_rrd
from tentacle.recording import Recording
from tentacle.signals import ShapeTrack
from vision.declared import is_recording
from vision.encode import write_picture, write_video
from vision.frames import read_frames
from vision.overlay import contact_sheet, overlay
from vision.proofread import most_doubtful
from vision.track import Tracking, tip_untold
from vision.tracked_frame import TrackedFrame


def tracking_summary(shape: ShapeTrack, tracked: Tracking | None, out: Path) -> dict[str, Any]:
    """The results as plain data."""
    return {
        "frames": len(shape.t),
        "accepted": int(shape.accepted.sum()),
        "order": shape.coefficients.shape[1] - 1,
        "scale": shape.scale,
        "scale_sigma": shape.scale_sigma,
        "base_shift_m": shape.base_shift.tolist(),
        "remarks": [] if tracked is None else list(tracked.remarks),
        "most_doubtful": [] if tracked is None else most_doubtful(tracked.seen),
        "wrote": str(out),
    }


def tracking_json(told: dict[str, Any]) -> str:
    """The summary for programs; NaN is null."""
    return json.dumps({key: None if value != value else value for key, value in told.items()}, indent=1)


def in_words(told: dict[str, Any], source: Path, recording: Recording, shape: ShapeTrack) -> list[str]:
    """The summary for people, line by line."""
    aside, along = 1e3 * shape.base_shift
    untold = tip_untold(recording.declaration)
    tip = f" (in it at most {untold:.5f} for the tip's shape, until tip_rounding_m tells it)" if untold else ""
    lines = [
        f"{told['accepted']} of {told['frames']} frames accepted, {told['order']} curvature coordinates",
        f"scale {shape.scale:.5f} +- {shape.scale_sigma:.5f} of the declared{tip}; base {aside:+.2f} mm aside of the"
        f" declared, {along:+.2f} mm along the arm",
        *told["remarks"],
    ]
    if told["most_doubtful"]:
        doubtful = ", ".join(f"{frame} ({shape.t[frame]:.2f} s)" for frame in told["most_doubtful"])
        lines.append(f"most doubtful of the accepted: frames {doubtful}; --reject takes them out")
    if not is_recording(source):
        lines.append(camera_line(recording, shape))
    return [*lines, f"wrote {told['wrote']}"]


def print_frame(result: TrackedFrame) -> None:
    """Print one frame's shape at once."""
    words = "  ".join(f"{value:8.4f}" for value in result.x) if result.accepted else result.reason
    say(f"{result.t:9.4f}  {words}")


def camera_line(recording: Recording, shape: ShapeTrack) -> str:
    """The camera as the video shows it, to be copied into recording.toml (two spaces stand for line ends)."""
    camera = recording.declaration.camera
    assert camera is not None
    u, v = camera.to_pixels(shape.base_shift)
    arm = ", ".join(f"{part:g}" for part in camera.arm_px)
    parts = (
        f"fps = {camera.fps:g}",
        f"m_per_px = {camera.metres_per_px / shape.scale:.4g}",
        f"base_px = [{u:.0f}, {v:.0f}]",
        f"arm_px = [{arm}]",
    )
    return "  ".join(["[camera]", *parts])


def write_tracked(recording: Recording, shape: ShapeTrack, path: Path) -> None:
    """The recording with its shapes, as one file."""
    write_rrd(replace(recording, shape=shape), path)


def overlay_picture(path: Path, video: Path, recording: Recording, seen: Sequence[TrackedFrame]) -> None:
    """The fit drawn over the video (.mp4), or over nine of its frames (.png)."""
    camera = recording.declaration.camera
    frames = read_frames(video, None if camera is None else camera.fps)
    if path.suffix == ".png":
        write_picture(path, contact_sheet(frames, seen))
    else:
        write_video(path, overlay(frames, seen), [result.t for result in seen], crf=20)

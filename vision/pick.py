"""Makes a recording of a plain video: the arm's geometry from the film, written to recording.toml after the user has
seen it.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import av

from tentacle.errors import InputError
from tentacle.io.declaration_file import RecordingFile, format_recording_file
from tentacle.io.video_file import VIDEO_SUFFIXES
from tentacle.io.written_file import write_text
from tentacle.recording import Declaration
from tentacle.specimen import Cone, Specimen
from vision.declared import WATER_DENSITY, DeclaredNumbers
from vision.encode import write_picture
from vision.frames import read_frames
from vision.propose import ArmProposal, picture, propose_arm

LEAST_RADIUS = 1e-4  # m: thinner silicone tips do not exist; a thinner one in a picture is an error


@dataclass(frozen=True)
class Picked:
    """A proposal with the picture that shows it, and the declaration that follows for an arm of known length."""

    proposal: ArmProposal
    picture: Path
    declaration: Declaration


def pick(video: Path, numbers: DeclaredNumbers) -> Picked:
    """Find the arm in a video, draw it into VIDEO.pick.png, and propose the declaration. numbers.length [m] gives the
    scale, because a film alone shows only lengths in px.

    Radii that are not given follow from the widths. Raises InputError where nothing is found, or the length is missing.
    """
    if numbers.length is None:
        raise InputError("a film tells no metres", field="--length", expected="the arm's length from base to tip [m]")
    found = propose_arm(video, numbers.fps)
    if numbers.base_px is not None:
        found = replace(found, base_px=numbers.base_px)
    fps = numbers.fps or _fps(video)
    camera = found.camera(numbers.length, fps, numbers.exposure)
    if numbers.metres_per_px is not None:
        camera = replace(camera, metres_per_px=numbers.metres_per_px)
    radii = [0.5 * width * camera.metres_per_px for width in found.width_px]
    section = Cone(numbers.base_radius or radii[0], numbers.tip_radius or max(radii[1], LEAST_RADIUS))
    declaration = Declaration(Specimen(section, numbers.length, density=WATER_DENSITY), camera=camera)
    shown = video.with_name(video.name + ".pick.png")
    frame = next(islice(read_frames(video, fps), found.frame, None))
    write_picture(shown, picture(frame.image, found))
    return Picked(found, shown, declaration)


def write_pick(video: Path, picked: Picked) -> Path:
    """Write recording.toml; gives the recording's folder: the video's own, or a new one that links to the video.

    A folder of pictures named frames, and a file named video.mp4 (.mkv ..), stay where they are. Raises InputError
    where a recording.toml is there already.
    """
    home = video.parent
    if not ((video.is_dir() and video.name == "frames") or (video.stem == "video" and video.suffix in VIDEO_SUFFIXES)):
        home = video.with_name(video.stem + "_recording")
        home.mkdir(exist_ok=True)
        name = "frames" if video.is_dir() else f"video{_suffix(video)}"
        if not (home / name).exists():
            (home / name).symlink_to(os.path.relpath(video.resolve(), home.resolve()))
    file = home / "recording.toml"
    if file.exists():
        raise InputError("is there already", file=file, expected="--pick of a video that has none")
    write_text(file, format_recording_file(RecordingFile(picked.declaration)))
    return home


def _suffix(video: Path) -> str:
    """The suffix under which an import folder finds a video; the container is recognised by its content, not by its
    name.
    """
    suffix = video.suffix.lower()
    return suffix if suffix in VIDEO_SUFFIXES else ".mkv"


def _fps(video: Path) -> float:
    """The mean frame rate that a file states; 30 of a folder of pictures."""
    if video.is_dir():
        return 30.0
    with av.open(str(video)) as container:
        rate = container.streams.video[0].average_rate if container.streams.video else None
        return float(rate) if rate else 30.0

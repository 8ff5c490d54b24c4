"""Makes a recording of a plain video: the arm's geometry from the film, written to recording.toml after the user has
seen it.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.declaration_file import RecordingFile, format_recording_file
from tentacle.io.video_file import VIDEO_SUFFIXES
from tentacle.io.written_file import write_text
from tentacle.recording import Declaration
from vision.arm_proposal import ArmProposal, picture
from vision.declared import USUAL_FPS, DeclaredNumbers, found_in
from vision.encode import write_picture
from vision.frames import read_frames


@dataclass(frozen=True)
class Picked:
    """A proposal with the picture that shows it, and the declaration that follows for an arm of known length."""

    proposal: ArmProposal
    picture: Path
    declaration: Declaration


def pick(video: Path, numbers: DeclaredNumbers) -> Picked:
    """Find the arm in a video, draw it into VIDEO.pick.png, and propose the declaration. numbers.length [m] gives the
    scale.

    Radii that are not given follow from the widths. Raises InputError where nothing is found, or the length is missing.
    """
    if video.is_dir() and numbers.fps is None:
        numbers = replace(numbers, fps=USUAL_FPS)
    found, declaration = found_in(video, numbers)
    shown = video.with_name(video.name + ".pick.png")
    frame = next(islice(read_frames(video, numbers.fps), found.frame, None))
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

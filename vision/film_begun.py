"""Begins a recording from a film: copies it into the folder and proposes the camera from its first picture."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.recording_template import Answers
from tentacle.io.video_file import VIDEO_SUFFIXES, check_video, frame_rate
from tentacle.io.written_file import written_file
from vision.propose import propose_arm


def require_film(film: Path) -> None:
    """InputError where the file is no film that can be read."""
    if film.suffix.lower() not in VIDEO_SUFFIXES:
        raise InputError("not a film that is known", file=film, field="--video", expected=" ".join(VIDEO_SUFFIXES))
    if not film.is_file():
        raise InputError("no such file", file=film, field="--video", expected="a film")
    check_video(film)


def begun(answers: Answers, film: Path, folder: Path) -> tuple[Answers, str]:
    """The answers with a camera, if one can be proposed, and a sentence about it; copies the film into the folder."""
    require_film(film)
    folder.mkdir(parents=True, exist_ok=True)
    _keep(film, folder)
    try:
        proposal = propose_arm(film)
    except InputError as error:
        return answers, f"the film proposes no camera: {error.problem}"
    camera = proposal.camera(answers.length, frame_rate(film))
    u, v = camera.base_px
    words = f"the film proposes: base at ({u:.0f}, {v:.0f}) px, {1e3 * camera.metres_per_px:.3g} mm a pixel"
    return replace(answers, camera=camera), "; ".join([words, *proposal.words, *proposal.doubts])


def _keep(film: Path, folder: Path) -> None:
    """Copies the film into the folder, whole or not at all. InputError where another film lies there."""
    target = folder / f"video{film.suffix.lower()}"
    there = [path for path in (folder / f"video{suffix}" for suffix in VIDEO_SUFFIXES) if path.exists()]
    if any(path.samefile(film) for path in there):
        return
    if there:
        raise InputError("is there already", file=there[0], field="--video", expected="a folder without a film")
    with written_file(target) as partial:
        shutil.copyfile(film, partial)

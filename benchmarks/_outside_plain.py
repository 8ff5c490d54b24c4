"""Tracking of the outside program's films as plain ones: `tentacle track --length L --base-radius R`, and no more."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _outside_films import draw_film
from _outside_judge import METRES_PER_PX, SIGMAS, WRONG, seen_midlines
from _outside_limit import sideways
from _outside_motion import Film
from _outside_pick import NEAR

from tentacle.errors import InputError
from vision.declared import DeclaredNumbers, recording_of
from vision.encode import write_video
from vision.track import track_fully

MOSTLY, SELDOM = 0.5, 0.02  # least share of the frames in view that are accepted; largest share of these that are wrong


@dataclass(frozen=True)
class Plain:
    """One film: frames in view, those accepted, all accepted, and of them the wrong ones; how far the base is off after
    tracking [px], and over the length; words: why others were refused.
    """

    film: str
    in_view: int
    seen: int
    accepted: int
    wrong: int
    base_px: float
    base: float
    words: str

    @property
    def tracked(self) -> bool:
        """Whether most frames in view have a shape, hardly any shape is wrong, and the base is that of the arm."""
        return self.seen > MOSTLY * self.in_view and self.wrong <= SELDOM * self.accepted and self.base < NEAR


def judge_plain(film: Film, seed: int = 1) -> Plain:
    """Draw, track, compare. In view are the frames of which nothing is hidden, and all fresh ones if there are none."""
    drawn = draw_film(film, seed)
    visible = drawn.fresh & (drawn.covered == 0.0)
    in_view = visible if visible.any() else drawn.fresh
    with tempfile.TemporaryDirectory() as folder:
        video = Path(folder) / "film.mp4"
        write_video(video, drawn.pictures, drawn.t)
        try:
            numbers = DeclaredNumbers(film.length * METRES_PER_PX, 0.5 * film.widths[0] * METRES_PER_PX)
            declaration = recording_of(video, numbers, None).declaration
            shape = track_fully(video, declaration, None).shape
        except InputError as error:
            return Plain(film.name, int(in_view.sum()), 0, 0, 0, np.nan, np.nan, error.line().replace(folder, ""))
    assert declaration.camera is not None
    index = np.searchsorted(drawn.t, shape.t - 1e-3)
    lines, sigma = seen_midlines(shape, declaration, np.zeros(len(index)))
    off = np.abs(sideways(lines, drawn.midlines[index]))
    wrong = shape.accepted & (off > np.maximum(WRONG, SIGMAS * sigma)).any(axis=1)
    base = declaration.camera.to_pixels(shape.base_shift)
    off_px = float(np.linalg.norm(np.subtract(base, drawn.painter.base)))
    reasons = [reason for reason in shape.reason if reason]
    words = "; ".join(f"{reasons.count(reason)} {reason}" for reason in sorted(set(reasons)))
    seen, accepted = int((shape.accepted & in_view[index]).sum()), int(shape.accepted.sum())
    return Plain(film.name, int(in_view.sum()), seen, accepted, int(wrong.sum()), off_px, off_px / film.length, words)

"""Finds an arm in a film: base, tip, direction, widths and length in px.

The arm is the slender body that has contrast with its smooth ground, moves, and is held at one end. What is known of it
selects among the bodies in view; a person may confirm it (pick).
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from tentacle.errors import InputError
from vision.arm_of_bodies import proposal_of
from vision.arm_proposal import ArmProposal
from vision.candidates import candidate_bodies
from vision.frames import Grey, read_frames
from vision.known_arm import NOTHING_KNOWN, KnownArm

LOOKED_AT, EVERY = 15, 6  # pictures of a film, and how many apart
LIVE = 2.0  # s of a film that is still being written, in which the arm is looked for
LARGEST = 1600  # px: larger pictures are shrunk, so that a proposal takes a few seconds at most
NARROWEST = 8  # px: an arm and its ground need more
RIVAL = 0.4  # of the arm's merit: a body with more may be the arm; a passing hand had .26, a second arm .76
RIVALS = "another slender body is in view that may be the arm"


def propose_arm(source: Path | Grey, fps: float | None = None, known: KnownArm = NOTHING_KNOWN) -> ArmProposal:
    """The arm in a film (the first pictures of a file, or of a folder at fps), or in one picture (H, W).

    Raises InputError where nothing slender stands out.
    """
    if isinstance(source, np.ndarray):
        return propose_among([source], known)
    return propose_in(Path(source), fps or 30.0, known)


def propose_in(video: Path, fps: float | None, known: KnownArm, patience: float = 0.0) -> ArmProposal:
    """The arm in a film. patience [s]: of one that is still being written. Of it, and of a camera's, the first two
    seconds are enough.
    """
    pictures: list[Grey] = []
    live = patience > 0.0 or video.is_char_device()
    with closing(read_frames(video, fps, patience)) as frames:
        for k, frame in enumerate(frames):
            if k % EVERY == 0:
                pictures.append(frame.image)
            if len(pictures) == LOOKED_AT or (live and frame.t > LIVE):
                break
    try:
        return propose_among(pictures, known)
    except InputError as error:
        raise InputError(error.problem, file=video, field=error.field, expected=error.expected) from error


def propose_among(pictures: Sequence[Grey], known: KnownArm = NOTHING_KNOWN) -> ArmProposal:
    """The arm in pictures of one film, every sixth of it. A body that is not the known arm is proposed with a doubt."""
    if not pictures:
        raise InputError("there are no pictures", expected="a film")
    times = -(-max(pictures[0].shape) // LARGEST)
    if min(pictures[0].shape) // times < NARROWEST:
        raise InputError("the picture is too narrow for an arm", expected="an arm in view")
    shown = [_shrunk(picture, times) for picture in pictures if picture.shape == pictures[0].shape]
    whole, known = known, known.shrunk(times)
    found = [(arm, merit) for polarity in (1.0, -1.0) for arm, merit in _proposals(shown, polarity, known)]
    if not found:
        place = "" if known.base_px is None else " at this base"
        raise InputError(f"nothing slender stands out against its ground{place}", expected="an arm in view")
    fitting = [(arm, merit) for arm, merit in found if not known.against(arm)]
    best, most = max(fitting or found, key=lambda way: way[1])
    others = sum(arm is not best and arm.polarity == best.polarity and merit > RIVAL * most for arm, merit in fitting)
    best = replace(best.enlarged(times), frame=EVERY * best.frame)
    return replace(best, doubts=(*([RIVALS] if others else []), *filter(None, [whole.against(best)])))


def _proposals(pictures: Sequence[Grey], polarity: float, known: KnownArm) -> list[tuple[ArmProposal, float]]:
    """The arms that the bodies of one polarity give, each with its merit."""
    ways = candidate_bodies(pictures, polarity, known.base())
    arms = [proposal_of(bodies, pictures[0].shape, polarity, known.base()) for bodies in ways]
    merits = [sum(body.merit for body in bodies if body is not None) for bodies in ways]
    return [(arm, merit) for arm, merit in zip(arms, merits, strict=True) if arm is not None]


def _shrunk(picture: Grey, times: int) -> Grey:
    if times == 1:
        return picture
    size = (picture.shape[1] // times, picture.shape[0] // times)
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)

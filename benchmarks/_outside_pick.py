"""Whether `tentacle track --pick` proposes the arm of an outside film from its pictures alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from _outside_films import draw_film
from _outside_motion import REST, Film

from tentacle.errors import InputError
from vision.propose import EVERY, LOOKED_AT, propose_among

NEAR, ALONG = 0.05, 0.1  # of the length: of the base's place and of the length; rad: of the straight arm's direction


@dataclass(frozen=True)
class Proposed:
    """One film: whether the proposal is right; how far the base is off [px], the length (relative), the direction."""

    film: str
    right: bool
    base_px: float
    longer: float
    turned: float
    words: str


def judge_pick(film: Film, seed: int = 1) -> Proposed:
    """Propose and compare. Without a servo's log every frame has its own base angle, and the direction says nothing."""
    drawn = draw_film(film, seed)
    try:
        found = propose_among(drawn.pictures[: LOOKED_AT * EVERY][::EVERY])
    except InputError as error:
        return Proposed(film.name, False, np.nan, np.nan, np.nan, error.line())
    off = float(np.linalg.norm(np.subtract(found.base_px, drawn.painter.base)))
    longer = found.length_px / film.length - 1.0
    rest = (np.cos(REST[film.side]), np.sin(REST[film.side]))
    turned = float(np.arccos(np.clip(np.dot(found.level_arm_px(), rest), -1.0, 1.0)))
    right = off < NEAR * film.length and abs(longer) < NEAR and (turned < ALONG or not film.servo)
    return Proposed(film.name, right, off, longer, turned, "; ".join(found.words))

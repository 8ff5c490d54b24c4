"""Pictures that repeat the one before, as in a slowed film or a stream with filled gaps."""

from __future__ import annotations

from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

REPEAT, USUAL = 0.1, 31  # largest change of a repeat over the usual change; pictures for that median


class Repeats:
    """The usual change between a film's pictures. again: number of pictures so far that repeat the one before."""

    def __init__(self) -> None:
        self.again = 0
        self._before: NDArray[np.uint8] | None = None
        self._changes: list[float] = []

    def begin(self, pictures: list[NDArray[np.uint8]]) -> None:
        """Learn the usual change from a film's first pictures."""
        self._changes = [_change(a, b) for a, b in pairwise(pictures)]

    def repeats(self, picture: NDArray[np.uint8]) -> bool:
        """Whether a picture repeats the one before: its change is far below the usual one.

        Noise or the moving arm changes every picture, but only the coding changes a copy. In a video without noise and
        without motion for a while, copies do no harm.
        """
        before, self._before = self._before, picture
        if before is None:
            return False
        known = np.array(self._changes or [0.0])
        change, usual = _change(before, picture), float(np.median(known))
        self._changes = [*self._changes[1 - USUAL :], change]
        # a slowed film repeats most pictures: each gives a shape, and a remark reports it
        self.again += change < REPEAT * float(np.quantile(known, 0.9))
        return change < REPEAT * usual


def _change(before: NDArray[np.uint8], after: NDArray[np.uint8]) -> float:
    """Mean change of grey from one picture to the next, but for the light's; infinite where their sizes differ.

    Flickering light changes a picture by one factor; beside it two pictures of equal light would look like copies.
    """
    if before.shape != after.shape:
        return np.inf
    first, second = np.ascontiguousarray(before[::7]), np.ascontiguousarray(after[::7])
    gain = float(np.mean(second)) / max(float(np.mean(first)), 1.0)
    return float(np.mean(cv2.absdiff(cv2.convertScaleAbs(first, alpha=gain), second)))

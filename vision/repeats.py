"""Pictures that show the one before again, as a slowed film or a filled-up stream has them."""

from __future__ import annotations

from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

REPEAT, USUAL = 0.1, 31  # a repeat's share of the usual change, which is the median over so many pictures


class Repeats:
    """How much a film's pictures usually change. again: how many of those looked at showed the one before again."""

    def __init__(self) -> None:
        self.again = 0
        self._before: NDArray[np.uint8] | None = None
        self._changes: list[float] = []

    def begin(self, pictures: list[NDArray[np.uint8]]) -> None:
        """Learn the usual change from a film's first pictures."""
        self._changes = [_change(a, b) for a, b in pairwise(pictures)]

    def repeats(self, picture: NDArray[np.uint8]) -> bool:
        """Whether a picture is the one before again: it changes far less than pictures here do.

        Noise, or the moving arm, changes every picture; a copy is changed by its coding alone. Where nothing has moved
        for a while, in a video without noise, copies tell no lie.
        """
        before, self._before = self._before, picture
        if before is None:
            return False
        known = np.array(self._changes or [0.0])
        change, usual = _change(before, picture), float(np.median(known))
        self._changes = [*self._changes[1 - USUAL :], change]
        # a film that was slowed shows most pictures again: each tells its shape, and the remark says what it is
        self.again += change < REPEAT * float(np.quantile(known, 0.9))
        return change < REPEAT * usual


def _change(before: NDArray[np.uint8], after: NDArray[np.uint8]) -> float:
    """Mean change of grey from one picture to the next; infinite where their sizes differ."""
    if before.shape != after.shape:
        return np.inf
    return float(np.mean(cv2.absdiff(np.ascontiguousarray(before[::7]), np.ascontiguousarray(after[::7]))))

"""The light in the tank, learnt from all pictures: the greys of arm and ground at every place.

In one picture only a few pixels give the greys beside an edge. The lamps do not move, so all pictures together give
them far better. The arm's grey comes from the pixels inside its edges. The ground's grey is the median over pictures
taken seconds apart, away from the arm; the median removes what moves (a mirror image, bubbles, specks). If this light
contradicts a picture, the picture's own greys are used (levels.side_greys).
"""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.signals import Array
from vision.field import Field
from vision.lens import Lens

BLOCKS = 4  # of the picture, in a cell of the field
BLOCKS_ABOUT_ARM = 3  # blocks around the arm that do not count as ground
EARLY, OFTEN, SELDOM = 32, 2, 8  # every second of the first pictures is kept for the ground; later every eighth
PICTURES, RARELY = 32, 4  # pictures kept; new ones after which the medians are computed again
PICTURE_MEMORY = 1000.0  # pictures after which the data of an edge are forgotten
HUBER = 2.0  # standard deviations beyond which a grey inside the arm has less weight (Huber 1964)
STRANGE_OUTSIDE = 4.0  # standard deviations beyond which a grey outside is not the ground's
CLAMP_REACH = 3.5  # half widths around the base in which a clamp may be
LEAST_PIXELS = 30.0  # fewest pixels of data at a place
ROUGH = 1.5  # grey: largest deviation of a block of smooth ground; a bubble, a speck or a wall deviates more
SMOOTH_SHARE = 0.5  # least share of the blocks around a node that agree with the field
SIFTS = 6  # rounds in which blocks with larger deviations lose weight
SLOPE = 3.0  # px to either side for the slope


class Light:
    """Greys of arm and ground over pictures of one size (width, height) [px]."""

    def __init__(self, size: tuple[int, int]) -> None:
        self._size = size
        self._arm, self._edged, self._beheld = (Field.over(size) for _ in range(3))
        self._ground = self._edged
        self._block = max(int(self._arm.cell / BLOCKS), 1)  # px
        self._pictures: list[NDArray[np.float32]] = []
        self._seen, self._until = 0, -np.inf

    def learn(
        self,
        t: float,
        image: NDArray[np.uint8],
        lens: Lens,
        sides: tuple[Array, Array],
        told: tuple[Array, Array],
        noise: float,
    ) -> None:
        """Add what a picture of time t [s] shows; a time that is not later than the last is left out.

        sides: the arm's outline in the ideal picture, (N, 2) [px] each from base to tip. told, inside and outside: (E,
        4), number of pixels beside each edge, their mean grey and mean place (u, v) in the ideal picture. noise:
        standard deviation of one pixel [grey].
        """
        if t <= self._until:
            return
        self._until = t
        place, grey, pixels = _seen(told[0], lens)
        off = _sigmas(self._arm, place, grey, pixels, noise)
        self._arm = _faded(self._arm).adding(place, grey, np.minimum(1.0, HUBER / off) * pixels)
        place, grey, pixels = _seen(told[1], lens)
        # beside the edge something may move with the arm; if the pictures give the ground, they are more reliable
        off = _sigmas(self._ground, place, grey, pixels, noise)
        trust = np.where(self._beheld.told(place) > LEAST_PIXELS, off < STRANGE_OUTSIDE, 1.0)
        self._edged = _faded(self._edged).adding(place, grey, trust * pixels)
        early, self._seen = self._seen < EARLY, self._seen + 1
        if self._seen % (OFTEN if early else SELDOM):
            return
        outline = lens.bend(np.concatenate([sides[0], sides[1][::-1]]))
        self._pictures = [*self._pictures[1 - PICTURES :], self._blocks(image, outline)]
        again = early or self._seen % (RARELY * SELDOM) == 0
        if again:
            self._beheld = self._medians()
        ground = replace(self._edged.joined(self._beheld), smooth=self._ground.smooth)
        self._arm = self._arm.chosen(noise) if again else self._arm.settled()
        self._ground = ground.chosen(noise) if again else ground.settled()

    def beside(self, points: Array, normals: Array, lens: Lens) -> tuple[Array, NDArray[np.bool_]]:
        """Greys (E, 4) at edges' points (E, 2): inside, outside, slopes outward of ground and arm; and which
        are known.
        """
        place, out, back = (lens.bend(points + step * normals) for step in (0.0, SLOPE, -SLOPE))
        slopes = [(field.at(out) - field.at(back)) / (2.0 * SLOPE) for field in (self._ground, self._arm)]
        greys = np.column_stack([self._arm.at(place), self._ground.at(place), *slopes])
        return greys, np.minimum(self._arm.told(place), self._ground.told(place)) > LEAST_PIXELS

    def _blocks(self, image: NDArray[np.uint8], outline: Array) -> NDArray[np.float32]:
        """Mean greys of the picture's blocks (rows, columns), NaN where the arm is near."""
        width, height = (side // self._block for side in self._size)
        whole = image[: height * self._block, : width * self._block]
        blocks = cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA).astype(np.float32)
        arm = np.zeros(blocks.shape, dtype=np.uint8)
        corners = np.rint(np.clip(outline / self._block - 0.5, -1e4, 1e4)).astype(np.int32)
        cv2.fillPoly(arm, [corners], 1)
        cv2.polylines(arm, [corners], True, 1)
        base, wide = (
            0.5 * (outline[0] + outline[-1]),
            CLAMP_REACH * 0.5 * float(np.linalg.norm(outline[0] - outline[-1])),
        )
        middle = np.rint(base / self._block - 0.5).astype(int)
        cv2.circle(arm, (int(middle[0]), int(middle[1])), round(wide / self._block), 1, -1)
        blocks[cv2.dilate(arm, np.ones((2 * BLOCKS_ABOUT_ARM + 1, 2 * BLOCKS_ABOUT_ARM + 1), np.uint8)) > 0] = np.nan
        return blocks

    def _medians(self) -> Field:
        """The ground from the pictures' medians, without blocks that deviate."""
        stack = np.sort(np.stack(self._pictures, axis=-1), axis=-1)  # NaN last
        times = np.count_nonzero(np.isfinite(stack), axis=-1)
        middle = [np.maximum(times - 1, 0) // 2, times // 2]
        ends = [np.take_along_axis(stack, np.minimum(k, stack.shape[-1] - 1)[..., None], -1)[..., 0] for k in middle]
        grey = 0.5 * (ends[0] + ends[1])
        rows, columns = np.indices(times.shape)
        place = (np.column_stack([columns.ravel(), rows.ravel()]) + 0.5) * self._block - 0.5
        there = times.ravel() > 0
        place, grey, pixels = place[there], grey.ravel()[there].astype(float), times.ravel()[there] * self._block**2
        bare = Field.over(self._size)
        field = bare.adding(place, grey, pixels).settled()
        for _ in range(SIFTS):
            off = np.abs(grey - field.at(place))
            field = bare.adding(place, grey, pixels * np.minimum(1.0, ROUGH / np.maximum(off, 1e-9))).settled()
        near = np.abs(grey - field.at(place)) < ROUGH
        field, whole = bare.adding(place[near], grey[near], pixels[near]), bare.adding(place, grey, pixels)
        return replace(field, count=np.where(field.count > SMOOTH_SHARE * whole.count, field.count, 0.0))


def _seen(told: Array, lens: Lens) -> tuple[Array, Array, Array]:
    """Places (P, 2) in the picture, greys (P,), numbers of pixels (P,) of the edges with data."""
    some = told[told[:, 0] > 0]
    return lens.bend(some[:, 2:]), some[:, 1], some[:, 0]


def _sigmas(field: Field, place: Array, grey: Array, pixels: Array, noise: float) -> Array:
    """Deviation of greys (P,) from a field, in their own standard deviations; 1e-9 where the field has no data."""
    off = np.abs(grey - field.at(place)) * np.sqrt(pixels) / noise
    return np.where(field.told(place) > LEAST_PIXELS, off, 0.0) + 1e-9


def _faded(field: Field) -> Field:
    return field.fading(1.0 - 1.0 / PICTURE_MEMORY)

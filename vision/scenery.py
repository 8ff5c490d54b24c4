"""The contents of a rendered tank besides the arm: light, wall, bubbles, specks, mirror image in the glass; frame
faults.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.signals import Array
from vision.coverage import blend_disc
from vision.looks import Look


def frame_faults(count: int, look: Look, seed: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which of count frames are dropped, and which repeat the frame before; the first is neither."""
    rng = np.random.default_rng([seed, 1_000_003])
    draw = rng.random(count)
    dropped = draw < look.dropped
    duplicated = (draw >= look.dropped) & (draw < look.dropped + look.duplicated)
    dropped[:1] = duplicated[:1] = False
    return dropped, duplicated


class Scenery:
    """The tank around the arm. size is (width, height) [px]; the same seed gives the same tank."""

    def __init__(self, look: Look, size: tuple[int, int], seed: int) -> None:
        self.look, self.size = look, size
        width, height = size
        rng = np.random.default_rng([seed, 1_000_033])
        u, v = np.meshgrid(np.linspace(0.0, 1.0, width), np.linspace(0.0, 1.0, height))
        direction = rng.uniform(0.0, 2.0 * np.pi)
        ramp = 0.5 + 0.5 * (np.cos(direction) * (2 * u - 1) + np.sin(direction) * (2 * v - 1)) / np.sqrt(2.0)
        spot = np.exp(-((u - rng.uniform(0.2, 0.8)) ** 2 + (v - rng.uniform(0.2, 0.8)) ** 2) / 0.18)
        light = 1.0 - look.unevenness * (0.7 * ramp - 0.3 * spot)
        self.light = light / light.max()
        self._still = np.full((height, width), look.ground_level)
        if look.wall:  # a dark band with a bright rim at one side of the picture
            edge = max(int(0.05 * width), 4)
            self._still[:, :edge] *= 0.55
            self._still[:, edge : edge + max(edge // 8, 2)] *= 1.15
        self._bubbles = np.column_stack(
            [rng.uniform(0, width, look.bubbles), rng.uniform(0, height, look.bubbles), rng.uniform(2, 7, look.bubbles)]
        )
        self._specks = np.column_stack(
            [
                rng.uniform(0, width, look.specks),
                rng.uniform(0, height, look.specks),
                rng.uniform(0.8, 2.0, look.specks),
            ]
        )
        self._drift = rng.normal(0.0, 8.0, (look.specks, 2))  # px/s
        self._seats = np.column_stack(
            [rng.uniform(0.1, 0.95, look.edge_bubbles), rng.integers(0, 2, look.edge_bubbles)]
        )
        self._seat_radius = rng.uniform(2.0, 5.0, look.edge_bubbles)
        self._shift = rng.uniform(-0.12, 0.12, 2) * np.array(size) + np.array([0.1 * width, 0.0])

    def ground(self, time: float) -> Array:
        """The background at a time [s]: ground, wall, and drifting specks."""
        scene = self._still.copy()
        for (u, v, radius), drift in zip(self._specks, self._drift, strict=True):
            place = np.mod(np.array([u, v]) + drift * time, self.size)
            blend_disc(scene, place, radius, 0.6 * self.look.ground_level, 0.8)
        return scene

    def mirror(self, covered: Array) -> Array:
        """The arm's mirror image in a glass wall, shifted and out of focus; (height, width) in 0 to 1."""
        shift = np.array([[1.0, 0.0, self._shift[0]], [0.0, 1.0, self._shift[1]]])
        return np.asarray(cv2.warpAffine(cv2.GaussianBlur(covered, (0, 0), 4.0), shift, self.size), dtype=float)

    def put_in_front(self, scene: Array, outline: Array, time: float) -> None:
        """Draw the bubbles, in place: rising ones, and those on the arm's outline (2 S, 2) [px]."""
        height = self.size[1]
        for index, (u, v, radius) in enumerate(self._bubbles):
            rise = np.array([u + 3.0 * np.sin(2.0 * time + index), (v - 12.0 * radius * time) % (height + 20.0) - 10.0])
            self._bubble(scene, rise, radius)
        stations = len(outline) // 2
        for (s, side), radius in zip(self._seats, self._seat_radius, strict=True):
            index = int(s * (stations - 1))
            self._bubble(scene, outline[index] if side == 0 else outline[-1 - index], radius)

    def _bubble(self, scene: Array, centre: Array, radius: float) -> None:
        """A dark rim, a body near the ground's grey, a bright glint."""
        ground = self.look.ground_level
        blend_disc(scene, centre, radius, 0.55 * ground, 0.7)
        blend_disc(scene, centre, 0.7 * radius, 0.95 * ground, 0.6)
        blend_disc(scene, centre - 0.3 * radius, 0.3 * radius, 255.0, 0.8)

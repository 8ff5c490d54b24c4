"""The camera's errors: time offset, roll and scale, each by two or more published laws."""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array

CLOCK = 5e-4  # s/s by which a poor clock drifts, of a constant offset's own sign
DISTORTION = 0.5  # relative growth of the scale's error over one arm's length


def looks_at(t: Array, numbers: dict[str, float], laws: dict[str, str]) -> Array:
    """The time [s] at which a frame with the stamp t is taken."""
    if "time_offset" not in laws:
        return t
    offset = numbers["offset"]
    drift = np.sign(offset) * CLOCK * t if laws["time_offset"] == "drifting_clock" else 0.0
    return t + offset + drift


def as_filmed(xy: Array, length: float, numbers: dict[str, float], laws: dict[str, str]) -> Array:
    """Points (T, P, 2) [m] as the picture shows them."""
    if "camera_scale" in laws:
        excess = numbers["excess"]
        more = 1.0
        if laws["camera_scale"] == "with_distortion":
            more = 1.0 + DISTORTION * np.sum(xy**2, axis=-1, keepdims=True) / length**2
        xy = xy * (1.0 + excess * more)
    if "camera_roll" in laws:
        cos, sin = np.cos(numbers["roll"]), np.sin(numbers["roll"])
        about = np.array([0.0, 0.5 * length if laws["camera_roll"] == "about_picture" else 0.0])
        moved = xy - about
        xy = about + np.stack(
            [cos * moved[..., 0] - sin * moved[..., 1], sin * moved[..., 0] + cos * moved[..., 1]], -1
        )
    return xy

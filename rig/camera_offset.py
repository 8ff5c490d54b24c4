"""How much later a frame arrives than it was exposed: from flashes (or servo taps) whose board time is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from rig.fault import Fault
from tentacle.signals import Array

JITTER_FLOOR = 5e-4  # s; no camera's stamps are better than that
LARGEST_OFFSET = 0.5  # s


@dataclass(frozen=True)
class CameraOffset:
    """offset [s]: arrival minus the middle of exposure; sigma [s] of it; edges that were used."""

    offset: float
    sigma: float
    edges: int


def lit_frames(thumbnails: Array) -> np.ndarray:
    """Which frames (N, h, w) show the light: bool (N,). The brightest-changing pixel is the lamp.

    Fault("camera") where no pixel switches between two levels.
    """
    change = np.quantile(thumbnails, 0.98, axis=0) - np.quantile(thumbnails, 0.3, axis=0)
    lamp = np.unravel_index(np.argmax(change), change.shape)
    signal = thumbnails[:, lamp[0], lamp[1]]
    dark, bright = np.quantile(signal, 0.1), signal.max()
    noise = np.median(np.abs(np.diff(signal)))
    if bright - dark < max(5.0, 8.0 * float(noise)):
        raise Fault("camera", "no flash is seen by the camera: is the LED in the picture?")
    return signal > 0.5 * (dark + bright)


def estimate_offset(frame_times: Array, lit: np.ndarray, on: Array, off: Array) -> CameraOffset:
    """frame_times (N,) [s] of arrival, lit (N,) bool, and the flashes' true begins and ends (F,) [s], one time base.

    A frame is lit when the middle of its exposure lies within a flash: each edge says that it fell between two
    frames, less the offset. Their product, over a grid, is the offset's distribution; frames' jitter softens the
    walls. Fault("camera") where fewer than two edges can be told apart.
    """
    frame_times, lit = np.asarray(frame_times, dtype=float), np.asarray(lit, dtype=bool)
    period = float(np.median(np.diff(frame_times)))
    jitter = max(1.4826 * float(np.median(np.abs(np.diff(frame_times) - period))) / np.sqrt(2.0), JITTER_FLOOR)
    turns = np.flatnonzero(lit[1:] != lit[:-1])
    whole = frame_times[turns + 1] - frame_times[turns] < 1.6 * period  # an edge in a gap says little
    turns = turns[whole]
    before, after, rises = frame_times[turns], frame_times[turns + 1], lit[turns + 1]

    grid = np.arange(-0.05, LARGEST_OFFSET, 2.5e-4)
    edges = {True: np.asarray(on, dtype=float), False: np.asarray(off, dtype=float)}
    likelihood = np.zeros_like(grid)
    used = 0
    for early, late, rise in zip(before, after, rises, strict=True):
        candidates = edges[bool(rise)]
        inside = np.array([_between(early - grid - e, late - grid - e, jitter) for e in candidates])
        if len(inside):
            likelihood += np.log(inside.sum(axis=0) + 1e-4)  # 1e-4: an edge may be a stray reflection
            used += 1
    if used < 2:
        raise Fault("camera", f"only {used} edges of the flash were seen; at least 2 are needed")
    weight = np.exp(likelihood - likelihood.max())
    weight /= weight.sum()
    mean = float(weight @ grid)
    sigma = float(np.sqrt(weight @ (grid - mean) ** 2))
    return CameraOffset(mean, max(sigma, jitter / np.sqrt(used)), used)


def combined(now: CameraOffset, calibrated: CameraOffset | None) -> CameraOffset:
    """This run's estimate and the calibrated one, weighted; this run's alone where they contradict (3 sigma)."""
    if calibrated is None or abs(now.offset - calibrated.offset) > 3.0 * np.hypot(now.sigma, calibrated.sigma):
        return now
    weight = np.array([now.sigma, calibrated.sigma]) ** -2.0
    offset = float(weight @ [now.offset, calibrated.offset] / weight.sum())
    return CameraOffset(offset, float(weight.sum() ** -0.5), now.edges)


def _between(early: Array, late: Array, jitter: float) -> Array:
    """Probability that 0 lies between two jittered instants."""
    return np.clip(ndtr(late / jitter) - ndtr(early / jitter), 0.0, 1.0)

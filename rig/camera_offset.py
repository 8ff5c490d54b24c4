"""The delay from a frame's exposure to its arrival, from flashes (or servo taps) with a known board time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from rig.fault import Fault
from tentacle.signals import Array

JITTER_FLOOR = 5e-4  # s; no camera's time stamps are better than this
LARGEST_OFFSET = 0.5  # s
COARSE = 0.01  # s, steps of the delay while the lamp is looked for
FOLLOWS = 0.7  # least correlation of a lamp's pixel with the flashes; frames lit in part cost a lamp 0.1 at most
FEWEST_FLASH_FRAMES = 10


@dataclass(frozen=True)
class CameraOffset:
    """offset [s]: arrival minus the middle of exposure; sigma [s] of it; how many edges or frames were used."""

    offset: float
    sigma: float
    used: int


def lit_frames(thumbnails: Array, frame_times: Array, on: Array, off: Array) -> np.ndarray:
    """Which frames (N, h, w), arrived at frame_times (N,) [s], show the light: bool (N,). on, off (F,): the flashes.
    The lamp is the pixel with the highest correlation with the flashes at any delay. A moving arm changes pixels too,
    but not in step with the flashes. Fault("camera") where no pixel follows.
    """
    frame_times, on, off = (np.asarray(x, dtype=float) for x in (frame_times, on, off))
    flashes = min(on.size, off.size)
    if len(thumbnails) < FEWEST_FLASH_FRAMES or not flashes:
        raise Fault(
            "camera", f"{len(thumbnails)} frames and {flashes} flashes were seen; the camera must run meanwhile"
        )
    signals = thumbnails.reshape(len(thumbnails), -1)
    centred = signals - signals.mean(axis=0)
    spread = np.maximum(centred.std(axis=0), 0.5)  # grey levels; a still pixel follows nothing
    best, lamp, lit = 0.0, 0, np.zeros(len(thumbnails), dtype=bool)
    for delay in np.arange(-0.05, LARGEST_OFFSET, COARSE):
        shown = frame_times[:, None] - delay
        bright = ((shown >= on[:flashes]) & (shown < off[:flashes])).any(axis=1)
        if not 0 < bright.sum() < bright.size:
            continue
        follows = (bright - bright.mean()) @ centred / (bright.size * bright.std() * spread)
        pixel = int(np.argmax(follows))
        if follows[pixel] > best:
            best, lamp, lit = float(follows[pixel]), pixel, bright
    if best < FOLLOWS:
        raise Fault("camera", "no flash is seen by the camera: is the LED in the picture?")
    signal = signals[:, lamp]
    return signal > 0.5 * (np.median(signal[lit]) + np.median(signal[~lit]))


def estimate_offset(frame_times: Array, lit: np.ndarray, on: Array, off: Array) -> CameraOffset:
    """frame_times (N,) [s] of arrival, lit (N,) bool, and the flashes' true begins and ends (F,) [s], one time base.

    A frame is lit if the middle of its exposure lies within a flash. So each edge of a flash lies between two frames,
    minus the offset. The product over all edges, on a grid, is the distribution of the offset; the jitter of the frames
    smooths it. Fault("camera") where fewer than two edges can be told apart.
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
    """The weighted mean of this run's estimate and the calibrated one; this run's alone if they contradict each other
    (3 sigma).
    """
    if calibrated is None or abs(now.offset - calibrated.offset) > 3.0 * np.hypot(now.sigma, calibrated.sigma):
        return now
    weight = np.array([now.sigma, calibrated.sigma]) ** -2.0
    offset = float(weight @ [now.offset, calibrated.offset] / weight.sum())
    return CameraOffset(offset, float(weight.sum() ** -0.5), now.used)


def _between(early: Array, late: Array, jitter: float) -> Array:
    """Probability that 0 lies between two jittered instants."""
    return np.clip(ndtr(late / jitter) - ndtr(early / jitter), 0.0, 1.0)

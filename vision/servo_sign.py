"""Checks that the servo's log has the same sense of rotation as the arm's root in the film, before the log is used.

In some of the first frames, whose logged angles differ, the shape is fitted without the log. The root's angle is then
a + b theta, by least squares; b is near 1, or near -1 where the sign is reversed (or the picture mirrored).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable

import numpy as np

from tentacle.errors import InputError
from vision.edge_look import EdgeLook
from vision.fit import Exposure, TrackedArm, refine
from vision.frames import Frame
from vision.kinematics import SHARED, Geometry
from vision.locate import locate
from vision.motion import ShapeMotion

APART, ENOUGH = 0.06, 0.35  # rad: difference of logged angles between frames, and the span that is enough
FEWEST, MOST = 4, 8  # frames
SIGN_PATIENCE = 1.5  # s, longest search for moving frames
LEAST_SIGN_SCORE = 0.45
REVERSED, ALIKE = -0.5, 0.8  # reversed if the slope is below and the correlation above these


def moving_frames(frames: Iterable[Frame], theta: Callable[[float], float]) -> list[Frame]:
    """Some of the first frames whose logged angles differ."""
    kept: list[Frame] = []
    began = time.monotonic()
    for frame in frames:
        angles = [theta(other.t) for other in kept]
        if all(abs(theta(frame.t) - angle) > APART for angle in angles):
            kept.append(frame)
            angles.append(theta(frame.t))
        if len(kept) == MOST or (len(kept) >= FEWEST and np.ptp(angles) > ENOUGH):
            break
        if time.monotonic() - began > SIGN_PATIENCE:
            break
    return kept


def check_sign(frames: Iterable[Frame], geometry: Geometry, theta: Callable[[float], float]) -> None:
    """Raises InputError if the root turns against the log; does nothing if the frames cannot show it."""
    logged: list[float] = []
    seen: list[float] = []
    polarities: tuple[float, ...] = (1.0, -1.0)
    for frame in moving_frames(frames, theta):
        where = locate(frame.image, geometry, np.zeros(SHARED), None, polarities)
        if where.score < LEAST_SIGN_SCORE:
            continue
        polarities = (where.polarity,)
        sight = EdgeLook(blur=1.2, polarity=where.polarity, contrast=8.0)
        begin = np.append(where.x, 0.0)
        reach = 3.0 * max(geometry.length / 120.0, 1.0) + 6.0
        picture, arm = Exposure(frame.image, frame.t, 0.0, ShapeMotion()), TrackedArm(geometry, 0.0, np.zeros(SHARED))
        fit = refine(picture, arm, begin, sight, (reach, 8.0, 5.0))
        if fit is not None:
            logged.append(theta(frame.t))
            seen.append(float(fit.x[0]))
    if len(seen) < FEWEST - 1 or np.ptp(logged) < 2 * APART:
        return
    angles = np.array(logged) - np.mean(logged)
    root = np.unwrap(np.array(seen, dtype=float))
    root -= root.mean()
    slope = float(angles @ root / (angles @ angles))
    alike = float(angles @ root / np.sqrt((angles @ angles) * max(float(root @ root), 1e-12)))
    if slope < REVERSED and alike < -ALIKE:
        raise InputError(
            f"the arm's root turns {slope:+.1f} rad a rad of the servo's log",
            field="motor.csv angle_rad",
            expected="mirrored = true in [camera] of recording.toml (x then points the other way in the picture),"
            " or the log with the other sign",
        )

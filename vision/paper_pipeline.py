"""The paper's image analysis (Fig. 3): binarise, largest contour, mean axis, least squares over a grid of (q1, q2).

It is the baseline for the edge fit. It states no uncertainty and accepts every frame with a contour.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.recording import Camera, Declaration
from tentacle.signals import Array, MotorSignal, ShapeTrack
from vision.frames import read_frames
from vision.silhouette import mean_axis, silhouette

AXIS_POINTS = 41
Q1_GRID = np.linspace(-3.0, 3.0, 241)  # rad: steps of 25 mrad
Q2_GRID = np.linspace(-6.0, 6.0, 241)  # rad: steps of 50 mrad


@dataclass(frozen=True)
class PaperSteps:
    """The steps of the method for one frame: image and binary (H, W) uint8, contour (C, 2) [px], axis and fitted
    (AXIS_POINTS, 2) [m] in the base frame, and q (2,) [rad] of the fit.
    """

    image: NDArray[np.uint8]
    binary: NDArray[np.uint8]
    contour: Array
    axis: Array
    fitted: Array
    q: Array


class GridSearch:
    """Model axes (eq. 3, affine) on the whole grid, in units of the arm's length and in the frame of the base."""

    def __init__(self) -> None:
        v = np.linspace(0.0, 1.0, 4 * (AXIS_POINTS - 1) + 1)
        q1, q2 = np.meshgrid(Q1_GRID, Q2_GRID, indexing="ij")
        self.q = np.stack([q1.ravel(), q2.ravel()], axis=1)
        alpha = self.q[:, :1] * v + 0.5 * self.q[:, 1:] * v**2  # eq. (2)
        step = np.stack([-np.sin(alpha), np.cos(alpha)], axis=2)
        middle = 0.5 * (step[:, 1:] + step[:, :-1]) * (v[1] - v[0])
        axes = np.concatenate([np.zeros((len(self.q), 1, 2)), np.cumsum(middle, axis=1)], axis=1)[:, ::4]
        self._flat = axes.reshape(len(self.q), -1).astype(np.float32)
        self._square = np.sum(self._flat**2, axis=1)

    def best(self, axis: Array) -> Array:
        """(q1, q2) [rad] of the grid point with the least squared distance from axis (AXIS_POINTS, 2) [lengths]."""
        return self.q[self._nearest(axis)]

    def _nearest(self, axis: Array) -> int:
        return int(np.argmin(self._square - 2.0 * (self._flat @ axis.ravel().astype(np.float32))))

    def fitted(self, axis: Array) -> Array:
        """The model axis (AXIS_POINTS, 2) [lengths] of that grid point."""
        return self._flat[self._nearest(axis)].reshape(-1, 2).astype(float)


def paper_axis(image: NDArray[np.uint8], camera: Camera) -> Array | None:
    """Mean axis (AXIS_POINTS, 2) [m] in the base frame, from base to tip; None where there is no contour.

    The base's end is where the contour comes nearest to the declared base, the tip where it is farthest along.
    """
    seen = silhouette(image)
    if seen is None:
        return None
    contour = seen.contour
    base = int(np.argmin(np.linalg.norm(contour - np.asarray(camera.base_px), axis=1)))
    tip = int(np.argmax(np.linalg.norm(contour - np.asarray(camera.base_px), axis=1)))
    if base == tip:
        return None
    axis = mean_axis(contour, base, tip, points=AXIS_POINTS)
    return camera.to_base_frame(axis.points)


def rotated(points: Array, angle: float) -> Array:
    """Points (P, 2) turned about the base by angle [rad], from x towards y."""
    cos, sin = np.cos(angle), np.sin(angle)
    return points @ np.array([[cos, sin], [-sin, cos]])


def paper_steps(video: Path, declaration: Declaration, motor: MotorSignal | None, at: float) -> PaperSteps:
    """The steps of Fig. 3 on the frame nearest to `at` [s]. InputError where that frame shows no contour, or where the
    film has ended before.
    """
    if declaration.camera is None:
        raise InputError("the declaration has no camera", field="camera", expected="[camera] in recording.toml")
    frame = None
    for frame in read_frames(Path(video), declaration.camera.fps):
        if frame.t >= at - 0.5 / declaration.camera.fps:
            break
    if frame is not None and frame.t < at - 0.5 / declaration.camera.fps:
        raise InputError(f"{at:g} s is after the last frame", field="at", expected=f"up to {frame.t:.3g} s")
    if frame is None:
        raise InputError("has no frames", file=video, expected="a video")
    seen, axis = silhouette(frame.image), paper_axis(frame.image, declaration.camera)
    if seen is None or axis is None:
        raise InputError(f"no contour at {frame.t:.2f} s", file=video, expected="a frame that shows the arm")
    kind = cv2.THRESH_BINARY_INV if seen.polarity > 0 else cv2.THRESH_BINARY
    _, binary = cv2.threshold(frame.image, 0, 255, kind | cv2.THRESH_OTSU)
    theta = 0.0 if motor is None else float(np.interp(frame.t, motor.t, motor.angle))
    search, length = GridSearch(), declaration.specimen.length
    aligned = rotated(axis, -theta) / length
    fitted = rotated(length * search.fitted(aligned), theta)
    return PaperSteps(frame.image, np.asarray(binary, np.uint8), seen.contour, axis, fitted, search.best(aligned))


def bent_instant(video: Path, declaration: Declaration, motor: MotorSignal | None) -> float:
    """Time [s] of a frame with much bend: the 95th percentile of the tip's angle |q1 + q2 / 2| (the top may be a slip).

    InputError where no frame shows a contour.
    """
    shape = paper_track(video, declaration, motor)
    seen = np.flatnonzero(shape.accepted)
    if not seen.size:
        raise InputError("no contour in any frame", file=video, expected="frames that show the arm")
    bend = np.abs(shape.coefficients[seen, 1] + 0.5 * shape.coefficients[seen, 2])
    return float(shape.t[seen[np.argsort(bend)[int(0.95 * (seen.size - 1))]]])


def paper_track(video: Path, declaration: Declaration, motor: MotorSignal | None) -> ShapeTrack:
    """Affine shapes of every frame by the paper's method; the covariance is NaN, as the method states none."""
    if declaration.camera is None:
        raise InputError("the declaration has no camera", field="camera", expected="[camera] in recording.toml")
    search, length = GridSearch(), declaration.specimen.length
    times, rows, reasons = [], [], []
    for frame in read_frames(Path(video), declaration.camera.fps):
        theta = 0.0 if motor is None else float(np.interp(frame.t, motor.t, motor.angle))
        axis = paper_axis(frame.image, declaration.camera)
        times.append(frame.t)
        reasons.append("" if axis is not None else "no contour")
        if axis is None:
            rows.append([np.nan] * 3)
            continue
        rows.append([0.0, *search.best(rotated(axis, -theta) / length)])  # in the frame that turns with the servo
    return ShapeTrack(
        t=np.array(times),
        coefficients=np.array(rows),
        covariance=np.full((len(rows), 3, 3), np.nan),
        accepted=np.array([not reason for reason in reasons]),
        reason=tuple(reasons),
        scale=1.0,
        scale_sigma=np.nan,
        base_shift=np.zeros(2),
    )

"""A camera for a plain video: place of the arm's base and scale, from the silhouette in one frame."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.recording import Camera
from tentacle.signals import Array
from tentacle.specimen import Specimen
from vision.kinematics import SHARED, Geometry
from vision.locate import locate
from vision.silhouette import Silhouette, find_ends, mean_axis, silhouette

LEAST_GUESS_SCORE = 0.45
LEAST_ASPECT = 2.5  # least length over width of an arm
OTHER_BODY = 0.4  # of the arm's area: a second slender body of that size is another arm


def guess_camera(image: NDArray[np.uint8], specimen: Specimen, fps: float, exposure: float = 0.0) -> Camera:
    """A camera with the arm's base in this frame as origin, the picture's down as y, and a scale from the arm's length.

    For a video of an arm in full view whose base is not hidden in a clamp of the same grey; tracking then improves on
    base and scale. Raises InputError where no arm is found, or two.
    """
    found: tuple[float, Camera, Silhouette, NDArray[np.uint8]] | None = None
    for picture in (image, _even_light(image)):
        for polarity in (1.0, -1.0):
            seen = silhouette(picture, polarity)
            camera = None if seen is None else _camera_of(seen, specimen, fps, exposure)
            if seen is None or camera is None:
                continue
            where = locate(image, Geometry.declared(specimen, camera), np.zeros(SHARED), None, (polarity,))
            if found is None or where.score > found[0]:
                found = (where.score, camera, seen, picture)
    if found is None or found[0] < LEAST_GUESS_SCORE:
        raise InputError(
            "no arm stands out against its ground",
            field="camera",
            expected="--base-px and --m-per-px, or an arm in view",
        )
    if _bodies_like_it(found[3], found[2]) > 1:
        raise InputError("there are two arms in view", field="camera", expected="--base-px of the one to follow")
    return found[1]


def _even_light(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The picture over its own slow light: a wide median of a small copy."""
    shrink = max(max(image.shape) // 160, 1)
    small = cv2.resize(image, None, fx=1.0 / shrink, fy=1.0 / shrink, interpolation=cv2.INTER_AREA)
    slow = cv2.GaussianBlur(cv2.medianBlur(small, 51), (0, 0), 8.0)
    light = cv2.resize(slow, image.shape[::-1], interpolation=cv2.INTER_LINEAR).astype(np.float32)
    return np.clip(128.0 * image / np.maximum(light, 1.0), 0, 255).astype(np.uint8)


def _camera_of(seen: Silhouette, specimen: Specimen, fps: float, exposure: float) -> Camera | None:
    """The tip is the sharper end; the middle of the base lies half the perimeter away from it."""
    contour = seen.contour
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(np.vstack([contour, contour[:1]]), axis=0), axis=1))])
    best: tuple[float, Camera] | None = None
    for tip in find_ends(contour):
        opposite = np.mod(arc[tip] + 0.5 * arc[-1], arc[-1])
        base = int(np.argmin(np.abs(arc[:-1] - opposite)))
        if abs(base - tip) < 5:
            continue
        axis = mean_axis(contour, base, tip)
        if axis.length < LEAST_ASPECT * np.median(axis.width):
            continue
        misfit = _width_misfit(axis.width, axis.length, specimen)
        camera = Camera(
            fps,
            specimen.length / axis.length,
            base_px=(float(contour[base, 0]), float(contour[base, 1])),
            arm_px=(0.0, 1.0),
            exposure=exposure,
        )
        if best is None or misfit < best[0]:
            best = (misfit, camera)
    return None if best is None else best[1]


def _width_misfit(width: Array, length: float, specimen: Specimen) -> float:
    """Relative difference of the silhouette's width, base to tip, from the declared one."""
    s = np.linspace(0.0, 1.0, len(width))[5:-5]
    declared = 2.0 * specimen.section.half_thickness(s) * length / specimen.length
    return float(np.mean(np.abs(width[5:-5] - declared)) / np.mean(declared))


def _bodies_like_it(picture: NDArray[np.uint8], arm: Silhouette) -> int:
    """Number of slender bodies whose area is a good part of the arm's, the arm included."""
    shown = picture if arm.polarity > 0 else cv2.bitwise_not(picture)
    _, mask = cv2.threshold(cv2.GaussianBlur(shown, (0, 0), 1.0), 0, 255, cv2.THRESH_BINARY_INV | cv2.THRESH_OTSU)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    count = 0
    for contour in contours:
        area, around = cv2.contourArea(contour), cv2.arcLength(contour, True)
        # a body of length l and width w has area l w and perimeter 2 l, nearly
        count += area > OTHER_BODY * arm.area and around**2 > 4.0 * LEAST_ASPECT * area * 1.5
    return count

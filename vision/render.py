"""Test videos of a tentacle in a tank, rendered from a midline. They share no code with the fit that they test.

The outline is that of eq. (4), the midline plus and minus the half thickness along its normal, its end flat or rounded.
Coverage is exact on the pixel grid, smear is the mean over the exposure: a frame's truth is known far below 0.01 px.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from tentacle.errors import InputError
from tentacle.recording import Camera
from tentacle.signals import Array, Midline
from tentacle.specimen import Specimen
from vision.coverage import blurred_coverage
from vision.looks import Look
from vision.scenery import Scenery, frame_faults

OPTICAL_BLUR_SHARE = 0.5  # px, part of the lens' blur that acts on the arm before the pixels; the rest acts after them
ROUND_POINTS = 40  # of the outline, on either side of a rounded tip
SMEAR_STEP = 0.7  # px, largest motion of an outline point between two instants of one exposure


def frame_times(t: Array, look: Look, seed: int) -> Array:
    """Time stamps of the frames that render yields for times t (T,): those of the dropped frames are left out."""
    return np.asarray(t, dtype=float)[~frame_faults(len(t), look, seed)[0]]


def bend_by_lens(px: Array, size: tuple[int, int], look: Look) -> Array:
    """The points px (..., 2) of an ideal picture, moved by lens and water: one radial term, r (1 + k (r/R)^2)."""
    centre = 0.5 * (np.array(size, dtype=float) - 1.0)
    offset = px - centre
    relative = np.sum(offset**2, axis=-1, keepdims=True) / np.sum((0.5 * np.array(size, dtype=float)) ** 2)
    return centre + offset * (1.0 + (look.lens + look.refraction) * relative)


class _Arm:
    """The arm's outline in the picture at any time, from splines over time and arc."""

    def __init__(
        self,
        midline: Midline,
        specimen: Specimen,
        camera: Camera,
        size: tuple[int, int],
        look: Look,
        theta: Array | None,
    ) -> None:
        if not np.all(np.isfinite(midline.xy)):
            raise InputError("a midline with gaps cannot be rendered", field="midline", expected="finite points")
        if len(midline.s) < 4 or midline.s[0] > 1e-9 or midline.s[-1] < 1 - 1e-9:
            raise InputError("the midline is too short", field="midline.s", expected="4 or more points from 0 to 1")
        self.size, self.look, self.camera = size, look, camera
        along = CubicSpline(midline.s, midline.xy, axis=1)
        self.s = np.linspace(0.0, 1.0, int(np.clip(specimen.length / camera.metres_per_px, 60, 600)))
        if specimen.tip_rounding:
            turn = np.linspace(0.0, 0.5 * np.pi, ROUND_POINTS)
            cap = 1.0 - specimen.tip_rounding / specimen.length * (1.0 - np.cos(turn))
            self.s = np.unique(np.concatenate([self.s, cap]))
        self.half = specimen.seen_half_thickness(self.s)[:, None]
        self._centre = self._over_time(midline.t, along(self.s))
        tangents = along(self.s, 1)
        self._tangent = self._over_time(midline.t, tangents)
        angle = np.arctan2(-tangents[:, 0, 0], tangents[:, 0, 1]) if theta is None else np.asarray(theta, dtype=float)
        self._clamp_angle = self._over_time(midline.t, np.unwrap(angle)[:, None])

    @staticmethod
    def _over_time(t: Array, values: Array) -> CubicSpline:
        if len(t) == 1:
            t, values = np.array([t[0], t[0] + 1.0]), np.concatenate([values, values])
        return CubicSpline(t, values, axis=0)

    def outline(self, time: float) -> Array:
        """Closed outline (2 S, 2) in the picture [px]: one side from base to tip, the other back."""
        centre, tangent = self._centre(time), self._tangent(time)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
        sides = np.concatenate([centre + self.half * normal, (centre - self.half * normal)[::-1]])
        return bend_by_lens(self.camera.to_pixels(sides), self.size, self.look)

    def clamp(self, time: float) -> Array:
        """The clamp's block (4, 2) [px]: a little wider than the arm, behind its base, turning with it."""
        centre, angle = self._centre(time)[0], float(self._clamp_angle(time)[0])
        tangent = np.array([-np.sin(angle), np.cos(angle)])
        normal = np.array([tangent[1], -tangent[0]])
        wide, deep = 1.6 * self.half[0, 0], 3.0 * self.half[0, 0]
        corners = [centre + wide * normal, centre - wide * normal]
        corners += [corners[1] - deep * tangent, corners[0] - deep * tangent]
        return bend_by_lens(self.camera.to_pixels(np.array(corners)), self.size, self.look)

    def coverage(self, time: float) -> tuple[Array, Array]:
        """Mean blurred coverage by arm and by clamp over the exposure centred on time; each (height, width)."""
        arm = self._smeared(self.outline, time)
        return arm, self._smeared(self.clamp, time) if self.look.clamp else np.zeros_like(arm)

    def _smeared(self, outline: Callable[[float], Array], time: float) -> Array:
        exposure = self.camera.exposure
        moved = np.abs(outline(time + 0.5 * exposure) - outline(time - 0.5 * exposure)).max()
        count = 1 if exposure == 0 else max(1, int(np.ceil(moved / SMEAR_STEP)))
        instants = time + exposure * ((np.arange(count) + 0.5) / count - 0.5)
        return blurred_coverage(
            [outline(instant) for instant in instants], self.size, min(self.look.blur, OPTICAL_BLUR_SHARE)
        )


@dataclass(frozen=True)
class RenderSettings:
    """size (width, height) [px], look of the tank, seed of noise and scenery."""

    size: tuple[int, int]
    look: Look
    seed: int


class Renderer:
    """Arm and tank together: the mean picture of a frame, and the frame with noise and coding.

    Arguments as those of render.
    """

    def __init__(
        self, midline: Midline, specimen: Specimen, camera: Camera, filming: RenderSettings, theta: Array | None = None
    ) -> None:
        self.look = filming.look
        self._arm = _Arm(midline, specimen, camera, filming.size, filming.look, theta)
        self._scenery = Scenery(filming.look, filming.size, filming.seed)

    def coverage(self, time: float) -> Array:
        """The arm's mean coverage over the exposure (height, width), through a first share of the lens' blur."""
        return self._arm.coverage(time)[0]

    def mean(self, time: float, shown: Array | None = None) -> Array:
        """A frame without noise: ground with specks, arm, clamp, bubbles in front, light, the lens' blur. shown:
        another coverage instead of the arm's, with bubbles and mirror image of the arm itself.
        """
        look, scenery = self.look, self._scenery
        covered, clamped = self._arm.coverage(time)
        scene = scenery.ground(time)
        if look.reflection > 0:
            scene += look.reflection * (look.arm_level - look.ground_level) * scenery.mirror(covered)
        scene += (covered if shown is None else shown) * (look.arm_level - scene)
        scene += clamped * (0.6 * look.arm_level - scene)
        scenery.put_in_front(scene, self._arm.outline(time), time)
        scene *= scenery.light
        rest = np.sqrt(max(look.blur**2 - OPTICAL_BLUR_SHARE**2, 0.0))
        return np.asarray(cv2.GaussianBlur(scene, (0, 0), rest) if rest > 0 else scene, dtype=float)

    def frame(self, time: float, rng: np.random.Generator) -> NDArray[np.uint8]:
        """A frame as the camera gives it: with noise, whole greys, and compression."""
        scene = self.mean(time)
        scene += self.look.noise * rng.standard_normal(scene.shape, dtype=np.float32)
        image = np.clip(np.rint(scene), 0, 255).astype(np.uint8)
        if self.look.jpeg_quality:
            packed = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, self.look.jpeg_quality])[1]
            image = np.asarray(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE), dtype=np.uint8)
        return image


def render(
    midline: Midline, specimen: Specimen, camera: Camera, filming: RenderSettings, theta: Array | None = None
) -> Iterator[NDArray[np.uint8]]:
    """Yield a grey frame (height, width) for each time of frame_times(midline.t, look, seed).

    midline is the truth, in the base frame; theta (T,) [rad] turns the clamp (absent: the
    clamp follows the midline's first tangent). A frame's time is the middle of its
    exposure. A duplicated frame shows the one before under its own time stamp. The same seed gives the same frames;
    each frame has its own random stream. Raises InputError on a midline with gaps or one that does not reach from base
    to tip.
    """
    renderer = Renderer(midline, specimen, camera, RenderSettings(filming.size, filming.look, filming.seed), theta)
    dropped, duplicated = frame_faults(len(midline.t), filming.look, filming.seed)
    image: NDArray[np.uint8] | None = None
    for index, time in enumerate(midline.t):
        if dropped[index]:
            continue
        if image is None or not duplicated[index]:
            image = renderer.frame(float(time), np.random.default_rng([filming.seed, index]))
        yield image

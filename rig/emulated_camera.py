"""A camera in front of the emulated tank, with exposure, latency, jitter and flash; the truth is known."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from rig.camera import Image
from rig.emulator import ARM_POINTS, Truth, read_past, read_truth
from rig.host_time import HostTime
from tentacle.errors import InputError
from tentacle.recording import Camera as CameraDeclaration
from tentacle.recording import Declaration
from tentacle.signals import Array
from vision.coverage import polygon_coverage

GROUND, ARM = 200.0, 40.0  # grey


@dataclass(frozen=True)
class EmulatedOptics:
    """fps [1/s], exposure [s], latency [s] from the end of exposure to arrival, jitter [s] of it (standard deviation),
    size (width, height) [px], radii (24,) [m] of the arm that is drawn, base to tip. stall: (from, to) [s] without
    frames.
    """

    declaration: CameraDeclaration
    radii: tuple[float, ...]
    latency: float = 0.045
    jitter: float = 0.0015
    size: tuple[int, int] = (320, 240)
    stall: tuple[float, float] = (np.inf, np.inf)
    seed: int = 1

    @classmethod
    def of(cls, declared: Declaration) -> EmulatedOptics:
        """A camera in front of the declared arm. InputError where no camera is declared."""
        if declared.camera is None:
            raise InputError("an emulated camera needs the declaration's camera", field="recording.camera")
        return cls(
            declared.camera, tuple(declared.specimen.section.half_thickness(np.linspace(0, 1, ARM_POINTS)).tolist())
        )

    @property
    def offset(self) -> float:
        """The true offset for a calibration: arrival after the middle of exposure [s]."""
        return self.latency + 0.5 * self.declaration.exposure


class EmulatedSource:
    """Films the emulator's truth file."""

    def __init__(self, trace: Path, optics: EmulatedOptics, host_time: HostTime) -> None:
        self._trace, self._optics, self._time = trace, optics, host_time
        self._random = np.random.default_rng(optics.seed)
        draw_picture(np.zeros((ARM_POINTS, 2)), 0.0, optics)  # the drawing is compiled before the first frame is due
        self._start, self._count = host_time.now(), 0
        self._previous: tuple[float, float] | None = None

    def read(self) -> tuple[Image, float]:
        """The next frame: drawn when its exposure has ended, stamped with its latency."""
        optics = self._optics
        while True:
            opened = self._start + self._count / optics.declaration.fps
            closed = opened + optics.declaration.exposure
            self._count += 1
            # The truth is written every millisecond.
            self._time.wait(closed + 0.004 * self._time.rate - self._time.now())
            if optics.stall[0] <= opened - self._start < optics.stall[1]:
                continue
            truth = read_truth(self._trace)
            middle = truth.board_time(0.5 * (opened + closed) / self._time.rate)
            try:
                image = draw_picture(read_past(self._trace, middle), self._lit(truth, opened, closed), optics)
            except InputError:
                continue  # a computer too busy to draw it in time drops the frame, as a camera would
            return image, closed + optics.latency + float(self._random.normal(0.0, optics.jitter))

    def close(self) -> None:
        """Nothing to let go."""

    def _lit(self, truth: Truth, opened: float, closed: float) -> float:
        """The share of the exposure during which the LED was on."""
        begin, end = (1e6 * truth.board_time(t / self._time.rate) for t in (opened, closed))
        on, off = truth.led_on_us, truth.led_off_us
        if on < 0:
            return 0.0
        lit_until = off if off >= on else end
        return float(np.clip(min(end, lit_until) - max(begin, on), 0.0, None) / max(end - begin, 1.0))


def draw_picture(points: Array, lit: float, optics: EmulatedOptics) -> Image:
    """A grey picture (height, width): dark arm on light ground, an LED in the corner. points (24, 2) [m] in the base
    frame. A pixel's grey is the share of it that the arm covers; the arm ends flat at the last point.
    """
    image = GROUND - (GROUND - ARM) * polygon_coverage(_outline(points, optics), optics.size)
    picture = np.round(image).astype(np.uint8)
    cv2.circle(picture, (optics.size[0] - 16, 16), 9, int(60 + 195 * lit), -1)
    return picture


def _outline(points: Array, optics: EmulatedOptics) -> Array:
    """The arm's outline (48, 2) [px]: one side to the tip, the other side back."""
    pixels = optics.declaration.to_pixels(points)
    along = np.gradient(pixels, axis=0)
    across = np.column_stack([-along[:, 1], along[:, 0]]) / np.maximum(np.linalg.norm(along, axis=1), 1e-9)[:, None]
    half = across * (np.array(optics.radii) / optics.declaration.metres_per_px)[:, None]
    return np.concatenate([pixels + half, (pixels - half)[::-1]])

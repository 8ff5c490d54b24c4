"""A recording: the declaration of a run, and its measured signals."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from tentacle.declared import Uncertain
from tentacle.notebook import html_paragraph, html_table
from tentacle.signals import (
    AccelerationSignal,
    Array,
    BaseTravel,
    LoadCellSignal,
    Markers,
    Midline,
    MotorSignal,
    ShapeTrack,
    StrainSignal,
    Video,
)
from tentacle.specimen import AIR, HANGING_DOWN, Fluid, Gravity, Specimen


@dataclass(frozen=True)
class Camera:
    """The camera as declared: fps [1/s], scale [m/px], base_px (2,) and arm_px (2,) unit vector along the straight arm.

    u is to the right, v down. n is (arm_v, -arm_u), or its opposite where mirrored. exposure [s].
    """

    fps: float
    metres_per_px: float
    base_px: tuple[float, float]
    arm_px: tuple[float, float]
    exposure: float = 0.0
    mirrored: bool = False

    @property
    def normal_px(self) -> tuple[float, float]:
        """The normal n in the image."""
        sign = -1.0 if self.mirrored else 1.0
        return (sign * self.arm_px[1], -sign * self.arm_px[0])

    def to_pixels(self, xy: Array) -> Array:
        """Base frame (..., 2) [m] to image (..., 2) [px]."""
        axes = np.array([self.normal_px, self.arm_px])
        return np.asarray(self.base_px) + (xy / self.metres_per_px) @ axes

    def to_base_frame(self, px: Array) -> Array:
        """Image (..., 2) [px] to base frame (..., 2) [m]."""
        axes = np.array([self.normal_px, self.arm_px])
        return ((np.asarray(px) - np.asarray(self.base_px)) @ axes.T) * self.metres_per_px


@dataclass(frozen=True)
class Declaration:
    """The declaration of a recording (recording.toml): arm, fluid, gravity, camera. release_t [s]: held still until
    then (a free decay).

    seen_from: of a base that travels, whether positions are counted from the ground or from the base itself.
    out_of_plane: rms share of a spatial arm's motion that leaves the plane of the recorded points (None: not known).
    uncertain: the numbers that are not known exactly; the other fields have their means.
    """

    specimen: Specimen
    fluid: Fluid = AIR
    gravity: Gravity = HANGING_DOWN
    camera: Camera | None = None
    motor_mode: Literal["prescribed", "servo"] = "prescribed"
    release_t: float | None = None
    seen_from: Literal["ground", "base"] = "ground"
    out_of_plane: float | None = None
    uncertain: tuple[Uncertain, ...] = ()


@dataclass(frozen=True)
class Recording:
    """A run: its declaration and every measured signal; None for a signal that was not measured."""

    name: str
    declaration: Declaration
    motor: MotorSignal | None = None
    load_cell: LoadCellSignal | None = None
    midline: Midline | None = None
    markers: Markers | None = None
    video: Video | None = None
    shape: ShapeTrack | None = None
    travel: BaseTravel | None = None
    strain: StrainSignal | None = None
    acceleration: AccelerationSignal | None = None
    notes: dict[str, str] = field(default_factory=dict)

    @property
    def logs(self) -> dict[str, MotorSignal | BaseTravel | LoadCellSignal | StrainSignal | AccelerationSignal]:
        """What was measured beside the pictures, by the name of its file in an import folder."""
        every = {
            "motor": self.motor, "base": self.travel, "load_cell": self.load_cell, "strain": self.strain,
            "acceleration": self.acceleration,
        }  # fmt: skip
        return {name: signal for name, signal in every.items() if signal is not None}

    def _repr_html_(self) -> str:
        """The measured signals, for notebooks: each with its number of samples and its time span."""
        rows = []
        for signal in ("motor", "travel", "load_cell", "midline", "markers", "strain", "acceleration", "shape"):
            measured = getattr(self, signal)
            if measured is not None:
                t = measured.t
                rows.append((signal.replace("_", " "), str(len(t)), f"{t[0]:.2f} to {t[-1]:.2f} s"))
        if self.video is not None:
            rows.append(("video", "-", self.video.path.name))
        length = 1e3 * self.declaration.specimen.length
        title = html_paragraph(f"Recording {self.name} of an arm of {length:.0f} mm")
        return title + html_table(("signal", "samples", "time"), rows)

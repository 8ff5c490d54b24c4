"""A sensor on the arm that is read beside the pictures, and the two kinds of them.

    strain(t) = d / L  mean over the gauge of  d psi / ds,        psi: the turn of the sections
    f(t) = (r''(s, d) - g) . axis,                                axis: n or t there, as it was glued

Each reading is that, plus a zero that is an unknown of the recording, plus noise.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from affine_model.acceleration_beside import specific_force
from affine_model.curvature import Array
from inference.appearance import Appearance
from inference.frame_readings import FAST, SLOW, Taking
from inference.latent_force import ACCELERATION_SHARE, ACCELERATION_TIME, LAW_KNOWN, SHAPE_SHARE, SHAPE_TIME
from tentacle.diagnosis import Quantity
from tentacle.signals import Accelerometer, StrainGauge

SENSOR_SIZE = 0.01  # m along the arm: one end of an accelerometer that lies higher by a marker's error turns its axes


@dataclass(frozen=True)
class Sensor(ABC):
    """One channel beside the pictures: its name, and sigma, the standard deviation of one value at a frame.

    quantity: the signal of the recording that holds it. moves: whether it must know how the arm moves. taking: how its
    readings are taken together. least: the smallest noise that is found between readings. error: floor, share
    and time of its own slow error, the first two as parts of what it reads (inference.latent_force.SeenError).
    """

    name: str
    sigma: float
    quantity: ClassVar[Quantity]
    kind: ClassVar[str]
    moves: ClassVar[bool]
    noise_words: ClassVar[str]
    taking: ClassVar[Taking]
    least: ClassVar[float]
    error: ClassVar[tuple[float, float, float]]

    @property
    def label(self) -> str:
        """Its kind and name."""
        return f"{self.kind} {self.name}"

    @abstractmethod
    def read(self, seen: Appearance, length: float) -> Array:
        """What it reads (T, B) of an arm of that length [m], were its zero 0; NaN where that is not known."""

    @abstractmethod
    def moved(self, step: float, length: float) -> tuple[Self, ...]:
        """The same sensor in each other place that differs by `step` [m], along and across the arm."""

    @abstractmethod
    def declared_as(self, values: Mapping[str, float]) -> Self:
        """The sensor at the place that `values` states (`strain.NAME.s`)."""


@dataclass(frozen=True)
class Gauge(Sensor):
    """A strain gauge."""

    gauge: StrainGauge
    quantity = "strain"
    kind = "gauge"
    moves = False
    noise_words = "a strain of {:.2g}"
    taking = SLOW
    least = 1e-9
    error = (0.0, SHAPE_SHARE, SHAPE_TIME)

    def read(self, seen: Appearance, length: float) -> Array:
        return mean_curvature(self.gauge.ends(length), seen.bending()) * (self.gauge.d / length)

    def moved(self, step: float, length: float) -> tuple[Self, ...]:
        one = self.gauge
        return tuple(
            replace(self, gauge=g) for g in (replace(one, s=one.s + step / length), replace(one, d=one.d + step))
        )

    def declared_as(self, values: Mapping[str, float]) -> Self:
        s, d = (values.get(f"strain.{self.name}.{key}", getattr(self.gauge, key)) for key in ("s", "d"))
        return replace(self, gauge=replace(self.gauge, s=s, d=d))


@dataclass(frozen=True)
class AccelerometerAxis(Sensor):
    """One axis of an accelerometer, turned by tilt [rad] from where it was declared."""

    sensor: Accelerometer
    tilt: float = 0.0
    quantity = "acceleration"
    kind = "accelerometer"
    moves = True
    noise_words = "{:.2g} m/s^2"
    taking = FAST
    least = 1e-6
    error = (LAW_KNOWN, ACCELERATION_SHARE, ACCELERATION_TIME)

    def read(self, seen: Appearance, length: float) -> Array:
        turning = seen.turning()
        if turning is None or seen.motion is None:
            return np.full(seen.theta.shape, np.nan)
        normal, tangent = specific_force(turning, seen.motion.pull, length, (self.sensor.s, self.sensor.d))
        along, across = (normal, tangent) if self.sensor.axis == "normal" else (tangent, -normal)
        return np.asarray(np.cos(self.tilt) * along + np.sin(self.tilt) * across)

    def moved(self, step: float, length: float) -> tuple[Self, ...]:
        one = self.sensor
        tilted = replace(self, tilt=self.tilt + step / SENSOR_SIZE)
        return (
            replace(self, sensor=replace(one, s=one.s + step / length)),
            replace(self, sensor=replace(one, d=one.d + step)),
            tilted,
        )

    def declared_as(self, values: Mapping[str, float]) -> Self:
        s, d = (values.get(f"acceleration.{self.name}.{key}", getattr(self.sensor, key)) for key in ("s", "d"))
        return replace(self, sensor=replace(self.sensor, s=s, d=d))


def mean_curvature(ends: tuple[float, float], q: Array) -> Array:
    """Mean of the curvature (T, B) over that part of the arm, for q (T, n, B); at a point where both ends are one."""
    j = np.arange(1, q.shape[1] + 1)
    first, last = ends
    row = first ** (j - 1.0) if last <= first else (last**j - first**j) / (j * (last - first))
    return np.einsum("j,tjb->tb", row, q)

"""Pictures of an arm with the readings of sensors on it beside them (inference.sensor).

    R (value - reading of the model - zero) ~ N(0, 1)

A sensor's zero is an unknown of the recording. Its readings are taken at the frames (inference.frame_readings). An
accelerometer does not count where the acceleration of the model jumps: at the release, and at the ends of what is known
of the base, which stands still before and after.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from inference.appearance import Appearance
from inference.frame_readings import at_frames
from inference.noise_floor import noise_deviation
from inference.observation import Observation, ShapeObservation
from inference.sensor import AccelerometerAxis, Gauge, Sensor
from tentacle.errors import InputError
from tentacle.recording import Recording

ABRUPT = 0.1  # s beside such a jump: the differences of a run reach over six of the coarsest steps, 1/75 s


@dataclass(frozen=True)
class SensedObservation(Observation):
    """Pictures, and the values (T, G) of G sensors at their frames, NaN where there is none."""

    pictures: Observation
    own: tuple[Sensor, ...]
    values: Array

    @property
    def sigma(self) -> Array:
        """Standard deviation (G,) of a value."""
        return np.array([sensor.sigma for sensor in self.own])

    @property
    def seen(self) -> NDArray[np.bool_]:
        return self.pictures.seen

    @property
    def channels(self) -> int:
        return self.pictures.channels + len(self.own)

    @property
    def order(self) -> int:
        return self.pictures.order

    @property
    def tracked(self) -> bool:
        return self.pictures.tracked

    @property
    def shapes(self) -> ShapeObservation | None:
        return self.pictures.shapes

    @property
    def beside(self) -> Array | None:
        return self.pictures.beside

    @property
    def sensors(self) -> tuple[Sensor, ...]:
        return self.own

    @property
    def zero_size(self) -> Array:
        return np.fmax(np.fmax.reduce(np.abs(self.values), axis=0), self.sigma)  # of a part without readings: sigma

    @property
    def readings(self) -> Array:
        return self.values

    def read(self, seen: Appearance) -> Array:
        return np.stack([sensor.read(seen, self.length) for sensor in self.own], axis=1)

    def zero_slopes(self) -> Array:
        return np.where(np.isfinite(self.values), -1.0 / self.sigma, 0.0)

    def moved_places(self, step: float) -> tuple[Self, ...]:
        moved = [
            replace(self, own=(*self.own[:k], one, *self.own[k + 1 :]))
            for k, sensor in enumerate(self.own)
            for one in sensor.moved(step, self.length)
        ]
        return (*(replace(self, pictures=pictures) for pictures in self.pictures.moved_places(step)), *moved)

    def slow_errors(self, frames: NDArray[np.bool_], z: Array) -> Array:
        return self.pictures.slow_errors(frames, z)

    def sensor_errors(self, frames: NDArray[np.bool_]) -> Array:
        read = np.ma.masked_invalid(self.values[frames])
        size = np.asarray(read.std(axis=0).filled(0.0)) / self.sigma
        floor, share, time = np.transpose([sensor.error for sensor in self.own])
        return np.stack([size, floor * size, share, time])

    def points(self, s: Array) -> tuple[Array, Array]:
        return self.pictures.points(s)

    def predict(self, seen: Appearance) -> Array:
        """Whitened residuals (T, K + G, B); 0 where nothing was measured, or the model does not say what is read."""
        shown = self.pictures.predict(seen)
        error = (self.values[:, :, None] - self.read(seen)) / self.sigma[:, None]
        return np.concatenate([shown, np.nan_to_num(error + self.zero_slopes()[:, :, None] * seen.zeros)], axis=1)

    def first(self, count: int) -> Self:
        return self._with(self.pictures.first(count), values=self.values[:count])

    def without(self, frames: NDArray[np.bool_]) -> Self:
        values = np.where(frames[:, None], np.nan, self.values)
        return self._with(self.pictures.without(frames), values=values)

    def later(self, t: Array, theta: Array) -> Observation:
        return self.pictures.later(t, theta)

    def subtract_residual(self, rows: Array) -> Self:
        count = self.pictures.channels
        return self._with(
            self.pictures.subtract_residual(rows[:, :count]), values=self.values - self.sigma * rows[:, count:]
        )

    def declared_as(self, length: float, scale: float, values: Mapping[str, float]) -> Self:
        own = tuple(sensor.declared_as(values) for sensor in self.own)
        return self._with(self.pictures.declared_as(length, scale, values), own=own)

    def with_shapes(self, shapes: ShapeObservation) -> Self:
        return self._with(shapes)

    def motion(self) -> tuple[Array, Array]:
        return self.pictures.motion()

    def changed(self) -> float:
        return self.pictures.changed()

    def root_offset(self) -> tuple[NDArray[np.bool_], Array]:
        return self.pictures.root_offset()

    def _with(self, pictures: Observation, **changes: object) -> Self:
        return replace(self, t=pictures.t, theta=pictures.theta, length=pictures.length, pictures=pictures, **changes)  # type: ignore[arg-type]


@dataclass(frozen=True)
class _Log:
    """What one sensor wrote: the sensor without its noise, the noise that its declaration states (None: none), times
    (N,) [s] and readings (N,).
    """

    sensor: Sensor
    stated: float | None
    t: Array
    readings: Array

    @property
    def field(self) -> str:
        """Its name in messages."""
        return f"{self.sensor.quantity}.{self.sensor.name}"


def with_sensors(pictures: Observation, recording: Recording) -> tuple[Observation, list[str]]:
    """The pictures with what the recording's sensors measured beside them, and words on their noise; as they are where
    there is none.

    InputError where a sensor has no reading while the arm is seen, or too few to find the noise that it does not state.
    """
    logs = _logs(recording)
    if not logs:
        return pictures, []
    at_jump = _at_a_jump(recording, pictures.t)
    words: list[str] = []
    sensors: list[Sensor] = []
    columns: list[Array] = []
    for log in logs:
        column, share = _column(log, pictures, at_jump)
        sigma, found = _noise(log)
        words += found
        sensors.append(replace(log.sensor, sigma=sigma * share))
        columns.append(column)
    values = np.stack(columns, axis=1)
    return SensedObservation(pictures.t, pictures.theta, pictures.length, pictures, tuple(sensors), values), words


def _logs(recording: Recording) -> list[_Log]:
    """The recording's strain gauges, then the axes of its accelerometers."""
    strain, acceleration = recording.strain, recording.acceleration
    logs: list[_Log] = []
    if strain is not None:
        for name, gauge, values in zip(strain.names, strain.gauges, strain.values.T, strict=True):
            logs.append(_Log(Gauge(name, np.nan, gauge), gauge.sigma, strain.t, values))
    if acceleration is not None:
        axes = acceleration.accelerometers
        for name, axis, values in zip(acceleration.names, axes, acceleration.values.T, strict=True):
            logs.append(_Log(AccelerometerAxis(name, np.nan, axis), axis.sigma, acceleration.t, values))
    return logs


def _column(log: _Log, pictures: Observation, at_jump: NDArray[np.bool_]) -> tuple[Array, float]:
    """The sensor's value at every frame (T,), NaN where it does not count, and the share of a reading's noise in it.

    InputError where its readings are too rare, or none counts while the arm is seen.
    """
    taking, there = log.sensor.taking, np.isfinite(log.readings)
    interval = float(np.median(np.diff(log.t[there]))) if there.sum() > 1 else 0.0
    if interval > taking.rarest:
        expected = f"one every {taking.rarest:.2g} s at least"
        raise InputError(f"has a reading every {interval:.3g} s", field=log.field, expected=expected)
    column, share = at_frames(pictures.t, log.t, log.readings, taking)
    column = np.where(log.sensor.moves & at_jump, np.nan, column)
    if not (np.isfinite(column) & pictures.seen).any():
        raise InputError("has no reading while the arm is seen", field=log.field, expected="the same clock")
    return column, share


def _noise(log: _Log) -> tuple[float, list[str]]:
    """Standard deviation of a reading: as stated, or as found between the readings, and then words on that."""
    if log.stated is not None:
        return log.stated, []
    sensor, sigma = log.sensor, max(float(noise_deviation(log.readings)), log.sensor.least)
    if not np.isfinite(sigma):
        raise InputError("has too few readings to find its noise", field=log.field, expected="sigma")
    found = f"{sensor.noise_words.format(sigma)} was found between its readings"
    return sigma, [f"{sensor.kind.capitalize()} {sensor.name} states no noise; {found}."]


def _at_a_jump(recording: Recording, t: Array) -> NDArray[np.bool_]:
    """Which times (T,) [s] lie beside a jump of the model's acceleration."""
    release = recording.declaration.release_t
    jumps = [log.t[[0, -1]] for log in (recording.motor, recording.travel) if log is not None and len(log.t)]
    every = np.concatenate([*jumps, [] if release is None else [release]])
    return np.any(np.abs(t[:, None] - every) < ABRUPT, axis=1)

"""Strain gauges beside the pictures of an arm.

    strain(t) = d / L  mean over the gauge of  d phi / ds  + zero + noise,      phi(s) = theta + sum_j q_j s^j / j

A gauge tells the curvature at one place, up to a constant: its zero is an unknown of the recording. Its readings are
taken at the frames. Where it is read more often than that, each frame has the value of a parabola through the readings
around it; where less often, only the frames next to a reading have one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from affine_model.curvature import Array
from inference.noise_floor import noise_deviation
from inference.observation import Observation, ShapeObservation
from tentacle.errors import InputError
from tentacle.signals import StrainGauge, StrainSignal

FEWEST_READINGS = 5  # in a frame's time, for a parabola through them
LEAST_NOISE = 1e-9  # of a strain


@dataclass(frozen=True)
class GaugedObservation(Observation):
    """Pictures, and the readings of G gauges at their frames: strain (T, G), NaN where there is none; sigma (G,)."""

    pictures: Observation
    names: tuple[str, ...]
    gauges: tuple[StrainGauge, ...]
    strain: Array
    sigma: Array

    @property
    def seen(self) -> NDArray[np.bool_]:
        return self.pictures.seen

    @property
    def channels(self) -> int:
        return self.pictures.channels + len(self.gauges)

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
    def zero_names(self) -> tuple[str, ...]:
        return self.names

    @property
    def zero_size(self) -> Array:
        return np.fmax(np.fmax.reduce(np.abs(self.strain), axis=0), self.sigma)  # of a part without readings: sigma

    @property
    def readings(self) -> Array:
        return self.strain

    def strain_of(self, q: Array) -> Array:
        rows = [mean_curvature(one.ends(self.length), q) * (one.d / self.length) for one in self.gauges]
        return np.stack(rows, axis=1)

    def zero_slopes(self) -> Array:
        return np.where(np.isfinite(self.strain), -1.0 / self.sigma, 0.0)

    def moved_places(self, step: float) -> tuple[Self, ...]:
        own = [
            replace(self, gauges=(*self.gauges[:k], moved, *self.gauges[k + 1 :]))
            for k, one in enumerate(self.gauges)
            for moved in (replace(one, s=one.s + step / self.length), replace(one, d=one.d + step))
        ]
        return (*(replace(self, pictures=moved) for moved in self.pictures.moved_places(step)), *own)

    def slow_errors(self, frames: NDArray[np.bool_], z: Array) -> Array:
        return self.pictures.slow_errors(frames, z)

    def slow_gauge_errors(self, frames: NDArray[np.bool_]) -> Array:
        read = np.ma.masked_invalid(self.strain[frames])
        return np.asarray(read.std(axis=0).filled(0.0)) / self.sigma

    def points(self, s: Array) -> tuple[Array, Array]:
        return self.pictures.points(s)

    def predict(self, q: Array, theta: Array, roll: Array, scale: Array, shift: Array) -> Array:
        """Whitened residuals (T, K + G, B), for gauges whose zero is 0; 0 where nothing was measured."""
        shown = self.pictures.predict(q, theta, roll, scale, shift)
        error = (self.strain[:, :, None] - self.strain_of(q)) / self.sigma[:, None]
        return np.concatenate([shown, np.nan_to_num(error)], axis=1)

    def first(self, count: int) -> Self:
        return self._with(self.pictures.first(count), strain=self.strain[:count])

    def without(self, frames: NDArray[np.bool_]) -> Self:
        strain = np.where(frames[:, None], np.nan, self.strain)
        return self._with(self.pictures.without(frames), strain=strain)

    def subtract_residual(self, rows: Array) -> Self:
        count = self.pictures.channels
        return self._with(
            self.pictures.subtract_residual(rows[:, :count]), strain=self.strain - self.sigma * rows[:, count:]
        )

    def declared_as(self, length: float, scale: float, values: Mapping[str, float]) -> Self:
        gauges = tuple(
            replace(one, s=values.get(f"strain.{name}.s", one.s), d=values.get(f"strain.{name}.d", one.d))
            for name, one in zip(self.names, self.gauges, strict=True)
        )
        return self._with(self.pictures.declared_as(length, scale, values), gauges=gauges)

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


def mean_curvature(ends: tuple[float, float], q: Array) -> Array:
    """Mean of d phi / ds (T, B) over that part of the arm, for q (T, n, B); at a point where both ends are one."""
    j = np.arange(1, q.shape[1] + 1)
    first, last = ends
    row = first ** (j - 1.0) if last <= first else (last**j - first**j) / (j * (last - first))
    return np.einsum("j,tjb->tb", row, q)


def with_gauges(pictures: Observation, strain: StrainSignal | None) -> tuple[Observation, list[str]]:
    """The pictures with what gauges measured beside them, and words on their noise; as they are where there is none.

    InputError where a gauge has no reading while the arm is seen, or too few to find the noise that it does not state.
    """
    if strain is None:
        return pictures, []
    found = [at_frames(pictures.t, strain.t, values) for values in strain.values.T]
    words, sigma = [], []
    for name, gauge, values, (readings, share) in zip(strain.names, strain.gauges, strain.values.T, found, strict=True):
        if not (np.isfinite(readings) & pictures.seen).any():
            raise InputError("has no reading while the arm is seen", field=f"strain.{name}", expected="the same clock")
        own = gauge.sigma
        if own is None:
            own = max(float(noise_deviation(values)), LEAST_NOISE)
            if not np.isfinite(own):
                raise InputError("has too few readings to find its noise", field=f"strain.{name}", expected="sigma")
            words.append(f"Gauge {name} states no noise; a strain of {own:.2g} was found between its readings.")
        sigma.append(own * share)
    observation = GaugedObservation(
        pictures.t, pictures.theta, pictures.length, pictures, strain.names, strain.gauges,
        np.stack([readings for readings, _ in found], axis=1), np.array(sigma),
    )  # fmt: skip
    return observation, words


def at_frames(t: Array, read_at: Array, values: Array) -> tuple[Array, float]:
    """Readings (N,) at read_at (N,) as values (T,) at the frames t (T,), NaN where there is none; and the share of a
    reading's standard deviation that such a value has.
    """
    there = np.isfinite(values)
    read_at, values = read_at[there], values[there]
    found = np.full(t.size, np.nan)
    interval = float(np.median(np.diff(t)))
    if read_at.size < 2:
        return found, 1.0
    if interval < FEWEST_READINGS * float(np.median(np.diff(read_at))):
        middles = 0.5 * (t[1:] + t[:-1])
        near = np.unique(np.searchsorted(middles, read_at[read_at <= t[-1]], side="right"))
        near = near[(t[near] >= read_at[0]) & (t[near] <= read_at[-1])]
        found[near] = PchipInterpolator(read_at, values)(t[near])
        return found, 1.0
    begin, end = np.searchsorted(read_at, t - 0.5 * interval), np.searchsorted(read_at, t + 0.5 * interval)
    shares = []
    for k in np.flatnonzero(end - begin >= FEWEST_READINGS):
        away = (read_at[begin[k] : end[k]] - t[k]) / interval
        weights = np.linalg.pinv(np.vander(away, 3))[2]
        found[k] = weights @ values[begin[k] : end[k]]
        shares.append(np.linalg.norm(weights))
    return found, float(np.median(shares)) if shares else 1.0

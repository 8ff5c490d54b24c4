"""Markers as single points, compared with a model's points beside the axis.

(measured - predicted) / sigma ~ N(0, 1)        of x and of y of each marker
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from affine_model.points_beside import points_beside
from inference.appearance import Appearance
from inference.observation import Observation

FEWEST_COORDINATES = 2  # that markers are taken to show


@dataclass(frozen=True)
class MarkerObservation(Observation):
    """Markers as points: s (M,), d (M,) [m], xy (T, M, 2) [m], sigma [m] of each coordinate, names (M) where they have
    any; NaN rows count nothing.
    """

    s: Array
    d: Array
    xy: Array
    sigma: float
    names: tuple[str, ...] = ()

    @property
    def order(self) -> int:
        return FEWEST_COORDINATES

    @property
    def seen(self) -> NDArray[np.bool_]:
        return np.asarray(np.isfinite(self.xy).any(axis=(1, 2)))

    @property
    def channels(self) -> int:
        return 2 * self.s.size

    @property
    def beside(self) -> Array:
        return self.d

    def moved_places(self, step: float) -> tuple[Self, ...]:
        return tuple(
            moved
            for one in step * np.eye(self.s.size)
            for moved in (replace(self, s=self.s + one / self.length), replace(self, d=self.d + one))
        )

    def slow_errors(self, frames: NDArray[np.bool_], z: Array) -> Array:
        return np.repeat(np.sqrt(np.nanvar(self.xy[frames], axis=0).sum(axis=1)) / self.sigma, 2)

    def points(self, s: Array) -> tuple[Array, Array]:
        """Places s (M,) and the markers (T, M, 2) [m], whatever places were asked for."""
        return self.s, self.xy

    def predict(self, seen: Appearance) -> Array:
        """Whitened residuals (T, 2 M, B); 0 where a marker was not seen."""
        shape = np.moveaxis(seen.q, 1, -1)  # (T, B, n)
        points = points_beside(shape, seen.theta + seen.roll, self.length, self.s, self.d, seen.shear)
        points = points * (1.0 + seen.excess)[:, None, None] + seen.shift.T[:, None, :]
        error = (self.xy[:, None] - points) / self.sigma
        return np.nan_to_num(np.moveaxis(error.reshape(*error.shape[:2], -1), 1, -1))

    def first(self, count: int) -> Self:
        return replace(self, t=self.t[:count], theta=self.theta[:count], xy=self.xy[:count])

    def without(self, frames: NDArray[np.bool_]) -> Self:
        return replace(self, xy=np.where(frames[:, None, None], np.nan, self.xy))

    def later(self, t: Array, theta: Array) -> Self:
        return replace(self, t=t, theta=theta, xy=np.zeros((t.size, *self.xy.shape[1:])))

    def subtract_residual(self, rows: Array) -> Self:
        return replace(self, xy=self.xy - self.sigma * rows.reshape(self.xy.shape))

    def declared_as(self, length: float, scale: float, values: Mapping[str, float]) -> Self:
        s, d = self.s.copy(), self.d.copy()
        for place, name in enumerate(self.names):
            s[place] = values.get(f"markers.{name}.s", s[place])
            d[place] = values.get(f"markers.{name}.d", d[place])
        return replace(self, length=length, s=s, d=d)

    def motion(self) -> tuple[Array, Array]:
        return self.xy.reshape(self.t.size, -1), np.zeros((self.t.size, 0))

    def changed(self) -> float:
        return float(np.max(np.nanstd(self.xy[self.seen], axis=0)) / self.sigma)

"""The residual over arc length and time as a picture: rows are s (base at the top), columns are equal steps of time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tentacle.signals import Array
from viz.scene import Party, ViewedRun

HEAT_COLUMNS = 600
HEIGHT = 320  # about: every point has a band of the same whole number of rows
GAP = np.array([70, 70, 70], dtype=np.uint8)  # not measured


@dataclass(frozen=True)
class HeatMap:
    """Picture (H, W, 3) uint8, its time axis: column = (t - start) / (stop - start) (W - 1), and colour limit [mm]."""

    picture: NDArray[np.uint8]
    start: float
    stop: float
    limit: float

    def column(self, t: Array) -> Array:
        """The column (fractional pixel) at times t [s]."""
        width = self.picture.shape[1]
        return (np.asarray(t) - self.start) / max(self.stop - self.start, 1e-9) * (width - 1)


def colour_limit(scene: ViewedRun) -> float:
    """One limit [mm] for every model's map, so that they can be compared: the first model's 99th percentile."""
    values = scene.residual_mm(scene.models[0])
    values = values[np.isfinite(values)]
    return max(float(np.percentile(values, 99)), 1e-3) if values.size else 1.0


def heat_map(scene: ViewedRun, party: Party, limit: float) -> HeatMap:
    """The map of one model of a scene; each column shows the nearest instant, each row band one point."""
    from matplotlib import colormaps

    from viz.palette import SEQUENTIAL_MAP

    values = scene.residual_mm(party)
    start, stop = float(scene.t[0]), float(scene.t[-1])
    # columns are doubled in short runs: a picture of fixed width keeps every view alike
    nearest = np.searchsorted(0.5 * (scene.t[1:] + scene.t[:-1]), np.linspace(start, stop, HEAT_COLUMNS))
    rows = np.repeat(np.argsort(scene.s, kind="stable"), max(1, round(HEIGHT / len(scene.s))))
    sampled = values[nearest][:, rows].T
    colours = np.asarray(colormaps[SEQUENTIAL_MAP](np.clip(sampled / limit, 0.0, 1.0), bytes=True))[..., :3].copy()
    colours[~np.isfinite(sampled)] = GAP
    return HeatMap(colours.astype(np.uint8), start, stop, limit)

"""The residual over arc length and time as a picture: rows are s (base at the top), columns are equal steps of time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tentacle.diagnosis import RunComparison
from tentacle.signals import Array

COLUMNS = 600
ROW_PIXELS = 8
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


def residual_mm(run: RunComparison, model: Array) -> Array:
    """Distance (T, P) [mm] between measured and modelled points; NaN where not measured."""
    return 1e3 * np.linalg.norm(model - run.measured, axis=-1)


def colour_limit(run: RunComparison) -> float:
    """One limit [mm] for both models' maps, so that they can be compared: the base model's 99th percentile."""
    values = residual_mm(run, run.base)
    values = values[np.isfinite(values)]
    return max(float(np.percentile(values, 99)), 1e-3) if values.size else 1.0


def heat_map(run: RunComparison, model: Array, limit: float) -> HeatMap:
    """The map of one model of a run; each column shows the nearest instant, each row band the nearest point."""
    from matplotlib import colormaps

    from viz.palette import SEQUENTIAL_MAP

    values = residual_mm(run, model)
    start, stop = float(run.t[0]), float(run.t[-1])
    # duplicated columns for short runs: a picture of fixed width keeps every view alike
    times = np.linspace(start, stop, COLUMNS)
    nearest = np.abs(np.searchsorted(0.5 * (run.t[1:] + run.t[:-1]), times))
    order = np.argsort(run.s, kind="stable")
    rows = np.repeat(order, ROW_PIXELS)
    sampled = values[nearest][:, rows].T
    colours = np.asarray(colormaps[SEQUENTIAL_MAP](np.clip(sampled / limit, 0.0, 1.0), bytes=True))[..., :3].copy()
    colours[~np.isfinite(sampled)] = GAP
    return HeatMap(colours.astype(np.uint8), start, stop, limit)

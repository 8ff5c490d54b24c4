"""Cells of averaged frames: the latent force and the slow errors change little within one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from tentacle.compiled import njit

CELLS = 4.5  # cells in the latent force's time: enough to show all of such a force


@dataclass(frozen=True)
class Cells:
    """Frames averaged in cells of equal length: place (F,) of the frames that count, cell (F,) of each among `count`
    cells, weight (F,) = 1 / sqrt(frames in the cell); t (count,) middles and interval [s].
    """

    place: NDArray[np.int64]
    cell: NDArray[np.int64]
    weight: Array
    t: Array
    interval: float

    def averaged(self, rows: Array) -> Array:
        """Rows (T, K, ...) of frames as those of cells (count, K, ...), of unit noise again; 0 in an empty cell."""
        flat = np.ascontiguousarray(rows).reshape(rows.shape[0], -1)
        total = _summed(flat, self.place, self.cell, self.weight, self.t.size)
        return total.reshape(self.t.size, *rows.shape[1:])


def cells_of(t: Array, frames: NDArray[np.bool_], time: float) -> Cells:
    """Cells over the chosen frames, for a latent force of that time [s]."""
    place = np.flatnonzero(frames)
    frame_interval = float(np.median(np.diff(t[place]))) if place.size > 1 else time / CELLS
    interval = frame_interval * max(1, round(time / (CELLS * frame_interval)))
    cell = np.floor((t[place] - t[place[0]]) / interval + 1e-6).astype(np.int64)
    weight = 1.0 / np.sqrt(np.bincount(cell)[cell])
    middles = t[place[0]] + interval * np.arange(cell[-1] + 1.0) + 0.5 * (interval - frame_interval)
    return Cells(place, cell, weight, middles, interval)


@njit(cache=True, nogil=True)
def _summed(rows, place, cell, weight, count):
    """Weighted rows (T, R) at the places, summed in each of `count` cells."""
    total = np.zeros((count, rows.shape[1]))
    for frame in range(place.size):
        row, into = rows[place[frame]], total[cell[frame]]
        for k in range(row.size):
            into[k] += weight[frame] * row[k]
    return total

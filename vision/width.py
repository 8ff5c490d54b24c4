"""Places where an arm does not have its usual width, because something covers or touches one of its sides.

The excess of a station's width is w(s) = offset_left + offset_right, which bending does not change. Its usual course
w_0(s) comes from the film itself. If |w - w_0| is many times its usual scatter, neither side shows the arm's middle.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, median_filter

from tentacle.signals import Array
from vision.edges import Edges
from vision.kinematics import Outline
from vision.robust import STATION_NEIGHBOURS

KNOTS = 12  # stretches of the arm with their own usual width
STRETCH = 9  # stations over which a width is averaged
MANY = 5  # fewest stations for a stretch's width
TIMES, SHARE, LEAST = 6.0, 0.1, 0.6  # usual scatters, of the width, px: beyond them it is another object


def usual_widths(seen: Sequence[tuple[Outline, Edges, Array]]) -> tuple[float, ...]:
    """w_0 (KNOTS,) [px] of outlines, their measured edges and weights (E,): medians over stretches of the arm."""
    stations = [_widths(expected, edges, weight > 0) for expected, edges, weight in seen]
    s, wider = (np.concatenate(parts) for parts in zip(*((at, width) for at, width, _, _ in stations), strict=True))
    whole = float(np.median(wider)) if len(wider) else 0.0
    stretch = np.minimum((s * KNOTS).astype(int), KNOTS - 1)
    return tuple(
        float(np.median(wider[stretch == k])) if np.count_nonzero(stretch == k) >= MANY else whole for k in range(KNOTS)
    )


def another_width(
    expected: Outline, edges: Edges, usable: NDArray[np.bool_], usual: tuple[float, ...] | None
) -> NDArray[np.bool_]:
    """Edges (E,) of stations that do not have their usual width, with their neighbours; none while it is not known."""
    odd = np.zeros(len(usable), dtype=np.bool_)
    if usual is None:
        return odd
    s, wider, both, depth = _widths(expected, edges, usable)
    if len(both) < 4 * STATION_NEIGHBOURS:
        return odd
    wider = median_filter(wider - np.interp(s, (np.arange(KNOTS) + 0.5) / KNOTS, usual), STRETCH, mode="nearest")
    wider -= np.median(wider)
    scatter = 1.4826 * float(np.median(np.abs(wider)))
    left, right = np.flatnonzero(expected.kind == 0), np.flatnonzero(expected.kind == 1)
    near = np.zeros(len(left), dtype=np.bool_)
    near[both] = np.abs(wider) > np.maximum(max(TIMES * scatter, LEAST), SHARE * depth)
    near = binary_dilation(near, iterations=STATION_NEIGHBOURS)
    odd[left], odd[right] = near, near
    return odd


def _widths(expected: Outline, edges: Edges, usable: NDArray[np.bool_]) -> tuple[Array, Array, NDArray[np.intp], Array]:
    """s, w, index and depth of the stations with two usable sides."""
    left, right = np.flatnonzero(expected.kind == 0), np.flatnonzero(expected.kind == 1)
    both = np.flatnonzero(usable[left] & usable[right])
    return (
        expected.s[left[both]],
        edges.offset[left[both]] + edges.offset[right[both]],
        both,
        expected.depth[left[both]],
    )

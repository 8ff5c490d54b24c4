"""The force that a model misses: a map over arc length and time, its size along the arm, and the share that laws do not
explain.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from tentacle.proposed_law import ForceMap
from viz.figures.style import house_style, new_figure
from viz.palette import AUGMENTED, NEUTRAL

WINDOW = 6.0  # s of the map that are drawn
SIGNED_MAP = "PuOr"  # light where no force acts, and safe for colour-blind readers


def missing_force_figure(shown: ForceMap, kinds: Sequence[tuple[str, float]] = ()) -> Figure:
    """The normal force along the arm [N/m] over time and place, and its rms; below, that at the tip [mN], with a band
    of one standard deviation; beside them the share of its effect that the best law of each kind leaves. Blank where
    no frame was used.
    """
    with house_style():
        figure = new_figure(3.9)
        grid = figure.add_gridspec(2, 3 if kinds else 2, width_ratios=(3.2, 1.2, 1.6) if kinds else (3.2, 1.2),
                                   height_ratios=(2.0, 1.0))  # fmt: skip
        line, size, tip = (figure.add_subplot(grid[place]) for place in ((0, 0), (0, 1), (1, 0)))
        time = shown.t <= shown.t[0] + WINDOW
        limit = float(np.nanpercentile(np.abs(shown.force[time]), 99.0)) or 1.0
        mesh = line.pcolormesh(
            shown.t[time], shown.s, shown.force[time].T, cmap=SIGNED_MAP, vmin=-limit, vmax=limit, shading="nearest",
            rasterized=True,
        )  # fmt: skip
        line.set_ylabel("s [1] (0 clamp, 1 tip)")
        line.set_title("missing force along the arm [N/m]")
        figure.colorbar(mesh, ax=line, extend="both")
        rms, spread = (np.sqrt(np.nanmean(part**2, axis=0)) for part in (shown.force, shown.spread))
        size.fill_betweenx(shown.s, np.maximum(rms - spread, 0.0), rms + spread, color=AUGMENTED.hex, alpha=0.3)
        size.plot(rms, shown.s, color=AUGMENTED.hex)
        size.set_xlabel("rms [N/m]")
        size.set_xlim(left=0.0)
        force, band = 1e3 * shown.tip_force[time], 1e3 * shown.tip_spread[time]
        tip.fill_between(shown.t[time], force - band, force + band, color=AUGMENTED.hex, alpha=0.3)
        tip.plot(shown.t[time], force, color=AUGMENTED.hex)
        tip.axhline(0.0, color=NEUTRAL.hex, linewidth=0.6)
        tip.set_xlabel("t [s]")
        tip.set_ylabel("at the tip [mN]")
        if kinds:
            rows = sorted(kinds, key=lambda row: -row[1])
            bars = figure.add_subplot(grid[:, 2])
            bars.barh([name for name, _ in rows], [100.0 * left for _, left in rows], color=NEUTRAL.hex)
            bars.set_xlim(0.0, 100.0)
            bars.set_xlabel("left [%]")
            bars.set_title("by the best law of")
        return figure

"""The force that a model misses: a map over arc length and time, its size along the arm, and what laws leave of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from tentacle.proposed_law import ForceMap
from viz.figures.style import house_style, new_figure
from viz.palette import AUGMENTED, NEUTRAL

SIGNED_MAP = "PuOr"  # light where nothing acts, and told apart by the colour-blind


def missing_force_figure(shown: ForceMap, kinds: Sequence[tuple[str, float]] = ()) -> Figure:
    """The normal force [N/m]: over time and place; its rms along the arm with the band of one deviation of the mean;
    beside it the share of its effect that the best law of each kind leaves.
    """
    with house_style():
        figure = new_figure(3.0)
        panels = figure.subplots(1, 3 if kinds else 2, width_ratios=(3.2, 1.3, 1.7) if kinds else (3.2, 1.3))
        limit = float(np.percentile(np.abs(shown.force), 99.0)) or 1.0
        mesh = panels[0].pcolormesh(
            shown.t, shown.s, shown.force.T, cmap=SIGNED_MAP, vmin=-limit, vmax=limit, shading="nearest",
            rasterized=True,
        )  # fmt: skip
        panels[0].set_xlabel("t [s]")
        panels[0].set_ylabel("arc length s [1] (0 clamp, 1 tip)")
        panels[0].set_title("missing force along the normal")
        figure.colorbar(mesh, ax=panels[0], label="[N/m]", extend="both")
        size, spread = (np.sqrt(np.mean(part**2, axis=0)) for part in (shown.force, shown.spread))
        panels[1].fill_betweenx(shown.s, np.maximum(size - spread, 0.0), size + spread, color=AUGMENTED.hex, alpha=0.3)
        panels[1].plot(size, shown.s, color=AUGMENTED.hex)
        panels[1].set_xlabel("rms [N/m]")
        panels[1].set_title("size and one deviation")
        panels[1].set_xlim(left=0.0)
        if kinds:
            rows = sorted(kinds, key=lambda row: -row[1])
            panels[2].barh([name for name, _ in rows], [100.0 * left for _, left in rows], color=NEUTRAL.hex)
            panels[2].set_xlim(0.0, 100.0)
            panels[2].set_xlabel("left of its effect [%]")
            panels[2].set_title("best law that depends on")
        return figure

"""Free swimming from above: the hull's path, and the arm at even instants."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.motion import motion_roles
from viz.figures.style import FIGURE_WIDTH, draw_line, house_style, new_figure
from viz.palette import NEUTRAL

CM = 100.0
MARGIN = 2.0  # cm
TITLE = 0.4  # inch


def free_swim_figure(swims: Mapping[str, tuple[Array, Array]], every: float = 1.0) -> Figure:
    """Of named swims, t (T,) [s] and midlines xy (T, P, 2) [m] in the tank, base first: the path of the base, and the
    arm every so many seconds. Forward is to the right.
    """
    shown_points = np.concatenate([xy[..., ::-1].reshape(-1, 2) * [-CM, CM] for _, xy in swims.values()])
    low, high = shown_points.min(axis=0) - MARGIN, shown_points.max(axis=0) + MARGIN
    with house_style():
        tall = FIGURE_WIDTH * float((high - low)[1] / (high - low)[0])
        figure = new_figure((tall + TITLE) * len(swims) + TITLE)
        rows = figure.subplots(len(swims), squeeze=False, sharex=True, sharey=True)[:, 0]
        for axes, (name, role) in zip(rows, motion_roles(list(swims)).items(), strict=True):
            t, xy = swims[name]
            shown = np.searchsorted(t, np.arange(t[0], t[-1] + 1e-9, every) - 1e-9)
            for frame in shown:
                axes.plot(-CM * xy[frame, :, 1], CM * xy[frame, :, 0], color=role.hex, linewidth=1.6, alpha=0.7)
                axes.plot(-CM * xy[frame, 0, 1], CM * xy[frame, 0, 0], "o", color=role.hex, markersize=4)
            draw_line(axes, NEUTRAL, -CM * xy[:, 0, 1], CM * xy[:, 0, 0])
            axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
            axes.set_title(f"{name}, every {every:g} s", loc="left")
            axes.set_ylabel("sideways [cm]")
        rows[-1].set_xlabel("forward, as it first headed [cm]")
        return figure

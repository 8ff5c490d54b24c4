"""Swimming speeds of arms under several base motions (the paper's Fig. 10 and Table II)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.motion import motion_roles
from viz.figures.style import INK, draw_line, house_style, new_figure

HATCHES = ("", "//", "..", "xx", "\\\\")


@dataclass(frozen=True)
class Swim:
    """Repeated runs of one arm under one base motion: speeds (N,) [m/s]."""

    arm: str
    motion: str
    speeds: Array


def speeds_figure(swims: Sequence[Swim], motions: Mapping[str, tuple[Array, Array]]) -> Figure:
    """Left, the motions (t (T,) [s], theta (T,) [rad]) where given; right, mean and standard deviation in cm/s."""
    with house_style():
        figure = new_figure(2.8)
        left, right = figure.subplots(1, 2, width_ratios=[1, 2] if motions else [1e-3, 1])
        arms, names = (list(dict.fromkeys(getattr(swim, field) for swim in swims)) for field in ("arm", "motion"))
        width, roles = 0.8 / len(names), motion_roles(list(dict.fromkeys([*names, *motions])))
        for swim in swims:
            index = names.index(swim.motion)
            place = arms.index(swim.arm) + (index - 0.5 * (len(names) - 1)) * width
            role = roles[swim.motion]
            deviation = 100 * swim.speeds.std(ddof=1) if len(swim.speeds) > 1 else None
            right.bar(
                place, 100 * swim.speeds.mean(), 0.92 * width, yerr=deviation, color=role.hex, ecolor=INK, capsize=3,
                hatch=HATCHES[index % len(HATCHES)], edgecolor=INK, lw=0.5,
                label=swim.motion if swim.arm == arms[0] else None,
            )  # fmt: skip
        right.set_xticks(np.arange(len(arms)), arms)
        right.set_ylabel("swimming speed [cm/s]")
        right.legend()
        if not motions:
            left.set_axis_off()
            return figure
        for name, (t, theta) in motions.items():
            draw_line(left, roles[name], t, theta, name)
        left.set_xlabel("t [s]")
        left.set_ylabel("base angle [rad]")
        return figure

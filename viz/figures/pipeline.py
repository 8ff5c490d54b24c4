"""The image processing of one frame, step by step (the paper's Fig. 3), and stills with outlines (its Fig. 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tentacle.signals import Array
from viz.figures.style import house_style, new_figure
from viz.palette import Role


@dataclass(frozen=True)
class PaperStill:
    """A picture (H, W) or (H, W, 3) uint8, its title, and lines (N, 2) [px] drawn over it in a role's colour."""

    title: str
    picture: NDArray[np.uint8]
    lines: Sequence[tuple[Role, Array]] = field(default_factory=tuple)


def crop_around(stills: Sequence[PaperStill], points: Array, margin: float = 0.25) -> list[PaperStill]:
    """The stills cut to the points (N, 2) [px] that must be seen, with a margin on each side of that share of the
    longer side; where missing (NaN), a point counts for nothing.
    """
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    around = margin * float(np.max(high - low))
    size = np.array(stills[0].picture.shape[1::-1])
    left, top = np.clip(np.floor(low - around), 0, size - 1).astype(int)
    right, bottom = np.clip(np.ceil(high + around), 1, size).astype(int)
    return [
        PaperStill(
            still.title,
            still.picture[top:bottom, left:right],
            [(role, line - np.array([left, top])) for role, line in still.lines],
        )
        for still in stills
    ]


def pipeline_figure(steps: Sequence[PaperStill]) -> Figure:
    """The steps in a row, lettered a, b, c ... as in the paper; pixels of the camera."""
    return stills_figure([steps], lettered=True)


def stills_figure(rows: Sequence[Sequence[PaperStill]], lettered: bool = False) -> Figure:
    """Rows of stills; all pictures of a figure at the same scale. No axes: they are pictures."""
    with house_style():
        columns = max(len(row) for row in rows)
        height, width = rows[0][0].picture.shape[:2]
        figure = new_figure(len(rows) * (7.2 / columns * height / width + 0.3))
        panels = figure.subplots(len(rows), columns, squeeze=False)
        for axes in panels.flat:
            axes.set_axis_off()
        for row, line in zip(rows, panels, strict=True):
            for index, (still, axes) in enumerate(zip(row, line, strict=False)):
                axes.imshow(still.picture, cmap="gray", vmin=0, vmax=255, interpolation="none")
                for role, points in still.lines:
                    axes.plot(points[:, 0], points[:, 1], role.dash, color=role.hex, lw=1.3)
                axes.set_title(f"{chr(97 + index)}) {still.title}" if lettered else still.title)
                axes.set_xlim(-0.5, still.picture.shape[1] - 0.5)
                axes.set_ylim(still.picture.shape[0] - 0.5, -0.5)
        return figure

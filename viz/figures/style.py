"""The style and the output of figures: in print, on a light page and on a dark one."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from viz.palette import Role

INK = "#010203"  # stands for the page's own text colour; an SVG inside a page has it replaced by currentColor
FIGURE_WIDTH = 7.2  # inches: a double column in print
MOST_INSTANTS = 2500  # instants a line is drawn with: more cannot be told apart in print

FIGURE_STYLE: dict[str, Any] = {
    "font.family": "sans-serif", "font.size": 9, "axes.titlesize": 9, "axes.labelsize": 9, "legend.fontsize": 8,
    "xtick.labelsize": 8, "ytick.labelsize": 8, "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": INK,
    "xtick.color": INK, "ytick.color": INK, "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.7,
    "lines.linewidth": 1.2, "legend.frameon": False, "figure.facecolor": "none", "axes.facecolor": "none",
    "savefig.facecolor": "none", "svg.fonttype": "none", "svg.hashsalt": "tentacle-twin", "axes.grid": False,
}  # fmt: skip


@contextmanager
def house_style() -> Iterator[None]:
    """The look of every figure, inside the block only; matplotlib's own settings come back after it."""
    with rc_context(cast(Any, FIGURE_STYLE)):
        yield


def new_figure(height: float, width: float = FIGURE_WIDTH) -> Figure:
    """An empty figure, width x height [inch], that needs no screen."""
    return Figure(figsize=(width, height), layout="constrained")


def thinned(count: int, longest: int = MOST_INSTANTS) -> NDArray[np.int64]:
    """Indices of at most `longest` of `count` instants, evenly spread."""
    return np.arange(0, count, max(1, -(-count // longest)))


def draw_line(axes: Axes, role: Role, x: NDArray[np.float64], y: NDArray[np.float64], label: str | None = None) -> None:
    """One party's line, in its colour and dash."""
    keep = thinned(len(x))
    axes.plot(x[keep], y[keep], role.dash, color=role.hex, label=role.name if label is None else label)


def legend_above(figure: Figure, axes: Axes) -> None:
    """One legend for a figure, above it, where it covers nothing."""
    handles, labels = axes.get_legend_handles_labels()
    columns = len(labels) if figure.get_figwidth() >= 0.9 * FIGURE_WIDTH else 1
    figure.legend(handles, labels, loc="outside upper center", ncols=columns)


def svg(figure: Figure, prefix: str) -> str:
    """The figure as an SVG element to stand inside a page: ids made unique by prefix, ink the page's text colour."""
    text = io.StringIO()
    with house_style():
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    element = text.getvalue()
    element = element[element.index("<svg") :]
    element = re.sub(r"<metadata>.*?</metadata>", "", element, flags=re.DOTALL)
    element = re.sub(r"<style[^>]*>.*?</style>", "", element, flags=re.DOTALL)  # it would style the whole page
    element = re.sub(r'(<image\b[^>]*?) id="[^"]*"', r"\1", element)  # of its content: not unique
    element = re.sub(r'\bid="', f'id="{prefix}-', element)
    element = re.sub(r'(xlink:href="#|url\(#)', rf"\g<1>{prefix}-", element)
    return element.replace(INK, "currentColor").strip()


def save(figure: Figure, path: Path) -> Path:
    """Write the figure as the suffix says (.svg, .pdf, .png at 200 dpi), black ink on white."""
    with house_style():
        metadata = {"Date": None} if path.suffix == ".svg" else {"CreationDate": None} if path.suffix == ".pdf" else {}
        unfinished = path.with_name(path.name + ".unfinished")
        try:
            figure.savefig(
                unfinished,
                format=path.suffix.lstrip("."),
                dpi=200,
                facecolor="white",
                bbox_inches="tight",
                metadata=metadata,
            )
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)
    return path


def png(figure: Figure, dpi: int, ink: str, paper: str) -> bytes:
    """The figure as PNG bytes with ink on paper, for a view that has no SVG."""
    contents = io.BytesIO()
    for axes in figure.axes:
        axes.set_facecolor(paper)
        axes.tick_params(colors=ink)
        for spine in axes.spines.values():
            spine.set_edgecolor(ink)
        for text in (axes.xaxis.label, axes.yaxis.label, axes.title):
            text.set_color(ink)
    for legend in figure.legends:
        for text in legend.get_texts():
            text.set_color(ink)
    with house_style():
        figure.savefig(contents, format="png", dpi=dpi, facecolor=paper, metadata={"Software": None})
    return contents.getvalue()

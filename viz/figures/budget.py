"""Parts of the declared model's error: noise, reduction, missing physics, rest."""

from __future__ import annotations

from matplotlib.figure import Figure

from tentacle.diagnosis import ErrorBudget
from tentacle.rounding import number
from viz.figures.style import INK, house_style, new_figure
from viz.palette import AUGMENTED, BASE, MEASURED, REFERENCE

BUDGET_PARTS = (
    ("measurement noise", "noise_mm", MEASURED, ""),
    ("reduction to few coordinates", "reduction_mm", REFERENCE, "//"),
    ("missing effect", "missing_mm", BASE, ".."),
    ("not explained", "rest_mm", AUGMENTED, "xx"),
)


def budget_figure(budget: ErrorBudget) -> Figure:
    """One bar each, in mm rms; independent parts add in squares, not in lengths."""
    with house_style():
        figure = new_figure(1.7)
        axes = figure.subplots()
        values = [float(getattr(budget, field)) for _, field, _, _ in BUDGET_PARTS]
        for row, ((_, _, role, hatch), value) in enumerate(zip(BUDGET_PARTS, values, strict=True)):
            axes.barh(row, value, color=role.hex, hatch=hatch, edgecolor=INK, lw=0.5)
            where = {"xytext": (4, 0), "textcoords": "offset points"}
            axes.annotate(f"{number(value)} mm", (value, row), va="center", fontsize=8, **where)
        axes.set_yticks(range(len(BUDGET_PARTS)), [name for name, _, _, _ in BUDGET_PARTS])
        axes.invert_yaxis()
        axes.set_xlim(0, 1.15 * max(*values, 1e-6))
        axes.set_xlabel("midline error, rms [mm]")
        return figure

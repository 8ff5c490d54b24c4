"""The candidates: what each alone explains (log-likelihood gained) and how probable it is."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from tentacle.diagnosis import RankedEffect
from viz.figures.style import house_style, new_figure
from viz.palette import AUGMENTED, BASE, NEUTRAL
from viz.words import effect_name


def ranking_figure(ranking: Sequence[RankedEffect], accepted: Sequence[str]) -> Figure:
    """Two panels, a row a candidate; the accepted ones filled with the augmented model's colour and hatched."""
    with house_style():
        figure = new_figure(0.8 + 0.19 * len(ranking))
        left, right = figure.subplots(1, 2, sharey=True)
        for row, ranked in enumerate(ranking):
            chosen = ranked.effect in accepted
            role, hatch = (AUGMENTED, "//") if chosen else (NEUTRAL, "")
            left.barh(row, max(ranked.score, 0.0), color=role.hex, hatch=hatch)
            right.barh(row, ranked.probability, color=role.hex, hatch=hatch)
        left.set_yticks(range(len(ranking)), [effect_name(ranked.effect) for ranked in ranking])
        left.invert_yaxis()
        left.set_xscale("symlog", linthresh=10)
        left.axvline(7.6, color=BASE.hex, ls="--", lw=1)
        left.set_xlabel("score [nat]; dashed: 7.6, one parameter's price")
        right.set_xlabel("probability [1]")
        right.set_xlim(0, 1)
        return figure

"""The page of `tentacle reproduce fig9`."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from tentacle.io.provenance import versions
from validation.paper_arms import CHOICES
from validation.paper_fig9 import FIG9_LENGTHS, ThrustMaps
from viz.figures.thrust_map import ThrustMap, thrust_map_figure
from viz.report import Origin, Picture, Report, ReportSection, ReportTable, render_report, write_report


def write_fig9_page(maps: ThrustMaps, page: Path) -> None:
    """report.html: the maps side by side, how well they agree, and what the paper shows."""
    arms = [
        ThrustMap(
            f"{1e3 * length:.0f} mm",
            np.array(maps.amplitudes),
            np.array(maps.frequencies),
            maps.affine[i],
            maps.reference[i],
        )
        for i, length in enumerate(FIG9_LENGTHS)
    ]
    figure = thrust_map_figure(arms)
    for axes in figure.axes:
        axes.title.set_text(axes.get_title().replace("measured", "reference").replace("model", "affine"))
    rows = [
        (f"{1e3 * length:.0f} mm", f"{rank:.4f}", f"{100 * ratio:.1f} %")
        for length, rank, ratio in zip(FIG9_LENGTHS, maps.ranks, maps.errors, strict=True)
    ]
    table = ReportTable(
        "agreement of the maps", ("arm", "rank correlation", "mean |error| / mean |thrust|"), rows, numeric=(1, 2)
    )
    words = (
        "The upper row is the reference, in place of the paper's tank. Both models have the same parameters, so the"
        " difference is the reduction to two coordinates alone. The paper's own model was identified from video.",
        "Thrust rises with amplitude and with frequency for all three arms here, so the rank correlation is an easy"
        " test, and the mean error a strict one. The paper shows Fig. 9 as pictures without numbers. It says that"
        " the 140 mm arm thrusts most at large amplitude and low frequency, and the 105 mm arm at low amplitude and"
        " low frequency. Neither model does that. In the tank something else acted, for example a servo that does"
        " not reach fast commands of large amplitude.",
        CHOICES,
    )
    section = ReportSection("Mean thrust", words, (table,), (Picture(figure, "Mean forward thrust over 10 s."),))
    least = np.floor(1e4 * min(maps.ranks)) / 1e4
    headline = (
        f"Two coordinates rank the sines as the reference does (rank correlation {least:.4f} or more) and miss the"
        f" thrust by {100 * max(maps.errors):.1f} % on average at most."
    )
    origin = Origin("tentacle " + " ".join(sys.argv[1:]), versions=versions())
    write_report(render_report(Report("reproduce", "Fig. 9: mean thrust of sines", headline, (section,), origin)), page)

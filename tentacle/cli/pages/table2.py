"""What `tentacle reproduce table2` writes: its rows as plain data, and its page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from affine_model.swim.table2 import MAP_LIMITS, MOTIONS, PRINTED_SPEEDS, REMARKS, TABLE2_HEADER, SwimRow, cells, ratios
from affine_model.swim.table2_curves import RatioCurves
from affine_model.swim.trial import PAPER_RAIL
from tentacle.io.provenance import versions
from viz.figures.motion import motion_figure
from viz.figures.ratios import ratio_figure
from viz.figures.speeds import Swim, speeds_figure
from viz.report import Origin, Picture, Report, ReportSection, ReportTable, render_report, write_report


def row_table(row: SwimRow) -> dict[str, Any]:
    """A row as plain data."""
    return {
        "length_m": row.length,
        "printed_m_s": PRINTED_SPEEDS[row.length].means,
        "affine_m_s": dict(zip(MOTIONS, row.affine, strict=True)),
        "reference_m_s": dict(zip(MOTIONS, row.reference or (), strict=True)),
        "alpha": {motion: gait.alpha for motion, gait in zip(MOTIONS, row.gaits, strict=True)},
        "bandwidth_hz": row.gaits[0].bandwidth,
    }


def curves_table(curves: RatioCurves) -> dict[str, Any]:
    """The curves as plain data."""
    return {name: values.tolist() for name, values in vars(curves).items()}


def _curves_section(curves: RatioCurves) -> ReportSection:
    names = tuple(f"{100 * length:.0f} cm" for length in curves.lengths)
    edge = ("edge of the map [Hz]", curves.edges, curves.by_edge, MAP_LIMITS.highest_frequency)
    friction = ("friction of the rail [N s/m]", curves.frictions, curves.by_friction, PAPER_RAIL.viscous)
    words = "The paper states neither the map's edge nor the rail's friction; the grey lines are what the table takes."
    picture = Picture(ratio_figure(names, (edge, friction)), "Speed of the best gait over that of the best sine.")
    return ReportSection("What the ratio depends on", (words,), (), (picture,))


def write_table2_page(rows: list[SwimRow], curves: RatioCurves | None, evaluations: int, seed: int, path: Path) -> None:
    """report.html: the table beside the paper's, speeds and base motions; the ratio's curves where there are any."""
    names = [f"{100 * row.length:.0f} cm" for row in rows]
    measured = [row.reference or row.affine for row in rows]
    swims = [
        Swim(name, motion, np.array([speed]))
        for name, speeds in zip(names, measured, strict=True)
        for motion, speed in zip(MOTIONS[:3], speeds[:3], strict=True)
    ]
    pictures = [Picture(speeds_figure(swims, {}), "Speeds of the MuJoCo reference within the map.")]
    for name, row in zip(names, rows, strict=True):
        t = np.linspace(0.0, 4.0, 800)
        motions = {motion: (t, gait(t)[0]) for motion, gait in zip(MOTIONS[:3], row.gaits[:3], strict=True)}
        pictures.append(Picture(motion_figure(motions), f"Base motions of the {name} arm."))
    numeric = tuple(range(2, len(TABLE2_HEADER)))
    unbroken = [(line[0].replace(" ", "\N{NO-BREAK SPACE}"), *line[1:]) for line in cells(rows)]
    section = ReportSection(
        "Table II", REMARKS, (ReportTable("Swimming speeds [cm/s].", TABLE2_HEADER, unbroken, numeric),), pictures
    )
    printed = ", ".join(f"{PRINTED_SPEEDS[row.length].ratio:.1f}" for row in rows)
    of_map, of_servo = (", ".join(f"{ratios(speeds)[which]:.2f}" for speeds in measured) for which in (0, 1))
    headline = (
        f"Gait over the better sine, 14, 21, 25 cm, on the reference: {of_map} within the paper's map, {of_servo} with "
        f"all that the servo can do; {printed} in the paper's tank."
    )
    command = f"tentacle reproduce table2 --seed {seed} --evaluations {evaluations}"
    origin = Origin(command, seed, versions())
    sections = [section] if curves is None else [section, _curves_section(curves)]
    report = Report("reproduce", "Table II", headline, sections, origin)
    write_report(render_report(report), path)

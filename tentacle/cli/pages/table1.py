"""The page of `tentacle reproduce table1`."""

from __future__ import annotations

import sys
from pathlib import Path

from tentacle.io.provenance import versions
from validation.paper_table1 import TABLE1_HEADER, Table1
from viz.report import Origin, Report, ReportSection, ReportTable, render_report, write_report


def write_table1_page(found: Table1, seed: int, page: Path) -> None:
    """report.html: the table beside the paper's, and its results in sentences."""
    table = ReportTable(
        "error of the identified model on the sine", TABLE1_HEADER, found.rows, tuple(range(1, len(TABLE1_HEADER)))
    )
    origin = Origin("tentacle " + " ".join(sys.argv[1:]), seed=seed, versions=versions())
    section = ReportSection("Fifteen arms", found.words, (table,))
    silicone, length, _, _, error = found.worst[:5]
    headline = f"Two coordinates follow all fifteen arms within {error} mm rms; the worst is {silicone}, {length} cm."
    write_report(
        render_report(Report("reproduce", "Table I: identification error", headline, (section,), origin)), page
    )

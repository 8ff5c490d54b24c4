"""What `tentacle compare` writes for a grid of arms: one page and one table over all of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli.pages.compare import WITHOUT_MAP

if TYPE_CHECKING:
    from validation.ladder import Ladder
    from validation.validity_map import Validity

ArmComparison = tuple[Path, "Ladder", "list[Validity]"]


def write_grid(answers: Sequence[ArmComparison], out: Path) -> None:
    """One page and one table over all arms of a grid."""
    import csv
    import sys

    from tentacle.io.provenance import input_hashes, versions
    from validation.validity_advice import GOOD_SHAPE, largest_ratio, sentence, serves
    from viz.report import Origin, Report, ReportSection, ReportTable, render_report, write_report

    header = ("arm", "first mode [Hz]", "serves", "shape within 5 % up to [Hz]", "driven motion, order 2 [mm]")
    rows, words = [], []
    for file, ladder, maps in answers:
        rungs = {rung.name: rung for rung in ladder.rungs}
        found = maps[0] if maps else None
        answer = ("", "") if found is None else (
            "yes" if serves(found) else "no", f"{largest_ratio(found, 2, GOOD_SHAPE) * found.first:.3g}"
        )  # fmt: skip
        first = rungs["first frequency, declared fluid"].best
        rows.append((file.stem, f"{first:.3g}", *answer, f"{rungs['driven motion: midline'].error(2):.2g}"))
        if found is not None:
            words.append(f"{file.stem}: {sentence(found)}")
    with (out / "grid.csv").open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerows([header, *rows])
    serving = sum(row[2] == "yes" for row in rows)
    headline = f"The affine model serves for {serving} of {len(rows)} arms." if words else WITHOUT_MAP
    table = ReportTable("arms of the grid", header, rows, numeric=(1, 3, 4))
    files = [file for file, _, _ in answers]
    origin = Origin("tentacle " + " ".join(sys.argv[1:]), versions=versions(), inputs=input_hashes(files))
    report = Report(
        "compare", "Reduced model and reference: a grid", headline, (ReportSection("Arms", words, (table,)),), origin
    )
    write_report(render_report(report), out / "report.html")

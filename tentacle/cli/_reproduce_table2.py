"""`tentacle reproduce table2`: the paper's swimming speeds beside those of both models."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from affine_model.swim.table2 import Row


HELP = "Table II: swimming speeds of three arms under a slow sine, a fast sine and the optimised gait"


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the result."""
    parser.add_argument("--out", type=Path, required=True, help="folder for table2.csv, table2.json and report.html")
    parser.add_argument("--evaluations", type=int, default=5000, help="gaits tried per search; default: 5000")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--device", default="auto", help="cpu, cuda, cuda:1; auto (default): CUDA where there is one")


def run(arguments: argparse.Namespace) -> int:
    """Compute Table II, print it, and write table2.csv, table2.json and report.html."""
    import csv
    import json

    from affine_model.swim import table2 as table
    from affine_model.swim.device import chosen_device
    from tentacle.cli._progress import stages
    from tentacle.cli._swimming import reference_speed
    from tentacle.io.result_folder import written

    rows, device = [], chosen_device(arguments.device)
    with stages() as stage:
        for length in table.PRINTED:
            stage(f"optimising the {100 * length:.0f} cm arm")
            rows += table.table2(
                evaluations=arguments.evaluations, seed=arguments.seed, reference=reference_speed, lengths=(length,),
                device=device,
            )  # fmt: skip
    lines = table.cells(rows)
    with written(arguments.out) as folder:
        with (folder / "table2.csv").open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([table.HEADER, *lines])
        (folder / "table2.json").write_text(json.dumps([_row(row) for row in rows], indent=1) + "\n")
        _write_page(rows, lines, arguments, folder / "report.html")
    _print_table(table.HEADER, lines)
    for remark in table.REMARKS:
        print(remark)
    return 0


def _row(row: Row) -> dict[str, Any]:
    """A row as plain data."""
    from affine_model.swim.table2 import MOTIONS, PRINTED

    return {
        "length_m": row.length,
        "printed_m_s": PRINTED[row.length].means,
        "affine_m_s": dict(zip(MOTIONS, row.affine, strict=True)),
        "reference_m_s": dict(zip(MOTIONS, row.reference or (), strict=True)),
        "alpha": {motion: gait.alpha for motion, gait in zip(MOTIONS, row.gaits, strict=True)},
        "bandwidth_hz": row.gaits[0].bandwidth,
    }


def _print_table(header: tuple[str, ...], lines: list[tuple[str, ...]]) -> None:
    widths = [max(len(line[column]) for line in (header, *lines)) for column in range(len(header))]
    for line in (header, *lines):
        left = [text.ljust(width) for text, width in zip(line[:2], widths[:2], strict=True)]
        right = [text.rjust(width) for text, width in zip(line[2:], widths[2:], strict=True)]
        print("  ".join([*left, *right]))


def _write_page(rows: list[Row], lines: list[tuple[str, ...]], arguments: argparse.Namespace, path: Path) -> None:
    import numpy as np

    from affine_model.swim.table2 import HEADER, MOTIONS, PRINTED, REMARKS, ratios
    from tentacle.io.provenance import versions
    from viz.figures.motion import motion_figure
    from viz.figures.speeds import Swim, speeds_figure
    from viz.report import Origin, Picture, Report, Section, Table, render, write_report

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
    numeric = tuple(range(2, len(HEADER)))
    unbroken = [(line[0].replace(" ", "\N{NO-BREAK SPACE}"), *line[1:]) for line in lines]
    section = Section("Table II", REMARKS, (Table("Swimming speeds [cm/s].", HEADER, unbroken, numeric),), pictures)
    printed = ", ".join(f"{PRINTED[row.length].ratio:.1f}" for row in rows)
    of_map, of_servo = (", ".join(f"{ratios(speeds)[which]:.2f}" for speeds in measured) for which in (0, 1))
    headline = (
        f"Gait over the better sine, 14, 21, 25 cm, on the reference: {of_map} within the paper's map, {of_servo} with "
        f"all that the servo can do; {printed} in the paper's tank."
    )
    command = f"tentacle reproduce table2 --seed {arguments.seed} --evaluations {arguments.evaluations}"
    origin = Origin(command, arguments.seed, versions())
    report = Report("reproduce", "Table II", headline, [section], origin)
    write_report(render(report), path)

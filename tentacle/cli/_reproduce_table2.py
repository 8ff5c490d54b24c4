"""`tentacle reproduce table2`: the paper's swimming speeds beside those of both models."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say

HELP = "Table II: swimming speeds of three arms under a slow sine, a fast sine and the optimised gait"


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the result."""
    parser.add_argument("--out", type=Path, required=True, help="folder for table2.csv, table2.json and report.html")
    parser.add_argument(
        "--evaluations", type=int, default=5000, help="number of gaits that each search tries, default: 5000"
    )
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--curves", action="store_true", help="also the ratio over map edge and rail friction")
    parser.add_argument("--device", default="auto", help="cpu, cuda, cuda:1; auto (default): CUDA where there is one")


def run(arguments: argparse.Namespace) -> int:
    """Compute Table II, print it, and write table2.csv, table2.json and report.html."""
    import csv
    import json

    from affine_model.device import chosen_device
    from affine_model.swim import table2 as table
    from affine_model.swim.table2_curves import ratio_curves
    from tentacle.cli._progress import stages
    from tentacle.cli.pages.table2 import curves_table, row_table, write_table2_page
    from tentacle.io.result_folder import written
    from validation.reference_swim import reference_speed

    rows, device = [], chosen_device(arguments.device)
    with stages() as stage:
        for length in table.PRINTED_SPEEDS:
            stage(f"optimising the {100 * length:.0f} cm arm")
            rows += table.table2(
                evaluations=arguments.evaluations, seed=arguments.seed, reference=reference_speed, lengths=(length,),
                device=device,
            )  # fmt: skip
        curves = ratio_curves(seed=arguments.seed, device=device, watch=stage) if arguments.curves else None
    lines = table.cells(rows)
    with written(arguments.out) as folder:
        with (folder / "table2.csv").open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([table.TABLE2_HEADER, *lines])
        (folder / "table2.json").write_text(json.dumps([row_table(row) for row in rows], indent=1) + "\n")
        if curves is not None:
            (folder / "ratios.json").write_text(json.dumps(curves_table(curves), indent=1) + "\n")
        write_table2_page(rows, curves, arguments.evaluations, arguments.seed, folder / "report.html")
    _print_table(table.TABLE2_HEADER, lines)
    say(*table.REMARKS)
    return 0


def _print_table(header: tuple[str, ...], lines: list[tuple[str, ...]]) -> None:
    widths = [max(len(line[column]) for line in (header, *lines)) for column in range(len(header))]
    for line in (header, *lines):
        left = [text.ljust(width) for text, width in zip(line[:2], widths[:2], strict=True)]
        right = [text.rjust(width) for text, width in zip(line[2:], widths[2:], strict=True)]
        say("  ".join([*left, *right]))

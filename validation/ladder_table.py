"""The ladder as tables: the reference over its links, the reduced model's orders beside it, and both as CSV."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

from validation.ladder import LADDER_LINKS, LADDER_ORDERS, Ladder


@dataclass(frozen=True)
class Rows:
    """A table of texts, its first two columns words."""

    title: str
    header: tuple[str, ...]
    rows: list[tuple[str, ...]]


def ladder_rows(ladder: Ladder) -> tuple[Rows, Rows]:
    """The ladder as two tables: the reference over its links, and the reduced model's orders beside it."""
    reference, reduced = [], []
    for rung in ladder.rungs:
        spread, *errors = (
            f"{error:.2g} {rung.unit}" if rung.absolute else f"{100 * error:.2g} %"
            for error in (rung.spread, *(rung.error(o) for o in LADDER_ORDERS))
        )
        theory = "" if rung.theory is None else f"{rung.theory:.5g}"
        reference.append((rung.name, rung.unit, theory, *(f"{rung.reference[n]:.5g}" for n in LADDER_LINKS), spread))
        reduced.append((rung.name, rung.unit, *(f"{rung.affine[o]:.5g}" for o in LADDER_ORDERS), *errors))
    first = ("rung", "unit", "theory", *(f"{n} links" for n in LADDER_LINKS), "still open")
    second = ("rung", "unit", *(f"order {o}" for o in LADDER_ORDERS), *(f"error {o}" for o in LADDER_ORDERS))
    return Rows("the reference, by number of links", first, reference), Rows("reduced model", second, reduced)


def write_ladder(ladder: Ladder, file: Path) -> None:
    """The ladder as CSV."""
    header = [
        "rung",
        "unit",
        "theory",
        *(f"reference_{n}_links" for n in LADDER_LINKS),
        *(f"affine_{o}" for o in LADDER_ORDERS),
    ]
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        for rung in ladder.rungs:
            numbers = [rung.reference[n] for n in LADDER_LINKS] + [rung.affine[o] for o in LADDER_ORDERS]
            theory = "" if rung.theory is None else repr(rung.theory)
            writer.writerow([rung.name, rung.unit, theory, *map(repr, numbers)])

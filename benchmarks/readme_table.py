"""The tables of measured figures, from what the benchmarks wrote: no number is typed by hand.

    python benchmarks/readme_table.py [NAME=FILE.json ...]

NAME=FILE.json: what `benchmarks/NAME.py --json FILE.json` wrote (hostile: `python -m tests.hostile.run`); kept in
docs/figures.json, figure by figure, with the commit where it is told. From there the rows between README.md's marks and
all rows between docs/measured.md's are made anew; a row that misses its limit is marked, and explained below the table.
Without arguments the tables alone are made anew.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

# benchmarks/vision.py must not stand for the room of that name.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks._figure_rows import FIVE, ROWS, WHY

ROOT = Path(__file__).parents[1]
README, MEASURED, KEPT = ROOT / "README.md", ROOT / "docs" / "measured.md", ROOT / "docs" / "figures.json"
COMMITS = "commits"  # in docs/figures.json: benchmark -> commit
IN_PARTS = ("first_hour", "vision")  # what was measured before and is not now stays
ELSEWHERE = {"hostile": "make hostile"}  # not in benchmarks/


def _shown(value: float) -> str:
    """Three digits, and thousands without a power of ten; counts in full."""
    if float(value).is_integer() and abs(value) < 1e6:
        return f"{value:.0f}"
    return f"{value:.3g}" if abs(value) < 1000.0 else f"{float(f'{value:.3g}'):.0f}"


def is_missed(value: float, limit: str) -> bool:
    """Whether a figure is over what was asked for."""
    return bool(limit) and value > float(limit)


def table(figures: dict[str, dict[str, Any]]) -> str:
    """All rows as Markdown, of the figures that are known; a sentence where none is."""
    known = [row for row in ROWS if row[1] in figures.get(row[0], {})]
    if not known:
        return "No figure has been measured yet: `python benchmarks/readme_table.py NAME=FILE.json` puts them here."
    rows, notes = [], []
    for benchmark, name, words, unit, limit in known:
        value = figures[benchmark][name]
        missed = is_missed(value, limit)
        if missed:
            notes.append(f"**Missed: {words}.** {WHY.get((benchmark, name), 'Not explained yet.')}")
        mark = " (missed)" if missed else ""
        made = f"`{ELSEWHERE.get(benchmark, f'{benchmark}.py')}`"
        commit = figures.get(COMMITS, {}).get(benchmark)
        at = f" at `{commit}`" if commit else ""
        rows.append(f"| {words} | {_with_unit(value, unit)}{mark} | {limit} | {made}{at} |")
    lines = ["| what | measured | at most | by benchmarks/ |", "|---|---|---|---|", *rows]
    return "\n\n".join(["\n".join(lines), *notes])


def five(figures: dict[str, dict[str, Any]]) -> str:
    """The README's rows as Markdown, each with its 95 % interval where one is known."""
    rows = []
    for benchmark, name, words, unit in FIVE:
        known = figures.get(benchmark, {})
        if name in known:
            ends = [known.get(f"{name}_{end}") for end in ("low", "high")]
            between = "" if None in ends else f" ({_shown(ends[0])} to {_shown(ends[1])})"  # type: ignore[arg-type]
            rows.append(f"| {words.format(**known)} | {_with_unit(known[name], unit)}{between} |")
    return "\n".join(["| what | measured (95 % interval) |", "|---|---|", *rows])


def _with_unit(value: float, unit: str) -> str:
    return f"{_shown(value)} {unit}".rstrip()


def with_rows(page: str, rows: str, mark: str = "figures") -> str:
    """The page with what stands between its marks made anew. ValueError where the marks are missing."""
    before, begin, rest = page.partition(f"<!-- {mark} -->")
    _, end, after = rest.partition(f"<!-- /{mark} -->")
    if not begin or not end:
        raise ValueError(f"the page lacks the marks of {mark}")
    return f"{before}{begin}\n{rows}\n{end}{after}"


def kept() -> dict[str, dict[str, Any]]:
    """What is known so far: benchmark -> figure -> value."""
    return json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}


def main() -> None:
    """Take the results named, and write all three files."""
    figures = kept()
    for argument in sys.argv[1:]:
        name, _, file = argument.partition("=")
        if not file or (name not in ELSEWHERE and not (ROOT / "benchmarks" / f"{name}.py").exists()):
            raise SystemExit(f"{argument}: expected NAME=FILE.json, NAME one of benchmarks/NAME.py")
        written = json.loads(Path(file).read_text(encoding="utf-8"))
        taken = {key: value for key, value in written["figures"].items() if isinstance(value, int | float)}
        if written.get("commit"):
            figures.setdefault(COMMITS, {})[name] = written["commit"]
        figures[name] = {**(figures.get(name, {}) if name in IN_PARTS else {}), **taken}
    KEPT.write_text(json.dumps(figures, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    for page, rows in ((README, five(figures)), (MEASURED, table(figures))):
        page.write_text(with_rows(page.read_text(encoding="utf-8"), rows), encoding="utf-8")


if __name__ == "__main__":
    main()

"""What the README shows runs, and gives what it says."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_example_finds_the_current(tmp_path: Path) -> None:
    code = re.search(r"<!-- run -->\n```python\n(.*?)\n```", README, re.DOTALL)
    assert code is not None
    (tmp_path / "example.py").write_text(code.group(1), encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "example.py"], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "lacks current" in done.stdout
    value = re.search(r"value=([0-9.e-]+)", done.stdout)
    assert value is not None
    assert abs(float(value.group(1)) - 0.03) < 0.001  # the interval is 0.0002; the reduction may cost as much again
    stated = re.search(r"The error is ([0-9.]+) mm before and ([0-9.]+) mm after", README)
    printed = re.search(r"Error ([0-9.]+) mm before, ([0-9.]+) mm after", done.stdout)
    assert stated is not None
    assert printed is not None
    for told, found in zip(stated.groups(), printed.groups(), strict=True):
        assert float(told) == pytest.approx(float(found), rel=0.1)  # rounding of a fit, and of what is printed


def test_the_verbs_that_it_shows_exist() -> None:
    from tentacle.cli import verb_names

    shown = set(re.findall(r"^tentacle ([a-z]+)", README, re.MULTILINE))
    assert shown
    assert shown <= set(verb_names())


def test_the_tables_of_figures_are_what_was_measured() -> None:
    import importlib.util

    spec = importlib.util.spec_from_file_location("readme_table", ROOT / "benchmarks" / "readme_table.py")
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    kept, long = made.kept(), (ROOT / "docs" / "measured.md").read_text(encoding="utf-8")
    assert made.with_rows(README, made.five(kept)) == README  # python benchmarks/readme_table.py makes both anew
    assert made.with_rows(long, made.table(kept)) == long
    measured = {"first_hour": {"import_s": 0.04321}, "blind": {"top1": 0.96, "top1_low": 0.93, "top1_high": 0.98}}
    assert "| `import tentacle` | 0.0432 s | 0.5 | `first_hour.py` |" in made.table(measured)
    assert "| 0.96 (0.93 to 0.98) |" in made.five(measured)


def test_a_row_that_misses_its_limit_is_marked_and_explained() -> None:
    long = (ROOT / "docs" / "measured.md").read_text(encoding="utf-8")
    missed = [
        row.split("|") for row in long.splitlines() if row.startswith("|") and row.split("|")[3].strip()[:1].isdigit()
    ]
    for _, words, value, limit, *_ in missed:
        measured = float(value.split()[0])
        assert (measured > float(limit)) == ("(missed)" in value), words
        assert (measured > float(limit)) == (f"**Missed: {words.strip()}.**" in long), words
    assert "Not explained yet" not in long


def test_its_pictures_are_there() -> None:
    for picture in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README):
        assert (ROOT / picture).is_file(), picture

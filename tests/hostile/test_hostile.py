"""A fair sample of the hostile trials (`make hostile` runs all of them): each right, or refused in one line."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tests.hostile.cases import cases

ROOT = Path(__file__).parents[2]
SAMPLE = 60


def test_there_are_enough_cases_and_they_are_drawn_from_the_seed() -> None:
    first, again, other = ([case.name for case in cases(seed)] for seed in (1, 1, 2))
    assert len(first) == len(set(first)) >= 600
    assert first == again
    assert first != other


def test_a_sample_is_right_or_refused_in_one_line() -> None:
    """In a process of its own: a child is forked for each case, and this one has threads."""
    command = [sys.executable, "-m", "tests.hostile.run", "--cases", str(SAMPLE), "--quick"]
    ran = subprocess.run(
        command, cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert f"{SAMPLE} cases" in ran.stdout

"""A file appears whole or not at all; what a killed process left of it is removed, and nothing else."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tentacle.io.written_file import write_text


def test_what_a_dead_process_left_is_removed(tmp_path: Path) -> None:
    child = subprocess.Popen([sys.executable, "-c", ""])
    child.wait()
    for name in (f".out.csv.{child.pid}.partial", f".out.csv.{os.getppid()}.partial", ".out.csv.mine.partial"):
        (tmp_path / name).write_text("half")
    write_text(tmp_path / "out.csv", "whole")
    found = sorted(file.name for file in tmp_path.iterdir())
    assert found == sorted([f".out.csv.{os.getppid()}.partial", ".out.csv.mine.partial", "out.csv"])
    assert (tmp_path / "out.csv").read_text() == "whole"

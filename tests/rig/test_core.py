"""The board's own core, compiled with sanitizers: its checks, the documented bytes on its side, and fuzz in short
form.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from rig.build_core import compiled

PAGE = Path(__file__).parents[2] / "docs" / "protocol.md"


@pytest.mark.usefixtures("compiler")
def test_core_passes_its_checks_and_fuzz() -> None:
    command = [str(compiled("core_check")), "--vectors", str(PAGE), "--random", "20000", "--mutated", "20000"]
    result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert result.returncode == 0, result.stdout + result.stderr
    assert "18 byte examples agree" in result.stdout
    assert "all checks passed" in result.stdout

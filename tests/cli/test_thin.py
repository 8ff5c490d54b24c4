"""The command line parses, calls a room and prints: no long file, no arithmetic."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import tentacle.cli

FILES = sorted(Path(tentacle.cli.__file__).parent.glob("*.py"))
# Tracking a plain video and the search for a gait are larger: their bodies are still to move.
LARGER = {"track.py", "optimise.py", "_swim_work.py", "_swimming.py"}
ARITHMETIC = (ast.Mult, ast.Div, ast.Sub, ast.Pow, ast.MatMult)


@pytest.mark.parametrize("file", [f for f in FILES if f.name not in LARGER], ids=lambda f: f.stem)
def test_a_file_of_the_command_line_is_thin(file: Path) -> None:
    text = file.read_text()
    assert len(text.splitlines()) <= 120
    found = [
        node.lineno
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.BinOp) and isinstance(node.op, ARITHMETIC)
    ]
    assert found == []

"""The command line parses, calls a room and prints: no long file, no arithmetic except a printed number's unit."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import tentacle.cli

FILES = sorted(Path(tentacle.cli.__file__).parent.glob("*.py"))
PAGES = sorted((Path(tentacle.cli.__file__).parent / "pages").glob("*.py"))
# How a command ends, what its numbers may be, and the share done: the command line's own, not a room's.
OWN = {"_endings", "_bounds", "_progress"}
ARITHMETIC = (ast.Mult, ast.Sub, ast.Pow, ast.MatMult)
UNITS = {100, 1000.0}


@pytest.mark.parametrize("file", FILES + PAGES, ids=lambda f: f.stem)
def test_a_file_of_the_command_line_is_short(file: Path) -> None:
    assert len(file.read_text().splitlines()) <= 120


@pytest.mark.parametrize("file", [f for f in FILES if f.stem not in OWN], ids=lambda f: f.stem)
def test_a_file_of_the_command_line_computes_nothing(file: Path) -> None:
    operations = [node for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.BinOp)]
    found = [ast.unparse(node) for node in operations if isinstance(node.op, ARITHMETIC) and not a_unit(node)]
    assert found == []


def a_unit(node: ast.BinOp) -> bool:
    return isinstance(node.op, ast.Mult) and isinstance(node.left, ast.Constant) and node.left.value in UNITS

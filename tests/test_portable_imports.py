"""No module needs at its import what only Unix has: these are imported where they are used, behind a check."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tentacle.compiled_modules import ROOMS

UNIX = {"fcntl", "grp", "posix", "pty", "pwd", "resource", "syslog", "termios", "tty"}
ROOT = Path(__file__).parents[1]
FILES = [file for room in ROOMS for file in sorted((ROOT / room).rglob("*.py"))]


def _at_import(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """The statements that run when a module is imported."""
    for statement in body:
        yield statement
        if isinstance(statement, ast.If | ast.Try | ast.With | ast.ClassDef):
            for part in ("body", "orelse", "finalbody"):
                yield from _at_import(getattr(statement, part, []))


def imported(text: str) -> set[str]:
    """The modules that a text imports when it is imported itself."""
    found = set()
    for statement in _at_import(ast.parse(text).body):
        if isinstance(statement, ast.Import):
            found |= {name.name for name in statement.names}
        elif isinstance(statement, ast.ImportFrom):
            found.add(statement.module or "")
    return found


def test_an_import_is_found_where_it_runs_at_import() -> None:
    assert imported("import os, fcntl\nif True:\n    from termios import A\ndef f():\n    import pty\n") == {
        "os", "fcntl", "termios"}  # fmt: skip


@pytest.mark.parametrize("room", ROOMS)
def test_no_module_needs_unix_to_be_imported(room: str) -> None:
    files = [file for file in FILES if file.is_relative_to(ROOT / room)]
    assert files
    assert {str(file): found for file in files if (found := imported(file.read_text()) & UNIX)} == {}

"""No function of the code takes more than six arguments; more become a dataclass or a named tuple."""

from __future__ import annotations

import ast
from pathlib import Path

MOST = 6
ROOT = Path(__file__).parents[1]


def arguments(function: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) -> int:
    """How many a caller may give: not self or cls, and *args and **kwargs as one each."""
    own = function.args
    names = [a.arg for a in (*own.posonlyargs, *own.args, *own.kwonlyargs)]
    return len(names) - (names[:1] in (["self"], ["cls"])) + (own.vararg is not None) + (own.kwarg is not None)


def test_functions_take_at_most_six_arguments():
    files = [
        path for path in ROOT.rglob("*.py") if not any(part.startswith(".") for part in path.parts[len(ROOT.parts) :])
    ]
    found = {
        (str(path.relative_to(ROOT)), getattr(node, "name", "lambda"))
        for path in files
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) and arguments(node) > MOST
    }
    assert len(files) > 400  # the whole code was looked at
    assert not found

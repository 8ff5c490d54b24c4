"""The one error that bad input raises: a single line that says where, what, and what was expected."""

from __future__ import annotations

from pathlib import Path


class InputError(ValueError):
    """Input that cannot be used. The command line prints it as one line and exits with code 2."""

    def __init__(
        self,
        problem: str,
        *,
        file: str | Path | None = None,
        row: int | None = None,
        field: str | None = None,
        expected: str | None = None,
    ) -> None:
        """`row` counts lines of the file from 1, the header included."""
        self.problem, self.row, self.field, self.expected = problem, row, field, expected
        self.file = None if file is None else Path(file)
        super().__init__(self.line())

    def line(self) -> str:
        """The message, on one line: file:row: field: problem; expected ..."""
        where = "" if self.file is None else str(self.file)
        if self.row is not None:
            where += f":{self.row}"
        parts = [part for part in (where, self.field, self.problem) if part]
        text = ": ".join(parts)
        if self.expected:
            text += f"; expected {self.expected}"
        return printable(" ".join(text.split()))


def printable(text: str) -> str:
    """Text with control characters written out, because a terminal would execute them (a name can contain an
    escape).
    """
    return "".join(c if c.isprintable() else c.encode("unicode_escape", "backslashreplace").decode() for c in text)

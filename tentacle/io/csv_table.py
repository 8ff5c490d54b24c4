"""CSV files of numbers: parsed in one pass and, only if that fails, row by row to find the bad row.

Accepted: a byte order mark, CRLF, blank lines, lines that start with #, columns in any order, and blank cells where the
caller allows them. Not accepted: text, nan or inf in a cell, a row too short or too long, times that repeat or go back.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.io.plain_file import read_plain
from tentacle.io.written_file import write_text
from tentacle.signals import Array

NEVER_BLANK = ("t_s", "s")  # columns that place a row: no file may leave a cell of them empty


@dataclass(frozen=True)
class CsvTable:
    """A file's columns by name, each (N,), NaN where a cell is blank; row (N,) is each one's line in the file."""

    file: Path
    columns: dict[str, Array]
    row: NDArray[np.int64]

    def __getitem__(self, name: str) -> Array:
        return self.columns[name]

    def __contains__(self, name: str) -> bool:
        return name in self.columns

    def error(self, index: int, column: str, problem: str, expected: str | None = None) -> InputError:
        """An InputError about one cell, to be raised."""
        return InputError(problem, file=self.file, row=int(self.row[index]), field=column, expected=expected)

    def require_values(self, *names: str) -> None:
        """InputError at the first blank cell of these columns."""
        for name in names:
            blank = np.isnan(self.columns[name])
            if blank.any():
                raise self.error(int(np.argmax(blank)), name, "blank cell", "a number")

    def require_rising(self, name: str, *, repeats: bool = False) -> None:
        """InputError if a column (a time) decreases, or repeats a value without permission."""
        values = self.columns[name]
        wrong = np.diff(values) < 0 if repeats else np.diff(values) <= 0
        if wrong.any():
            index = int(np.argmax(wrong)) + 1
            before, now = values[index - 1], values[index]
            problem = f"time {now:.9g} repeats" if now == before else f"time goes back from {before:.9g} to {now:.9g}"
            raise self.error(index, name, problem, "times that rise from row to row")

    def require_within(self, name: str, limit: float, expected: str) -> None:
        """InputError at the first value of a column whose magnitude is over the limit (a wrong unit, as a rule)."""
        over = np.abs(self.columns[name]) > limit
        if over.any():
            index = int(np.argmax(over))
            raise self.error(index, name, f"{self.columns[name][index]:g} cannot be", expected)


def read_csv(
    file: Path,
    required: Sequence[str],
    *,
    optional: Sequence[str] = (),
    extra_allowed: bool = False,
    blank_allowed: bool = False,
) -> CsvTable:
    """A CSV file with a header line.

    Further columns are ignored if extra_allowed, otherwise they are an InputError, like every bad row.
    """
    data = _read_bytes(file)
    header_row, names, body_start = _header(data, file)
    _check_names(file, header_row, names, required, optional, extra_allowed)
    body = data[body_start:]
    values = _parse_at_once(body, len(names))
    if values is None:
        blanks = [name for name in names if blank_allowed and name not in NEVER_BLANK]
        values = _parse_row_by_row(body, names, blanks, file, header_row)
    if values.shape[0] == 0:
        raise InputError("no rows under the header", file=file, row=header_row, expected="at least one row of numbers")
    kept = [name for name in names if name in required or name in optional]
    columns = {name: values[:, names.index(name)].copy() for name in kept}
    table = CsvTable(file, columns, _row_numbers(body, header_row, len(values)))
    if not blank_allowed:
        table.require_values(*kept)
    return table


def column_names(file: Path) -> tuple[str, ...]:
    """The names in a CSV file's header."""
    return tuple(_header(_read_bytes(file), file)[1])


def _read_bytes(file: Path) -> bytes:
    data = read_plain(file, "a CSV file")
    return data.removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def _header(data: bytes, file: Path) -> tuple[int, list[str], int]:
    """The header's line number, its names, and where the rows begin."""
    start = 0
    for row, line in enumerate(data.split(b"\n"), start=1):
        start += len(line) + 1
        if line.strip() and not line.lstrip().startswith(b"#"):
            try:
                text = line.decode("utf-8")
            except UnicodeDecodeError:
                raise InputError("not UTF-8 text", file=file, row=row, expected="a header of column names") from None
            _refuse_other_separators(text, file, row)
            return row, [name.strip().strip('"') for name in text.split(",")], start
    raise InputError("empty file", file=file, expected="a header of column names, then rows of numbers")


def _refuse_other_separators(line: str, file: Path, row: int) -> None:
    """InputError for a file with decimal commas, or with other separators than commas."""
    for sign, name in ((";", "semicolons"), ("\t", "tabs")):
        if sign in line and "," not in line:
            raise InputError(
                f"columns are separated by {name}",
                file=file,
                row=row,
                expected="commas between columns and a point in numbers (2.5): save as CSV with these, or "
                + "replace decimal commas by points first, then each separator by a comma",
            )


def _check_names(
    file: Path, row: int, names: list[str], required: Sequence[str], optional: Sequence[str], extra_allowed: bool
) -> None:
    for name in names:
        if names.count(name) > 1:
            raise InputError("column occurs twice", file=file, row=row, field=name)
    missing = [name for name in required if name not in names]
    if missing:
        there = [] if len(missing) > 1 else get_close_matches(missing[0], names, n=1)
        hint = f" (there is {', '.join(there or names)})"
        expected = "comma-separated columns " + ",".join(required)
        problem = "column missing" if len(missing) == 1 else "columns missing"
        raise InputError(problem + hint, file=file, row=row, field=",".join(missing), expected=expected)
    known = [*required, *optional]
    unknown = [name for name in names if name not in known]
    if unknown and not extra_allowed:
        close = get_close_matches(unknown[0], known, n=1)
        hint = f" (did you mean {close[0]}?)" if close else ""
        raise InputError(
            f"unknown column{hint}", file=file, row=row, field=unknown[0], expected="columns " + ",".join(known)
        )


def _parse_at_once(body: bytes, columns: int) -> Array | None:
    """All rows (N, columns), or None if anything is unusual."""
    lower = body.lower()
    if b"nan" in lower or b"inf" in lower:
        return None
    filled = _fill_blank_cells(body)
    if not filled.strip():
        return np.empty((0, columns))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a body of comments only is handled below: it has no rows
        try:
            values = np.loadtxt(io.BytesIO(filled), delimiter=",", comments="#", ndmin=2, encoding="utf-8")
        except ValueError:
            return None
    if values.size == 0:
        return np.empty((0, columns))
    return values if values.shape[1] == columns and not np.isinf(values).any() else None  # 1e999 is infinite too


def _fill_blank_cells(body: bytes) -> bytes:
    """Empty cells become nan. Cells of blanks are left to the slow parser (bytes.replace is 20 times faster than a
    regex).
    """
    if body.startswith(b","):
        body = b"nan" + body
    if body.endswith(b","):
        body += b"nan"
    for empty, filled in ((b",,", b",nan,"), (b",,", b",nan,"), (b",\n", b",nan\n"), (b"\n,", b"\nnan,")):
        body = body.replace(empty, filled)
    return body


def _parse_row_by_row(body: bytes, names: list[str], blanks: list[str], file: Path, header_row: int) -> Array:
    """All rows (N, columns); InputError at the first bad cell. blanks: the columns in which a cell may be empty."""
    rows = []
    for row, line in enumerate(body.decode("utf-8", errors="replace").split("\n"), start=header_row + 1):
        content = line.partition("#")[0]
        if not content.strip():
            continue
        cells = content.split(",")
        if len(cells) != len(names):
            problem = f"{len(cells)} {'cell' if len(cells) == 1 else 'cells'} in this row"
            if len(cells) == 2 * len(names):
                problem += ": decimal commas (2,5 in place of 2.5)?"
            raise InputError(problem, file=file, row=row, expected=f"{len(names)}: {','.join(names)}")
        values = [_number(cell) for cell in cells]
        if None in values:
            index = values.index(None)
            text = _bare(cells[index])
            shown = text if len(text) <= 40 else text[:37] + "..."
            expected = "a number, or an empty cell for what was not seen" if names[index] in blanks else "a number"
            raise InputError(
                f"{shown!r} is no finite number", file=file, row=row, field=names[index], expected=expected
            )
        rows.append(values)
    return np.array(rows, dtype=float).reshape(len(rows), len(names))


def _number(cell: str) -> float | None:
    """The finite number in a cell, NaN of an empty one, None of anything else."""
    text = _bare(cell)
    if not text:
        return np.nan
    try:
        value = float(text)
    except ValueError:
        return None
    return value if np.isfinite(value) and "_" not in text else None  # 1_000 is a number to Python alone


def _bare(cell: str) -> str:
    return cell.strip().strip('"').strip()


def _row_numbers(body: bytes, header_row: int, count: int) -> NDArray[np.int64]:
    lines = body.removesuffix(b"\n").split(b"\n")
    if len(lines) == count:  # no comment, no blank line
        return np.arange(header_row + 1, header_row + 1 + count)
    kept = [row for row, line in enumerate(lines, start=header_row + 1) if line.partition(b"#")[0].strip()]
    return np.array(kept, dtype=np.int64)


def write_csv(file: Path, columns: dict[str, Array]) -> None:
    """A CSV file of columns (N,) each, whole or not at all, every digit kept; NaN becomes a blank cell."""
    texts = []
    for values in columns.values():
        texts.append(["" if value != value else repr(value) for value in np.asarray(values, dtype=float).tolist()])
    lines = [",".join(columns), *map(",".join, zip(*texts, strict=True))]
    write_text(file, "\n".join(lines) + "\n")

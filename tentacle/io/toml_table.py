"""Reading TOML field by field: a wrong, missing or unknown field is an InputError that names file, line and field."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from tentacle.declared import Uncertain
from tentacle.errors import InputError
from tentacle.io.plain_file import read_plain

_MISSING = object()
LARGEST_WHOLE = 2**31 - 1


def parse_toml(text: str, file: Path | None) -> dict[str, Any]:
    """The TOML document as nested dicts; InputError with the line where it is not TOML. A leading BOM is dropped."""
    try:
        return tomllib.loads(text.removeprefix("\ufeff"))
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"\(at line (\d+)", str(error))
        row = int(found.group(1)) if found else None
        raise InputError(f"not valid TOML: {error}", file=file, row=row) from None
    except ValueError as error:  # a number of thousands of digits
        raise InputError(f"not usable: {error}", file=file) from None
    except RecursionError:
        raise InputError("nested too deeply", file=file, expected="tables a few levels deep") from None


def read_toml(file: Path, expected: str | None = None) -> tuple[str, dict[str, Any]]:
    """A TOML file's text and content; InputError where it is missing (with what was expected), not UTF-8 or not
    TOML.
    """
    try:
        text = read_plain(file, expected).decode("utf-8").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise InputError(f"not UTF-8 text (byte {error.start})", file=file) from None
    return text, parse_toml(text, file)


def _float(value: Any) -> float | None:
    """A number as a float, infinite where it is beyond all floats; None where it is no number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _shown(value: Any) -> str:
    """A value as a message shows it: short."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # Python prints no number of thousands of digits
        return "a huge value"
    return text if len(text) <= 60 else f"{text[:57]}..."


def _line_of(text: str, section: str, key: str | None) -> int | None:
    """The line, from 1, of a section's key; of the section where it has no such key; None for a whole document."""
    current, opened = "", None
    for number, line in enumerate(text.splitlines(), start=1):
        header = re.match(r"\s*\[+\s*([^\]]+?)\s*\]+", line)
        if header:
            current = header.group(1).replace('"', "").replace("'", "")
            opened = number if current == section and opened is None else opened
        elif key is not None and current == section and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*[=.]", line):
            return number
    if opened is None and section and section.count(".") < 50:  # an inline table is a key of the table around it
        parent, _, name = section.rpartition(".")
        return _line_of(text, parent, name)
    return opened


class Table:
    """One TOML table that is read field by field; `finish` refuses fields that were not read.

    values: the table; name: its dotted path in the file ("" for the document); text: the file, for line numbers.
    """

    def __init__(self, values: Any, *, file: Path | None, name: str = "", text: str = "") -> None:
        self.file, self.name, self.text = file, name, text
        self.uncertain: list[Uncertain] = []  # uncertain numbers found by `measured`, here and in inner tables
        self._asked: set[str] = set()
        if not isinstance(values, Mapping):
            raise InputError(f"{_shown(values)} is not a table", file=file, field=name, expected=f"a table [{name}]")
        self._values = values

    def __contains__(self, key: str) -> bool:
        return key in self._values

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def error(self, problem: str, key: str | None = None, expected: str | None = None) -> InputError:
        """An InputError about this table or one of its keys, to be raised."""
        field = ".".join(part for part in (self.name, key) if part) or None
        row = _line_of(self.text, self.name, key) if self.text else None
        return InputError(problem, file=self.file, row=row, field=field, expected=expected)

    def raw(self, key: str, expected: str, default: Any = _MISSING) -> Any:
        """The value as TOML gave it; InputError where it is missing and has no default."""
        self._asked.add(key)
        if key in self._values:
            return self._values[key]
        if default is _MISSING:
            close = get_close_matches(key, [k for k in self._values if k not in self._asked], n=1, cutoff=0.7)
            problem = f"missing (there is {close[0]}: misspelled?)" if close else "missing"
            raise self.error(problem, key, expected)
        return default

    def table(self, key: str, *, optional: bool = False) -> Table | None:
        """A table inside this one; None where it is optional and absent."""
        name = f"{self.name}.{key}" if self.name else key
        values = self.raw(key, f"a table [{name}]", None if optional else _MISSING)
        if values is None:
            return None
        table = Table(values, file=self.file, name=name, text=self.text)
        table.uncertain = self.uncertain
        return table

    def required_table(self, key: str) -> Table:
        """A table inside this one; InputError where it is missing."""
        table = self.table(key)
        assert table is not None
        return table

    def number(
        self,
        key: str,
        default: Any = _MISSING,
        *,
        above: float = -math.inf,
        least: float = -math.inf,
        most: float = math.inf,
    ) -> float:
        """A finite number with above < number, least <= number <= most."""
        bounds = [f"> {above:g}"] * (above > -math.inf)
        bounds += [f">= {least:g}"] * (least > -math.inf) + [f"<= {most:g}"] * (most < math.inf)
        expected = " ".join(["a number", " and ".join(bounds)]).strip()
        value = self.raw(key, expected, default)
        number = _float(value)
        if number is None:
            raise self.error(f"{_shown(value)} is no number", key, expected)
        if not (math.isfinite(number) and number > above and least <= number <= most):
            remedy = "; degrees? then multiply by 0.0174533" if key.endswith("_rad") else ""
            raise self.error(f"{_shown(value)} is out of range", key, expected + remedy)
        return number

    def measured(
        self,
        key: str,
        default: Any = _MISSING,
        *,
        above: float = -math.inf,
        least: float = -math.inf,
        most: float = math.inf,
    ) -> float:
        """A number as in `number`, or { value = , sd = }, or { low = , high = }: returns its mean and stores its
        uncertainty in `uncertain`.
        """
        if not isinstance(self._values.get(key), Mapping):
            return self.number(key, default, above=above, least=least, most=most)
        table = self.required_table(key)
        ranged = "low" in table or "high" in table
        names = ("low", "high") if ranged else ("value", "sd")
        limits = {"above": above, "least": least, "most": most}
        first = table.number(names[0], **limits)
        second = table.number(names[1], **limits) if ranged else table.number(names[1], above=0.0)
        table.finish()
        if ranged and not first < second:
            raise table.error(f"{first!r} is not below high = {second!r}", "low", "low < high")
        field = f"{self.name}.{key}"
        if ranged:
            number = Uncertain(field, 0.5 * (first + second), None, first, second)
        else:
            smallest = max(least, math.nextafter(above, math.inf) if above > -math.inf else -math.inf)
            number = Uncertain(field, first, second, smallest, most)
        self.uncertain.append(number)
        return number.value

    def bound(self, key: str, default: float) -> float:
        """An end of an interval: a number, or an infinite one."""
        value = self.raw(key, "a number", default)
        infinite = isinstance(value, float) and math.isinf(value)
        return value if infinite else self.number(key, default)

    def numbers(self, key: str, count: int | None = None, *, most: float = math.inf) -> tuple[float, ...]:
        """A list of finite numbers, none beyond `most` on either side, of the given length where one is given."""
        expected = "a list of numbers" if count is None else f"a list of {count} numbers"
        expected += f" from {-most:g} to {most:g}" * (most < math.inf)
        value = self.raw(key, expected)
        numbers = [_float(x) for x in value] if isinstance(value, list) else [None]
        found = [x for x in numbers if x is not None and math.isfinite(x) and abs(x) <= most]
        if len(found) < len(numbers) or (count is not None and len(found) != count):
            raise self.error(f"{_shown(value)} is not usable", key, expected)
        return tuple(found)

    def whole_number(self, key: str, default: Any = _MISSING, *, least: int = 0) -> int:
        """A whole number >= least, of at most ten digits."""
        expected = f"a whole number >= {least}"
        value = self.raw(key, expected, default)
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= LARGEST_WHOLE:
            raise self.error(f"{_shown(value)} is not usable", key, expected)
        return value

    def choice(self, key: str, choices: Iterable[str], default: Any = _MISSING) -> str:
        """One of the given words."""
        choices = list(choices)
        expected = " or ".join(f'"{c}"' for c in choices)
        value = self.raw(key, expected, default)
        if value not in choices:
            close = get_close_matches(str(value), choices, n=1)
            hint = f" (did you mean {close[0]}?)" if close else ""
            raise self.error(f"{_shown(value)} is not known{hint}", key, expected)
        return value

    def boolean(self, key: str, default: Any = _MISSING) -> bool:
        """True or false."""
        value = self.raw(key, "true or false", default)
        if not isinstance(value, bool):
            raise self.error(f"{_shown(value)} is not usable", key, "true or false")
        return value

    def string(self, key: str, default: Any = _MISSING) -> str:
        """A text."""
        value = self.raw(key, "a text", default)
        if not isinstance(value, str):
            raise self.error(f"{_shown(value)} is no text", key, "a text in quotes")
        return value

    def names(self, key: str) -> tuple[str, ...]:
        """A list of different names; empty if the key is absent."""
        value = self.raw(key, "a list of names", [])
        if not isinstance(value, list) or not all(isinstance(name, str) and name for name in value):
            raise self.error(f"{_shown(value)} is no list of names", key, '["name", ...]')
        if len(set(value)) < len(value):
            raise self.error(f"{_shown(value)} has a name twice", key, "different names")
        return tuple(value)

    def finish(self) -> None:
        """InputError at the first key that nothing asked for, with the nearest known name."""
        for key in self._values:
            if key not in self._asked:
                close = get_close_matches(key, sorted(self._asked), n=1)
                hint = f" (did you mean {close[0]}?)" if close else ""
                raise self.error(f"unknown key{hint}", key, "one of " + ", ".join(sorted(self._asked)))

"""Conditions on a library's columns, as typed: verdict=effect, confidence>=0.9, effects~current."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from tentacle.errors import InputError

CONDITION = re.compile(r"(\w+)\s*(<=|>=|!=|=|<|>|~)\s*(.+)")
COMPARED = {"<=": "__le__", ">=": "__ge__", "!=": "__ne__", "=": "__eq__", "<": "__lt__", ">": "__gt__"}


def conditions(texts: Sequence[str], schema: pa.Schema) -> pc.Expression | None:
    """All of these conditions; None where there are none. InputError names the one that is not understood."""
    found: pc.Expression | None = None
    for text in texts:
        one = _condition(text, schema)
        found = one if found is None else found & one
    return found


def _condition(text: str, schema: pa.Schema) -> pc.Expression:
    matched = CONDITION.fullmatch(text.strip())
    if matched is None:
        raise InputError(f"{text!r} is no condition", field="--where", expected="COLUMN=VALUE, also < <= > >= != ~")
    name, sign, value = matched.groups()
    if name not in schema.names:
        raise InputError(f"no column {name!r}", field="--where", expected=f"one of {', '.join(schema.names)}")
    column, kind = pc.field(name), schema.field(name).type
    if sign == "~":
        if not pa.types.is_string(kind):
            raise InputError(f"{name} holds no text", field="--where", expected=f"{name}<VALUE, {name}=VALUE, ...")
        contains: Any = pc.__dict__["match_substring"]  # made when pyarrow starts: no type knows it
        return contains(column, value)
    return getattr(column, COMPARED[sign])(pa.scalar(_value(name, value, kind), kind))


def _value(name: str, text: str, kind: pa.DataType) -> object:
    try:
        if pa.types.is_floating(kind):
            return float(text)
        if pa.types.is_integer(kind):
            return int(text)
        if pa.types.is_boolean(kind):
            return {"true": True, "false": False}[text]
        if pa.types.is_timestamp(kind):
            date = datetime.fromisoformat(text)
            return date if date.tzinfo else date.replace(tzinfo=UTC)
    except (ValueError, KeyError):
        raise InputError(
            f"{text!r} does not fit", field=f"--where {name}", expected=f"a value of type {kind}"
        ) from None
    return text

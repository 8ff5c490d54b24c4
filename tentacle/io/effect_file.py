"""Effect files: a law of force as TOML, read and checked, and written (docs/contracts.md, docs/howto/law.md)."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import tomli_w

from tentacle.errors import InputError
from tentacle.io.toml_table import Table, read_toml
from tentacle.law.dimension import dimension_of
from tentacle.law.expression import LawError
from tentacle.law.in_use import ENVIRONMENT, laws_in_use, using
from tentacle.law.written_law import COMPONENTS, Acts, WrittenLaw, WrittenParameter

MOST_PARAMETERS, MOST_DEFINITIONS = 12, 20
EXPECTED = "an effect file: name, title, source, [law], [parameters.NAME]"


def read_effects(files: Sequence[Path], catalogue: Collection[str] = ()) -> tuple[WrittenLaw, ...]:
    """The laws of effect files; nothing in them is executed. InputError names file, row and field of an error.

    catalogue: names that no file may take.
    """
    laws: list[WrittenLaw] = []
    for file in files:
        text, values = read_toml(file, EXPECTED)
        table = Table(values, file=file, text=text)
        law = _law(table)
        if law.name in {other.name for other in laws}:
            raise table.error(f"{law.name!r} is the name of two effects", "name", "one name a file")
        if law.name in catalogue:
            raise table.error(f"the catalogue has an effect {law.name!r}", "name", "another name")
        laws.append(law)
    return tuple(laws)


@contextmanager
def effects_of(files: Sequence[Path], catalogue: Collection[str] = ()) -> Iterator[tuple[WrittenLaw, ...]]:
    """The laws of these files are in use within the context, in this process and those that it starts meanwhile.

    catalogue: names that none of them may take.
    """
    laws = read_effects(files, catalogue)
    before = os.environ.get(ENVIRONMENT)
    taken = sorted({law.name for law in laws} & {law.name for law in laws_in_use()})
    if taken:
        raise InputError(f"{taken[0]!r} is in use already", field="name", expected="one name an effect")
    if files:
        places = [before] if before else []
        os.environ[ENVIRONMENT] = os.pathsep.join([*places, *(str(Path(file).resolve()) for file in files)])
    try:
        with using(laws):
            yield laws
    finally:
        if before is not None:
            os.environ[ENVIRONMENT] = before
        elif files:
            os.environ.pop(ENVIRONMENT, None)


def _law(table: Table) -> WrittenLaw:
    name = table.string("name")
    if not (name.isidentifier() and name.isascii() and len(name) <= 40):
        raise table.error(f"{name!r} is no usable name", "name", "letters, digits and _")
    title, source = table.string("title", name), table.string("source")
    law_table = table.required_table("law")
    acts: Acts = law_table.choice("acts", list(COMPONENTS))  # type: ignore[assignment]
    components = {part: law_table.string(part) for part in COMPONENTS[acts] if part in law_table}
    if not components:
        raise law_table.error("no law", COMPONENTS[acts][0], f"an expression in {' or '.join(COMPONENTS[acts])}")
    relaxation = law_table.string("relaxation") if acts == "moment" and "relaxation" in law_table else None
    dissipative = law_table.boolean("dissipative", False)
    law_table.finish()
    definitions = _named(table, "define", MOST_DEFINITIONS)
    constants = _constants(table)
    law = WrittenLaw(
        name, title, source, acts, components, _parameters(table), definitions, constants, relaxation, dissipative
    )
    table.finish()
    try:
        law.check()
    except (LawError, RecursionError) as error:
        raise law_table.error(str(error), next(iter(components)), "an expression of docs/howto/law.md") from None
    return law


def _named(table: Table, key: str, most: int) -> dict[str, str]:
    inner = table.table(key, optional=True)
    if inner is None:
        return {}
    names = list(inner)
    if len(names) > most:
        raise table.error(f"{len(names)} entries", key, f"{most} at most")
    return {name: inner.string(name) for name in names}


def _constants(table: Table) -> dict[str, tuple[float, str]]:
    inner = table.table("constants", optional=True)
    found: dict[str, tuple[float, str]] = {}
    for name in inner or ():
        assert inner is not None
        one = inner.required_table(name)
        found[name] = (one.number("value"), _unit(one))
        one.finish()
    return found


def _unit(table: Table) -> str:
    unit = table.string("unit")
    try:
        dimension_of(unit)
    except ValueError as error:
        raise table.error(str(error), "unit", 'SI units without prefix, as "N/m^2" or "1"') from None
    return unit


def _parameters(table: Table) -> tuple[WrittenParameter, ...]:
    inner = table.required_table("parameters")
    names = list(inner)
    if not 1 <= len(names) <= MOST_PARAMETERS:
        raise table.error(f"{len(names)} parameters", "parameters", f"1 to {MOST_PARAMETERS}")
    found = []
    for name in names:
        one = inner.required_table(name)
        if not (name.isidentifier() and name.isascii()):
            raise one.error(f"{name!r} is no usable name", None, "letters, digits and _")
        unit, (low, high) = _unit(one), one.numbers("bounds", 2)
        scan = one.numbers("scan") if "scan" in one else ()
        nominal = one.number("nominal")
        neutral = scan[0] if scan else 0.0
        if not (low < high and low <= neutral <= high and low <= nominal <= high and nominal != 0.0):
            wanted = "low < high, with the nominal value (not 0) and 0, or the first scan value, between them"
            raise one.error(f"({low:g}, {high:g})", "bounds", wanted)
        if any(not low <= value <= high for value in scan):
            raise one.error("a value lies beyond the bounds", "scan", "values within the bounds")
        found.append(WrittenParameter(name, unit, nominal, (low, high), one.string("words"), scan))
        one.finish()
    return tuple(found)


def effect_text(law: WrittenLaw) -> str:
    """The effect file of a law, as read_effects reads it."""
    table: dict[str, Any] = {"name": law.name, "title": law.title, "source": law.source}
    where = {} if law.relaxation is None else {"relaxation": law.relaxation}
    table["law"] = {"acts": law.acts, **law.components, **where, **({"dissipative": True} if law.dissipative else {})}
    if law.definitions:
        table["define"] = dict(law.definitions)
    if law.constants:
        table["constants"] = {name: {"value": value, "unit": unit} for name, (value, unit) in law.constants.items()}
    table["parameters"] = {
        p.name: {"unit": p.unit, "nominal": float(p.nominal), "bounds": [float(value) for value in p.bounds],
                 "words": p.words, **({"scan": [float(value) for value in p.scan]} if p.scan else {})}
        for p in law.parameters
    }  # fmt: skip
    return tomli_w.dumps(table)

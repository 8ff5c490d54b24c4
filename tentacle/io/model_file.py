"""model.toml: an identified model as text and back, exactly.

[specimen], [fluid], [gravity] as in recording.toml; order = number of curvature coordinates; then one table per effect,
[effects.NAME], one line per parameter: PARAMETER = {value, low, high, unit}. [posterior], if the fit's covariance is
known: parameters (names "effect.parameter"), deviation (one each), correlation (rows in the same order).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import tomli_w

from tentacle.io.declaration_file import (
    fluid_table,
    gravity_table,
    parse_fluid,
    parse_gravity,
    parse_specimen,
    specimen_table,
)
from tentacle.io.toml_table import Table, read_toml
from tentacle.io.written_file import write_text
from tentacle.model import Estimate, Model
from tentacle.posterior import Posterior
from tentacle.specimen import AIR, HANGING_DOWN


def read_model(file: Path) -> Model:
    """The model in a model.toml; InputError names line and field of the first thing that is wrong."""
    text, values = read_toml(Path(file))
    return parse_model(Table(values, file=Path(file), text=text))


def write_model(model: Model, file: Path) -> None:
    """A model as model.toml, every digit kept; the file appears whole or not at all."""
    write_text(Path(file), tomli_w.dumps(model_tables(model)))


def parse_model(document: Table) -> Model:
    """model.toml's content, checked."""
    fluid, gravity = document.table("fluid", optional=True), document.table("gravity", optional=True)
    effects = document.table("effects", optional=True)
    parameters = {} if effects is None else {name: _parse_effect(effects, name) for name in effects}
    posterior = document.table("posterior", optional=True)
    model = Model(
        specimen=parse_specimen(document.required_table("specimen")),
        fluid=parse_fluid(fluid) if fluid else AIR,
        gravity=parse_gravity(gravity) if gravity else HANGING_DOWN,
        order=document.whole_number("order", 2, least=1),
        parameters=parameters,
        posterior=None if posterior is None else _parse_posterior(posterior, parameters),
    )
    document.finish()
    if document.uncertain:
        raise document.error("is uncertain", document.uncertain[0].field, "a number: a model is one arm")
    return model


def _parse_effect(effects: Table, name: str) -> dict[str, Estimate]:
    effect = effects.required_table(name)
    return {parameter: _parse_estimate(effect.required_table(parameter)) for parameter in effect}


def _parse_estimate(table: Table) -> Estimate:
    value = table.number("value")
    estimate = Estimate(value, table.bound("low", value), table.bound("high", value), table.string("unit", "1"))
    table.finish()
    if not estimate.low <= value <= estimate.high:
        raise table.error(f"{value!r} is not between low and high", "value", f"{estimate.low!r} to {estimate.high!r}")
    return estimate


def _parse_posterior(table: Table, parameters: dict[str, dict[str, Estimate]]) -> Posterior:
    known = {f"{effect}.{name}" for effect, values in parameters.items() for name in values}
    names = table.raw("parameters", "a list of names")
    if not isinstance(names, list) or not all(isinstance(name, str) and name in known for name in names):
        raise table.error("names a parameter that the model lacks", "parameters", '["effect.parameter", ...]')
    deviation = table.numbers("deviation", len(names))
    rows = table.raw("correlation", "rows of numbers")
    table.finish()
    try:
        return Posterior(tuple(names), deviation, tuple(tuple(float(one) for one in row) for row in rows))
    except (OverflowError, TypeError, ValueError) as error:
        raise table.error(f"{error}", "correlation", f"{len(names)} rows of {len(names)} correlations") from None


def model_tables(model: Model) -> dict[str, Any]:
    """A model as model.toml's tables."""
    effects = {
        effect: {name: {"value": e.value, "low": e.low, "high": e.high, "unit": e.unit} for name, e in values.items()}
        for effect, values in model.parameters.items()
    }
    tables = {
        "order": model.order,
        "specimen": specimen_table(model.specimen),
        "fluid": fluid_table(model.fluid),
        "gravity": gravity_table(model.gravity),
        "effects": effects,
    }
    known = model.posterior
    if known is None:
        return tables
    rows = [list(row) for row in known.correlation]
    carried = {"parameters": list(known.names), "deviation": list(known.deviation), "correlation": rows}
    return {**tables, "posterior": carried}

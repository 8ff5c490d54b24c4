"""Verdicts as layers beside the recordings: a folder a diagnosis, named by what it was made from.

    LIBRARY/layers/KEY/layer.json        what the index takes from it
    LIBRARY/layers/KEY/residual.json     what the model leaves, small, for the page
    LIBRARY/layers/KEY/verdict.json, report.html, session.rrd, model.toml

KEY is the hash of the recording's content, of the content of its baseline, and of the settings. The layer states the
version of the code: a layer of older code stays readable and is marked. Nothing is ever written into a recording.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from tentacle.errors import InputError
from tentacle.io.written_file import write_text

LIBRARY_ROOMS = ("tentacle", "affine_model", "vision", "inference", "discovery")
LAYERS = pa.schema(
    [
        ("key", pa.string()), ("sha256", pa.string()), ("code", pa.string()), ("verdict", pa.string()),
        ("effects", pa.string()), ("confidence", pa.float64()), ("before_mm", pa.float64()),
        ("after_mm", pa.float64()), ("floor_mm", pa.float64()), ("held_out", pa.bool_()), ("failed", pa.string()),
        ("written_ns", pa.int64()),
    ]
)  # fmt: skip
PARAMETERS = pa.schema(
    [
        ("key", pa.string()), ("sha256", pa.string()), ("effect", pa.string()), ("parameter", pa.string()),
        ("value", pa.float64()), ("low", pa.float64()), ("high", pa.float64()), ("unit", pa.string()),
    ]
)  # fmt: skip
LAYER, RESIDUAL = "layer.json", "residual.json"


@cache
def library_code_version() -> str:
    """A hash of the source of every room that a verdict comes from."""
    total = hashlib.sha256()
    for room in LIBRARY_ROOMS:
        spec = find_spec(room)
        for place in spec.submodule_search_locations or [] if spec else []:
            for file in sorted(Path(place).rglob("*.py")):
                total.update(str(file.relative_to(place)).encode() + file.read_bytes())
    return total.hexdigest()[:16]


def layer_key(content: str, settings: Mapping[str, Any]) -> str:
    """The name of a diagnosis of that content (SHA-256) with these settings (plain data)."""
    text = json.dumps([content, settings], sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def write_layer(layer: Mapping[str, Any], folder: Path) -> None:
    """A layer's data into its folder, whole or not at all; the residual stands in a file of its own."""
    folder.mkdir(parents=True, exist_ok=True)
    layer = dict(layer)
    write_text(folder / RESIDUAL, json.dumps(layer.pop("residual_mm", [])) + "\n")
    write_text(folder / LAYER, json.dumps(layer) + "\n")


def _read_layer(file: Path) -> dict[str, Any]:
    """A layer's data. InputError where it is damaged."""
    try:
        layer = json.loads(file.read_text(encoding="utf-8"))
        return {**layer, "sha256": str(layer["sha256"]), "parameters": list(layer["parameters"])}
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        words = f"is damaged: {type(error).__name__}"
        raise InputError(words, file=file, expected="delete this file, and the recording is diagnosed again") from None


def layers_and_parameters(folders: Sequence[Path], layers: pa.Table, parameters: pa.Table) -> tuple[pa.Table, pa.Table]:
    """The layers in these folders as tables, only those read that are not in the tables given, or changed since."""
    known: dict[str, dict[str, Any]] = {row["key"]: row for row in layers.to_pylist()}
    kept, rows, added = [], [], []
    for folder in folders:
        written_ns = (folder / LAYER).stat().st_mtime_ns
        row = known.get(folder.name)
        if row is not None and row["written_ns"] == written_ns:
            rows.append(row)
            kept.append(folder.name)
            continue
        layer = _read_layer(folder / LAYER)
        own = {"key": folder.name, "written_ns": written_ns}
        rows.append({name: layer.get(name) for name in LAYERS.names} | own)
        added += [{"key": folder.name, "sha256": layer["sha256"], **values} for values in layer["parameters"]]
    before = parameters.filter(pc.field("key").isin(pa.array(kept, pa.string())))
    after = pa.concat_tables([before, pa.Table.from_pylist(added, schema=PARAMETERS)])
    return pa.Table.from_pylist(rows, schema=LAYERS), after

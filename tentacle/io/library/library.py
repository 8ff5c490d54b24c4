"""A library: recordings where they lie, and beside them a folder with the index and the layers of verdicts."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from tentacle.errors import InputError
from tentacle.io.library.index import read_index, recordings_of, refreshed, write_parquet
from tentacle.io.library.layers import LAYER, LAYERS, PARAMETERS, code_version, layer_key, layers_and_parameters

SETTINGS = "settings.json"


def _untold(_done: int, _of: int) -> None:
    """Progress that nobody watches."""


@dataclass(frozen=True)
class Library:
    """source: a folder of .rrd files or a list of them; home: the folder of index and layers; settings: what a
    diagnosis depends on besides the recording (plain data).
    """

    source: Path
    home: Path
    settings: Mapping[str, Any]

    @property
    def index_file(self) -> Path:
        """Recordings."""
        return self.home / "index.parquet"

    def layer(self, content: str) -> Path:
        """Where the diagnosis of that content (SHA-256) lies or will lie."""
        return self.home / "layers" / layer_key(content, self.settings)

    def refresh(self, told: Callable[[int, int], None] = _untold) -> int:
        """Read what is new or changed into the index; how many files that was. A layer of what is gone stays."""
        index, read = refreshed(read_index(self.index_file), recordings_of(self.source), told)
        self.home.mkdir(parents=True, exist_ok=True)
        if read or index.num_rows != read_index(self.index_file).num_rows:
            write_parquet(index, self.index_file)
        self.gather()
        return read

    def gather(self) -> None:
        """Write the tables of layers and parameters anew from the layers of the recordings that are here."""
        contents = dict.fromkeys(read_index(self.index_file).column("sha256").to_pylist())
        folders = [folder for folder in map(self.layer, contents) if (folder / LAYER).exists()]
        layers, parameters = layers_and_parameters(folders)
        write_parquet(layers, self.home / "verdicts.parquet")
        write_parquet(parameters, self.home / "parameters.parquet")

    def table(self) -> pa.Table:
        """Recordings with their verdicts, a row each, by date: the index's columns, the layer's, `state`.

        state: done, older code, new, failed, unreadable.
        """
        index, layers = read_index(self.index_file), self._stored("verdicts.parquet", LAYERS)
        known: dict[str, dict[str, Any]] = {row["sha256"]: row for row in layers.to_pylist()}
        blank: dict[str, Any] = dict.fromkeys(LAYERS.names)
        rows = []
        for row in index.to_pylist():
            layer = known.get(row["sha256"])
            rows.append({**(layer or blank), **row, "state": _state(row, layer)})
        columns = [*index.schema, *(f for f in LAYERS if f.name != "sha256"), pa.field("state", pa.string())]
        table = pa.Table.from_pylist(rows, schema=pa.schema(columns))
        return table.sort_by([("date", "ascending"), ("path", "ascending")])

    def parameters(self) -> pa.Table:
        """Every fitted parameter with its interval, a row each, of all layers here."""
        return self._stored("parameters.parquet", PARAMETERS)

    def _stored(self, name: str, schema: pa.Schema) -> pa.Table:
        file = self.home / name
        return pq.read_table(file, schema=schema) if file.exists() else schema.empty_table()


def _state(row: Mapping[str, Any], layer: Mapping[str, Any] | None) -> str:
    if row["fault"] is not None:
        return "unreadable"
    if layer is None:
        return "new"
    if layer["failed"] is not None:
        return "failed"
    return "done" if layer["code"] == code_version() else "older code"


def open_library(source: Path, home: Path | None = None, settings: Mapping[str, Any] | None = None) -> Library:
    """A library over a folder or a list; home: default NAME.library beside it.

    settings None: those of the last diagnosis, which the home remembers. InputError where there is no such source.
    """
    source = source.resolve()
    if not source.exists():
        raise InputError("no such folder or list", file=source, expected="a folder of .rrd files, or a list of them")
    home = source.with_name(f"{source.stem if source.is_file() else source.name}.library") if home is None else home
    memory = home / SETTINGS
    chosen: dict[str, Any] = {}
    if settings is not None:
        chosen.update(settings)
        home.mkdir(parents=True, exist_ok=True)
        memory.write_text(json.dumps(chosen) + "\n", encoding="utf-8")
    elif memory.exists():
        chosen.update(json.loads(memory.read_text(encoding="utf-8")))
    return Library(source, home.resolve(), chosen)

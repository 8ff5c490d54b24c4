"""A library: recordings in their folder, and beside it a folder with the index and the layers of verdicts."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from tentacle.errors import InputError
from tentacle.io.library.index import read_index, read_parquet, recordings_of, refreshed, write_parquet
from tentacle.io.library.joint import joint_column, read_joint
from tentacle.io.library.layers import LAYER, LAYERS, PARAMETERS, layer_key, layers_and_parameters, library_code_version
from tentacle.io.written_file import write_text

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

    @property
    def runs(self) -> Path:
        """What the runner keeps of diagnoses under way."""
        return self.home / "runs"

    @property
    def joint_file(self) -> Path:
        """The joint answer."""
        return self.home / "joint.json"

    def evidence(self, content: str, order: int) -> Path:
        """Where the evidence of that content (SHA-256) lies, of a model with that many coordinates."""
        return self.home / "evidence" / f"{content}_{order}.npz"

    def layer(self, content: str) -> Path:
        """Where the diagnosis of that content (SHA-256) lies or will lie."""
        return self.home / "layers" / layer_key(content, self.settings)

    def refresh(self, told: Callable[[int, int], None] = _untold, settled: float = 0.0) -> int:
        """Read what is new or changed into the index; how many files that was. A layer of what is gone stays.

        settled [s]: a file that changed more recently is left out: it is still being written.
        """
        latest = time.time() - settled
        files = [file for file in recordings_of(self.source) if settled <= 0.0 or file.stat().st_mtime <= latest]
        index, read = refreshed(read_index(self.index_file), files, told)
        self.home.mkdir(parents=True, exist_ok=True)
        if read or index.num_rows != read_index(self.index_file).num_rows:
            write_parquet(index, self.index_file)
        self.gather()
        return read

    def gather(self) -> None:
        """Write the tables of layers and parameters anew from the layers of the recordings that are here."""
        contents = dict.fromkeys(read_index(self.index_file).column("sha256").to_pylist())
        folders = [folder for folder in map(self.layer, contents) if (folder / LAYER).exists()]
        layers, parameters = layers_and_parameters(folders, self._stored("verdicts.parquet", LAYERS), self.parameters())
        write_parquet(layers, self.home / "verdicts.parquet")
        write_parquet(parameters, self.home / "parameters.parquet")

    def table(self) -> pa.Table:
        """Recordings with their verdicts, a row each, by date: the index's columns, the layer's, `state`, `joint`.

        state: done, older code, new, failed, unreadable. joint: see joint_column.
        """
        index, layers = read_index(self.index_file), self._stored("verdicts.parquet", LAYERS)
        table = index.join(layers, "sha256", join_type="left outer")
        columns = [*index.schema.names, *(name for name in LAYERS.names if name != "sha256")]
        table = table.select(columns).append_column("state", _states(table))
        contents = table.column("sha256").to_pylist()
        table = table.append_column("joint", joint_column(read_joint(self.joint_file), contents))
        return table.sort_by([("date", "ascending"), ("path", "ascending")])

    def parameters(self) -> pa.Table:
        """Every fitted parameter with its interval, a row each, of all layers here."""
        return self._stored("parameters.parquet", PARAMETERS)

    def _stored(self, name: str, schema: pa.Schema) -> pa.Table:
        return read_parquet(self.home / name, schema)


def _states(table: pa.Table) -> pa.ChunkedArray:
    """state of every row of a table that has the columns of index and layers."""
    calls: Any = pc.__dict__  # made when pyarrow starts: no type knows them
    current = calls["fill_null"](calls["equal"](table["code"], library_code_version()), False)
    cases = {
        "unreadable": calls["is_valid"](table["fault"]),
        "new": calls["is_null"](table["code"]),
        "failed": calls["is_valid"](table["failed"]),
        "done": current,
    }
    which = pa.StructArray.from_arrays([_whole(case) for case in cases.values()], names=list(cases))
    return calls["case_when"](which, *cases, "older code")


def _whole(column: pa.ChunkedArray) -> pa.Array:
    return column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column


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
        write_text(memory, json.dumps(chosen) + "\n")
    elif memory.exists():
        chosen.update(_settings(memory))
    return Library(source, home.resolve(), chosen)


def _settings(memory: Path) -> dict[str, Any]:
    """The settings of the last diagnosis. InputError where the file is damaged."""
    try:
        found = json.loads(memory.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise InputError("damaged", file=memory, expected="the settings of a diagnosis; without the file: the default")
    return found

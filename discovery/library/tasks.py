"""The work on one recording of a library that tentacle.runner hands to processes or Dask, as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from numpy.linalg import LinAlgError

from discovery.library.evidence import base_hypothesis, evidence_of, order_of, write_evidence
from tentacle.errors import InputError
from vision.tracked_recording import read_tracked

CODE = "code"  # under which name an evidence file keeps the version that made it


def order_work(task: Mapping[str, Any]) -> dict[str, Any]:
    """How many coordinates one recording shows, or why it is of no use."""
    try:
        order = order_of(read_tracked(Path(task["path"]), _quiet))
    except InputError as error:
        return {"path": task["path"], "order": 0, "failed": error.line()}
    return {"path": task["path"], "order": order, "failed": None}


def evidence_work(task: Mapping[str, Any]) -> dict[str, Any]:
    """One recording's evidence, written whole."""
    path = Path(task["path"])
    try:
        found = evidence_of(base_hypothesis(read_tracked(path, _quiet), task["order"]))
        write_evidence(found, Path(task["file"]), **{CODE: task["code"]})
    except InputError as error:
        return {"path": task["path"], "failed": error.line()}
    except LinAlgError as error:
        return {"path": task["path"], "failed": f"the declared model cannot follow it: {error}"}
    return {"path": task["path"], "failed": None}


def _quiet(words: str, done: float = 0.0) -> None:
    """Progress of one recording among many is not shown."""
    del words, done

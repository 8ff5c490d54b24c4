"""How a run ended, beside its file, where the file itself could not take it any more: NAME.rrd.stop.json.

A small file of zeros keeps the room for it from the start of the run on.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

STOP_FILE_ROOM = 64 * 1024  # bytes


def reserve(run: Path) -> None:
    """Keeps room for a stop document."""
    _reserved(run).write_bytes(bytes(STOP_FILE_ROOM))


def release(run: Path) -> None:
    """Gives the room back."""
    _reserved(run).unlink(missing_ok=True)


def write_stop(run: Path, record: dict[str, Any]) -> bool:
    """Writes a stop document into the room that was kept; whether that went well."""
    text = json.dumps(record).encode()
    kept = _reserved(run)
    with suppress(OSError):
        with kept.open("r+b" if kept.exists() else "wb") as file:
            file.write(text)
            file.truncate()
            file.flush()
            os.fsync(file.fileno())
        kept.replace(stop_file(run))
        return True
    return False


def read_stop(run: Path) -> dict[str, Any] | None:
    """The stop document beside a run; None where there is none, or it is torn."""
    with suppress(OSError, ValueError):
        found = json.loads(stop_file(run).read_bytes())
        return found if isinstance(found, dict) else None
    return None


def stop_file(run: Path) -> Path:
    """Where it lies."""
    return run.with_name(f"{run.name}.stop.json")


def _reserved(run: Path) -> Path:
    return run.with_name(f".{run.name}.reserve")

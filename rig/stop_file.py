"""The stop document of a run beside its file, NAME.rrd.stop.json, until the file itself has it. A small file that names
the process reserves its space from the start of the run. The document is written when the arm is at neutral; then the
film is made, which takes long. The document stays if the file cannot take its stop record.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

from tentacle.io.written_file import is_running

STOP_FILE_ROOM = 64 * 1024  # bytes


def reserve(run: Path) -> None:
    """Reserves room for a stop document, and removes that of an earlier run whose file is gone. Removes the room of
    runs in the folder whose process was killed, too.
    """
    for left in run.parent.glob(".*.rrd.reserve"):
        with suppress(OSError):
            if not is_running(left.read_bytes()[:32].rstrip(b"\0").decode(errors="replace")):
                left.unlink()
    stop_file(run).unlink(missing_ok=True)
    _reserved(run).write_bytes(str(os.getpid()).encode().ljust(STOP_FILE_ROOM, b"\0"))


def release(run: Path) -> None:
    """Removes the document: the run's file holds the stop record now."""
    _reserved(run).unlink(missing_ok=True)
    stop_file(run).unlink(missing_ok=True)


def write_stop(run: Path, record: dict[str, Any]) -> bool:
    """Writes a stop document into the reserved room or over an earlier one. Returns whether that succeeded."""
    text = json.dumps(record).encode().ljust(STOP_FILE_ROOM)  # the room stays, for another one
    kept = next((file for file in (_reserved(run), stop_file(run)) if file.exists()), _reserved(run))
    with suppress(OSError):
        with kept.open("r+b" if kept.exists() else "wb") as file:
            file.write(text)
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
    """Path of the stop document."""
    return run.with_name(f"{run.name}.stop.json")


def _reserved(run: Path) -> Path:
    return run.with_name(f".{run.name}.reserve")

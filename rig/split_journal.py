"""The journal of a campaign that runs until its explanations are split: a line of JSON for each decision or failure.

A decision's line names the runs that were judged and the hash of each file. A decision counts only for exactly those
files. The run that follows a decision holds it too, in its start record, so that a lost line is written again from
there. A failure's line names the run, what kept it from its end, and when; it has no part in what comes next.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from rig.fault import Fault
from rig.journal import set_aside
from rig.split_decision import Decision, decision_from
from tentacle.io.written_file import write_text

NAME = "until_split.jsonl"


def hashes(runs: Sequence[Path]) -> dict[str, str]:
    """File name -> SHA-256 of its content."""
    found = {}
    for path in runs:
        with path.open("rb") as file:
            found[path.name] = hashlib.file_digest(file, "sha256").hexdigest()
    return found


def open_journal(folder: Path, told: Callable[[str], None]) -> list[dict[str, Any]]:
    """The journal's lines. A journal with an unreadable line is set aside."""
    journal = folder / NAME
    if not journal.exists():
        return []
    lines = []
    for number, line in enumerate(journal.read_bytes().splitlines(), start=1):
        try:
            lines.append(_checked(json.loads(line)))
        except (ValueError, KeyError, TypeError):
            told(f"{journal}:{number}: damaged; it is now {set_aside(journal).name}, and is made again from the runs")
            return []
    return lines


def _checked(entry: dict[str, Any]) -> dict[str, Any]:
    """The entry; KeyError, TypeError or ValueError where it is neither a decision nor a failure."""
    if "failed" in entry:
        if not all(isinstance(entry[key], str) for key in ("failed", "kind", "words", "utc")):
            raise TypeError("a failure is told in text")
        return entry
    decision_from(entry["decision"])
    dict(entry["runs"])
    return entry


def failure(run: str, fault: Fault) -> dict[str, Any]:
    """The entry for an attempt at a run that failed."""
    utc = datetime.now(UTC).isoformat(timespec="seconds")
    return {"failed": run, "kind": fault.kind, "words": str(fault), "utc": utc}


def decision_on(lines: Sequence[dict[str, Any]], judged: dict[str, str]) -> Decision | None:
    """What was decided on exactly these files; None where nothing was."""
    return next((decision_from(line["decision"]) for line in reversed(lines) if line.get("runs") == judged), None)


def append(folder: Path, lines: list[dict[str, Any]], entry: dict[str, Any]) -> None:
    """A line more, a decision's {"runs", "decision"} or a failure's, on the disk before this returns."""
    lines.append(entry)
    write_text(folder / NAME, "".join(json.dumps(line) + "\n" for line in lines))

"""The journal of a campaign that runs until its explanations are split: a line of JSON for each decision.

Every line names the runs that were judged and the hash of each file. A decision counts only for exactly those files.
The run that follows a decision holds it too, in its start record, so that a lost line is written again from there.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

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
            entry = json.loads(line)
            decision_from(entry["decision"])
            dict(entry["runs"])
            lines.append(entry)
        except (ValueError, KeyError, TypeError):
            told(f"{journal}:{number}: damaged; it is now {set_aside(journal).name}, and is made again from the runs")
            return []
    return lines


def decision_on(lines: Sequence[dict[str, Any]], judged: dict[str, str]) -> Decision | None:
    """What was decided on exactly these files; None where nothing was."""
    return next((decision_from(line["decision"]) for line in reversed(lines) if line["runs"] == judged), None)


def append(folder: Path, lines: list[dict[str, Any]], entry: dict[str, Any]) -> None:
    """A line {"runs", "decision"} more, on the disk before this returns."""
    lines.append(entry)
    write_text(folder / NAME, "".join(json.dumps(line) + "\n" for line in lines))

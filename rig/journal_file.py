"""The file of a study's journal: Optuna's entries, one a line, each behind a checksum of all lines up to it.

A changed, missing, doubled or moved line does not agree with its checksum. Only the end of the file can be missing
without notice; the recordings tell what was there.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from optuna.storages.journal import BaseJournalBackend

DIGITS = 16  # of a checksum


class JournalFile(BaseJournalBackend):
    """Optuna's entries in a file that is sound and belongs to this process alone."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._texts = sound_entries(_lines(file))
        self._sum = _chained("", self._texts)

    def read_logs(self, log_number_from: int) -> Iterable[dict[str, Any]]:
        """The entries from a number on."""
        return [json.loads(text) for text in self._texts[log_number_from:]]

    def append_logs(self, logs: list[dict[str, Any]]) -> None:
        """Adds entries; they are on the disk when it returns."""
        lines = ""
        for log in logs:
            text = json.dumps(log, separators=(",", ":"))
            self._sum = _chained(self._sum, [text])
            self._texts.append(text)
            lines += f"{self._sum} {text}\n"
        with self._file.open("ab") as opened:
            opened.write(lines.encode())
            opened.flush()
            os.fsync(opened.fileno())


def sound_entries(lines: Iterable[bytes]) -> list[str]:
    """The entries of the lines up to the first that does not agree with its checksum."""
    found: list[str] = []
    total = ""
    for line in lines:
        given, _, data = line.partition(b" ")
        text = data.decode(errors="replace")
        total = _chained(total, [text])
        if given != total.encode() or not _is_entry(data):
            break
        found.append(text)
    return found


def cut_torn_end(file: Path) -> int | None:
    """Removes what a crash left behind the last sound line: a part of a line, zeros. Returns None, or, if there are
    entries behind a line that is not sound, the number of that line; nothing is removed then.
    """
    data = file.read_bytes() if file.exists() else b""
    lines = data.split(b"\n")
    sound = len(sound_entries(lines[:-1]))
    if any(_is_entry(line.partition(b" ")[2]) or _is_entry(line) for line in lines[sound + 1 :]):
        return sound + 1
    whole = sum(len(line) + 1 for line in lines[:sound])
    if whole < len(data):
        with file.open("rb+") as opened:
            opened.truncate(whole)
    return None


def _lines(file: Path) -> list[bytes]:
    return file.read_bytes().split(b"\n")[:-1] if file.exists() else []


def _chained(total: str, texts: Iterable[str]) -> str:
    for text in texts:
        total = hashlib.sha256(f"{total} {text}".encode(errors="replace")).hexdigest()[:DIGITS]
    return total


def _is_entry(data: bytes) -> bool:
    try:
        return isinstance(json.loads(data), dict)
    except (ValueError, RecursionError):
        return False

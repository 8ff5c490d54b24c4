"""Notes of a search that were damaged: what is read is the beginning of what was noted, never something else."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tentacle.io.search_notes import SearchNotes
from tentacle.signals import Array

INPUTS = {"model": "arm", "seed": 3}


@dataclass(frozen=True)
class Generation:
    number: int
    scores: Array


def test_damaged_notes_are_cut_at_the_damage(tmp_path: Path) -> None:
    source = np.random.default_rng(0)
    true = [source.normal(size=6) for _ in range(5)]
    notes = SearchNotes(tmp_path / "search.jsonl", INPUTS)
    assert list(notes.scores()) == []
    for number, scores in enumerate(true):
        notes.note(Generation(number, scores))
    written = (tmp_path / "search.jsonl").read_bytes()
    lines = written.split(b"\n")
    exchanged = b"\n".join([lines[0], lines[2], lines[1], *lines[3:]])
    flips = [(at, 1 << int(source.integers(8))) for at in source.integers(0, len(written), 300)]
    damaged = [written[:at] + bytes([written[at] ^ bit]) + written[at + 1 :] for at, bit in flips]
    damaged += [written[:at] for at in range(0, len(written), 97)]
    damaged += [exchanged, written[:200] + bytes(64) + written[264:], b"\xff" + written, b""]
    counts = set()
    for content in damaged:
        (tmp_path / "search.jsonl").write_bytes(content)
        found = list(SearchNotes(tmp_path / "search.jsonl", INPUTS).scores())
        counts.add(len(found))
        np.testing.assert_array_equal(found, true[: len(found)])
    assert counts == {0, 1, 2, 3, 4}

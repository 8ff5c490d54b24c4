"""One bit of a run's file turned: the run is refused, or nothing that is read from it has changed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks._rig_optimise import DECLARED
from rig.run_file import iterate_frames, read_run
from rig.soundness import check_file
from tentacle.io.recording_from_rrd import read_rrd
from tentacle.waveform import Chirp
from tests.rig.filmed import filmed_run

FLIPS = 40  # each is read by two readers, in half a second


@pytest.mark.long
def test_a_turned_bit_is_refused_or_changes_nothing(tmp_path: Path) -> None:
    whole, turned = tmp_path / "run.rrd", tmp_path / "turned.rrd"
    filmed_run(DECLARED, {}, Chirp(0.4, 0.5, 2.0, 1.0), 1.0, whole, {"kind": "chirp"})
    content, written = _content(whole), whole.read_bytes()
    assert check_file(whole)[0].sound
    source, refused = np.random.default_rng(0), 0
    for at in source.integers(0, len(written), FLIPS):
        damaged = bytearray(written)
        damaged[at] ^= 1 << int(source.integers(8))
        turned.write_bytes(damaged)
        sound = check_file(turned)[0].sound
        refused += not sound
        assert not sound or _content(turned) == content, f"byte {at}"
    assert refused > FLIPS // 2  # most of the file is data; the rest is the format's own padding and names


def _content(file: Path) -> list[Any]:
    """All that a reader makes of a run: what the board said, the recording, the pictures."""
    return [_plain(read_run(file)), _plain(read_rrd(file)), list(iterate_frames(file))]


def _plain(value: Any) -> Any:
    """A value without its place on the disk, so that two of them can be compared."""
    if isinstance(value, np.ndarray):
        return value.tobytes()
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items() if name != "source"}
    if hasattr(value, "__dict__"):
        return {name: _plain(one) for name, one in vars(value).items() if name not in ("path", "name", "video")}
    return repr(value)

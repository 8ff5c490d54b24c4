"""Where there is no /dev/fd Rerun writes the file itself: what is read back is the same, and a missing end is told."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import tentacle
from tentacle.io.direct_file import DirectFile, way_to_disk
from tentacle.io.recording_rrd import write_rrd
from tests.tentacle.io.test_import_folder import assert_equal_recordings, random_recording


def test_a_recording_comes_back_and_one_without_its_end_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tentacle.io.direct_file.ENTRANCES", tmp_path / "none")
    file = tmp_path / "run.rrd"
    disk = way_to_disk(file)
    assert isinstance(disk, DirectFile)
    recording = random_recording()
    write_rrd(recording, file)
    assert_equal_recordings(tentacle.read(file), recording)
    disk.finish()
    os.truncate(file, file.stat().st_size - 100)
    monkeypatch.setattr("tentacle.io.direct_file.END_WITHIN", 0.0)
    with pytest.raises(OSError, match="not written to its end"):
        disk.finish()

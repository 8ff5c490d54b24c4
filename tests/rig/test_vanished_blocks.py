"""A run's file from which a whole block has vanished: it is refused, told, or nothing that is read has changed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from benchmarks._rig_optimise import DECLARED
from rig.recorder import Recorder
from rig.run_file import read_run
from rig.run_layout import CAMERA, LOAD
from rig.soundness import check_file
from tentacle.errors import InputError
from tentacle.io.recording_from_rrd import read_rrd
from tentacle.io.rrd_chunks import END, MESSAGE_HEADER, STREAM_HEADER, just_written, read_chunks
from tentacle.waveform import Chirp
from tests.rig.filmed import filmed_run
from tests.rig.test_bit_flips import _content

NOT_DATA = {"/__properties", "/camera/video"}  # a name for the viewer, and when it shows which picture of the video


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("whole") / "run.rrd"
    filmed_run(DECLARED, {}, Chirp(0.4, 0.5, 2.0, 1.0), 0.4, file, {"kind": "chirp"})
    return file


def _messages(data: bytes) -> list[tuple[int, int]]:
    """Where each message before the end begins and ends."""
    found, position = [], STREAM_HEADER
    while True:
        kind, size = MESSAGE_HEADER.unpack_from(data, position)
        if kind == END:
            return found
        found.append((position, position + MESSAGE_HEADER.size + size))
        position = found[-1][1]


def _without_each_block(whole: Path, folder: Path) -> Iterator[tuple[Path, set[str]]]:
    """The file without a footer and without one message, for each; the entities that have fewer blocks then."""
    data = whole.read_bytes()
    messages = _messages(data)
    every = [chunk.entity for chunk in read_chunks(whole)]
    for number, (begin, end) in enumerate(messages):
        file = folder / f"{number}.rrd"
        file.write_bytes(data[:begin] + data[end : messages[-1][1]])
        just_written(file)  # every message in it is sound: no child has to read it
        left = [chunk.entity for chunk in read_chunks(file)]
        yield file, {entity for entity in every if left.count(entity) < every.count(entity)}


def test_a_block_that_vanishes_is_noticed(whole: Path, tmp_path: Path) -> None:
    content, gone = _content(whole), set()
    for file, entities in _without_each_block(whole, tmp_path):
        finding = check_file(file)[0]
        assert not finding.sound or _content(file) == content, (entities, finding)
        assert not finding.sound or read_rrd(file).video is not None, entities
        gone |= set() if finding.sound else entities
    assert {chunk.entity for chunk in read_chunks(whole)} - gone <= NOT_DATA


def test_a_message_of_no_known_kind_does_not_end_the_file(whole: Path, tmp_path: Path) -> None:
    data = whole.read_bytes()
    for number, (begin, _) in enumerate(_messages(data)):
        file = tmp_path / f"{number}.rrd"
        file.write_bytes(data[:begin] + bytes([data[begin] ^ 64]) + data[begin + 1 :])
        for read in (read_run, read_rrd):
            with pytest.raises(InputError, match="damaged"):
                read(file)
        assert not check_file(file)[0].sound


def _ended(path: Path, outcome: str, stop: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> Path:
    """A run of 41 readings and 13 frames whose stop record says what `stop` says of the rows."""
    ends = Recorder.stop

    def end(self: Recorder, _outcome: str, record: dict[str, Any]) -> None:
        ends(self, outcome, {**record, **stop})

    with monkeypatch.context() as patched:
        patched.setattr(Recorder, "stop", end)
        filmed_run(DECLARED, {}, Chirp(0.4, 0.5, 2.0, 1.0), 0.4, path, {"kind": "chirp"})
    return path


def test_runs_of_before_the_rows_were_counted_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    frames = 13  # at 0, 1/30, ..., 12/30 s
    for name, stop in (("counted", {"rows": {}, "frames": frames}), ("uncounted", {"rows": {}})):
        run = read_run(_ended(tmp_path / f"{name}.rrd", "complete", stop, monkeypatch))
        assert (len(run.load_t), len(run.frame_host_t), run.missing) == (41, frames, "")
    with pytest.raises(InputError, match="holds 13 of 14 rows"):
        read_run(_ended(tmp_path / "short.rrd", "complete", {"rows": {}, "frames": frames + 1}, monkeypatch))


def test_of_a_run_on_a_full_disk_what_is_there_is_read_and_what_is_not_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = read_run(_ended(tmp_path / "run.rrd", "disk", {"rows": {LOAD: 50, CAMERA: 13}}, monkeypatch))
    assert (run.outcome, len(run.load_t)) == ("disk", 41)
    assert run.missing == f"the full disk took 41 of 50 rows of {LOAD}"

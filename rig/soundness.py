"""Checks that files are unchanged since they were written: recordings, a rig's runs, stored results, declarations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rig.coverage import LONGEST_SILENCE, gap_seconds
from rig.run import Run
from rig.run_file import iterate_frames, read_run
from tentacle.errors import InputError
from tentacle.io.checksums import CHECKSUM_ENTITY
from tentacle.io.plain_file import require_plain
from tentacle.io.reading import read_recording
from tentacle.io.recording_summary import summarise
from tentacle.io.rrd_columns import read_entities
from tentacle.io.toml_table import read_toml
from tentacle.runner import check_result


@dataclass(frozen=True)
class Finding:
    """A file, whether it is sound, and one line about its content or its error."""

    file: Path
    sound: bool
    words: str


def check_file(path: Path) -> list[Finding]:
    """The findings on a file, or on every file of a folder. InputError if there is none."""
    if (path / "recording.toml").is_file() or not path.is_dir():
        if not path.is_dir():
            require_plain(path, "a recording, a run, or a folder of them")
        return [_finding(path)]
    return [_finding(file) for file in _files(path)]


def _files(folder: Path) -> Iterator[Path]:
    for entry in sorted(folder.iterdir()):
        if entry.is_dir() and not entry.is_symlink():
            if (entry / "recording.toml").is_file():
                yield entry
            else:
                yield from _files(entry)
        elif entry.suffix in (".rrd", ".toml", ".npz") or _is_result(entry):
            yield entry


def _is_result(file: Path) -> bool:
    return file.suffix == ".json" and len(file.stem) == 32  # the runner names a result by a hash


def _finding(file: Path) -> Finding:
    try:
        words = _words(file)
    except InputError as error:
        return Finding(file, False, error.line())
    return Finding(file, True, words)


def _words(file: Path) -> str:
    """The content of a sound file; InputError if it is not sound, or not complete."""
    if file.is_dir():
        return summarise(read_recording(file))["recording"]
    require_plain(file)
    if file.suffix == ".rrd":
        return _rrd(file)
    if file.suffix in (".npz", ".json"):
        check_result(file)
        return "a stored result"
    if file.suffix == ".toml":
        read_toml(file)
        return "TOML"
    raise InputError("no kind of file that can be checked", file=file, expected=".rrd, .toml or a stored result")


def _rrd(file: Path) -> str:
    entities, bytes_gone = read_entities(file, lambda entity: not entity.startswith(("/rig/camera", "/camera")))
    if any(entity.startswith("/rig/") for entity in entities):
        run = require_sound_run(file)
        counts = f"{len(run.load_t)} readings, {len(run.servo_t)} set points, {len(run.frame_host_t)} frames"
        return f"a run, {run.outcome}: {counts}"
    if "/declaration" in entities:
        recording = read_recording(file)
        if "cut_off" in recording.notes:
            raise InputError(recording.notes["cut_off"], file=file, expected="a whole recording")
        return summarise(recording)["recording"]
    if {CHECKSUM_ENTITY, "/rows"} & set(entities):
        raise InputError("damaged: its declaration is gone", file=file, expected="a whole recording")
    if bytes_gone:
        raise InputError(f"its last {bytes_gone} bytes are no whole message", file=file, expected="a whole .rrd")
    return "readable; it holds no checksums"


def require_sound_run(file: Path) -> Run:
    """A run of which every sample, event and picture agrees with its checksum, and none is missing.

    InputError with the first that does not. The recording in the same file is read too.
    """
    run = read_run(file)
    frames = sum(1 for _ in iterate_frames(file))  # each is compared with its checksum
    notes = read_recording(file).notes
    missing = run.missing or notes.get("cut_off", "")
    if not missing and frames != len(run.frame_host_t):
        missing = f"{len(run.frame_host_t)} frames have a time, and {frames} a picture"
    if not missing and notes.get("outcome") != run.outcome:
        missing = f"damaged: its declaration calls it {notes.get('outcome')!r}, its stop record {run.outcome!r}"
    if missing:
        raise InputError(missing, file=file, expected="a run with its stop record")
    return run


def is_complete_run(file: Path) -> bool:
    """Whether a file is there, sound, and a run that ended as planned."""
    try:
        return require_sound_run(file).outcome == "complete"
    except InputError:
        return False


def film_gap(run: Run) -> float:
    """The longest time of a run's motion without a frame [s], to its last set point; all of it where it has no film."""
    seconds = float(run.servo_t[-1]) - run.zero
    camera = (run.stop or {}).get("camera") or {}
    if not run.clocks or not len(run.frame_host_t):
        return seconds
    taken = run.frame_host_t - float(camera.get("offset_s", 0.0))
    board_us = [1e6 * run.clocks[-1].to_board(float(host_s)) for host_s in taken]
    return float(gap_seconds(np.array(board_us), 1e6 * run.zero, seconds).max())


def is_filmed_run(file: Path) -> bool:
    """Whether a file is a complete run with a film of the whole motion."""
    try:
        run = require_sound_run(file)
    except InputError:
        return False
    return run.outcome == "complete" and len(run.servo_t) > 0 and film_gap(run) <= LONGEST_SILENCE

"""Reads a recording from an import folder or an .rrd file."""

from __future__ import annotations

from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.plain_file import require_plain
from tentacle.recording import Recording
from tentacle.slips import refuse_slips


def read_recording(path: str | Path) -> Recording:
    """A recording from an import folder, or from an .rrd file; InputError names what is wrong with it."""
    recording = _read(Path(path))
    refuse_slips(recording)
    return recording


def _read(path: Path) -> Recording:
    if path.is_dir():
        from tentacle.io.import_folder import read_folder

        return read_folder(path)
    if not path.exists():
        raise InputError("no such file or folder", file=path, expected="an import folder or an .rrd file")
    require_plain(path, "an import folder or an .rrd file")
    if path.suffix == ".rrd":
        from tentacle.io.recording_rrd import read_rrd  # Rerun takes a second to import, and folders do not need it

        return read_rrd(path)
    raise InputError("not a recording", file=path, expected="an import folder or an .rrd file")

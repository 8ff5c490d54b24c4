"""A library's folder with what is no recording under a recording's name: named in one line, never opened."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tentacle.errors import InputError
from tentacle.io.library.index import recordings_of


@pytest.mark.parametrize("kind", ["fifo", "dangling", "loop", "folder"])
def test_what_is_no_file_is_named(kind: str, tmp_path: Path) -> None:
    (tmp_path / "a.rrd").write_bytes(b"RRF2")
    assert recordings_of(tmp_path) == [(tmp_path / "a.rrd").resolve()]
    odd = tmp_path / "deeper" / "odd.rrd"
    odd.parent.mkdir()
    if kind == "fifo":
        os.mkfifo(odd)  # whoever opens it to read stands still
    elif kind == "folder":
        odd.mkdir()
    else:
        odd.symlink_to("nowhere" if kind == "dangling" else odd.name)
    with pytest.raises(InputError, match=r"odd\.rrd"):
        recordings_of(tmp_path)

"""Only plain files are read; nothing waits for a pipe, a device or the kernel."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from tentacle.errors import InputError
from tentacle.io.plain_file import is_there, read_plain
from tentacle.io.rrd_chunks import has_header, read_chunks


@pytest.mark.skipif(sys.platform == "win32", reason="pipes and devices as files")
def test_what_is_no_plain_file_is_named(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "dangling").symlink_to(".git/annex/objects/x")
    (tmp_path / "loop").symlink_to("loop")
    said = {"pipe": "is a pipe", "dangling": "git annex get", "loop": "cannot be read", ".": "is a folder"}
    for name, words in said.items():
        with pytest.raises(InputError, match=words):
            read_plain(tmp_path / name)
    with pytest.raises(InputError, match="is a device"):
        read_plain(Path("/dev/zero"))
    assert not is_there(tmp_path / "none")


@pytest.mark.skipif(not Path("/proc/version").exists(), reason="no /proc here")
def test_a_file_of_proc_has_no_size_and_is_read_as_empty() -> None:
    """/proc/kmsg, for one, never comes to an end."""
    file = Path("/proc/version")
    assert read_plain(file) == b""
    assert not has_header(file)
    with pytest.raises(InputError, match=r"not an \.rrd file"):
        list(read_chunks(file))

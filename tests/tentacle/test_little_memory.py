"""A sound recording is not called damaged where the shell allows less memory than the reader's own limit."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

from tentacle.io.recording_rrd import write_rrd
from tentacle.io.rrd_chunks import CHILD_MEMORY
from tests.hostile.material import measured_recording


def test_the_reader_keeps_a_lower_limit_that_it_was_given(tmp_path: Path) -> None:
    write_rrd(measured_recording(), tmp_path / "a.rrd")
    allowed = CHILD_MEMORY * 5 // 8
    child = subprocess.run(
        [sys.executable, "-m", "tentacle.io.rrd_chunks", str(tmp_path / "a.rrd")],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (allowed, allowed)),
        capture_output=True, check=False,
    )  # fmt: skip
    assert (child.returncode, child.stderr) == (0, b"")
    assert b"declaration" in child.stdout

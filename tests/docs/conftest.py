"""The desk on which the documentation's commands are tried."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

from tests.docs.desk import set_desk


@pytest.fixture(scope="session")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        # Tests in a shell's background ignore Ctrl-C, and so would all that they start; no shell can undo that.
        signal.signal(signal.SIGINT, signal.default_int_handler)
    return set_desk(tmp_path_factory.mktemp("reader") / "desk")

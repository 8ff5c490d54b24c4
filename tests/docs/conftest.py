"""The desk on which the documentation's commands are tried."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.docs.desk import set_desk


@pytest.fixture(scope="session")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return set_desk(tmp_path_factory.mktemp("reader") / "desk")

"""What all rooms' tests share: nothing is written outside the test's own folders."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest_plugins = ["tests.made_parameters", "tests.made_recordings"]


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Videos that come out of .rrd files are put here, not into the user's cache; compiled kernels stay in theirs."""
    before = os.environ.get("TENTACLE_CACHE")
    os.environ.setdefault("TENTACLE_KERNELS", before or str(Path.home() / ".cache"))
    os.environ["TENTACLE_CACHE"] = str(tmp_path_factory.mktemp("cache"))
    yield
    if before is None:
        del os.environ["TENTACLE_CACHE"]
    else:
        os.environ["TENTACLE_CACHE"] = before

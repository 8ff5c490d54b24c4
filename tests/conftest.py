"""What all rooms' tests share: nothing is written outside the test's own folders; effects of files are tested too."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tentacle.io.effect_file import effects_of


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--effects", nargs="+", default=[], type=Path, metavar="FILE.toml",
        help="effect files that the tests find in the catalogue (docs/howto/law.md)",
    )  # fmt: skip


def pytest_configure(config: pytest.Config) -> None:
    stack = ExitStack()
    stack.enter_context(effects_of(config.getoption("--effects") or []))
    config.add_cleanup(stack.close)


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

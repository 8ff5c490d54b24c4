"""The page as a visitor meets it: `tentacle app` in its own process, and Debian's Chromium driven without a screen."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from viz.viewer import free_port

ROOT = Path(__file__).parents[3]


@dataclass(frozen=True)
class Served:
    """A page that is up: its address with the token, and the folder that it works in."""

    address: str
    folder: Path


@pytest.fixture(scope="session")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    pytest.importorskip("nicegui", reason="nicegui is not installed: pip install tentacle-twin[app]")
    folder = tmp_path_factory.mktemp("app")
    command = [sys.executable, "-m", "tentacle", "app", str(folder), "--no-browser", "--port", str(free_port())]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    for name in [name for name in environment if name.startswith(("NICEGUI_", "PYTEST_"))]:
        del environment[name]  # NiceGUI takes a test's environment for a test of its own
    process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        yield Served(process.stdout.readline().split()[0], folder)
    finally:
        process.terminate()
        process.communicate(timeout=60)


@pytest.fixture(scope="session")
def browser() -> Iterator:
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install .[dev]")
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("chromium is not installed (Debian: apt-get install chromium)")
    with sync_api.sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        yield found
        found.close()

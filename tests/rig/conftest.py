"""An emulated rig over a real pty, and limits that every test shares."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from rig.board import Board
from rig.emulator import Emulator, EmulatorSettings
from rig.link import Link
from rig.safety import SafetyLimits, ServoCalibration


@pytest.fixture
def limits() -> SafetyLimits:
    return SafetyLimits(min_angle=-0.8, max_angle=0.8, max_speed=8.0, max_current=0.9)


@pytest.fixture
def servo() -> ServoCalibration:
    return ServoCalibration()


@pytest.fixture(scope="session")
def compiler() -> None:
    if shutil.which("g++") is None:
        pytest.skip("no g++ here: the board's core cannot be compiled (Debian: apt-get install g++)")


@pytest.fixture
def emulator(tmp_path: Path, compiler: None) -> Iterator[Emulator]:  # noqa: ARG001 (asked for: it skips)
    with Emulator(tmp_path / "emulator", EmulatorSettings(seed=3)) as running:
        yield running


@pytest.fixture
def board(emulator: Emulator) -> Iterator[Board]:
    connected = Board(Link(emulator.url))
    connected.connect()
    yield connected
    connected.close()

"""A rig that is connected: board greeted and armed, camera running; both let go at the end, the arm at neutral."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rig.board import Board
from rig.camera import CameraThread, FileSource, FrameSource, WebcamSource
from rig.emulated_camera import EmulatedOptics, EmulatedSource
from rig.host_time import HostTime
from rig.link import Link
from rig.play import arm_board, require_unlatched
from rig.setup_file import EMULATED, RigSetup


@contextmanager
def connected(setup: RigSetup) -> Iterator[Board]:
    """A board that was greeted and armed with the setup's limits; at neutral and closed afterwards."""
    board = Board(Link(setup.port), HostTime(setup.rate))
    try:
        board.connect()
        arm_board(board, setup.limits, setup.servo)
        yield board
    finally:
        board.close()


def connect_again(setup: RigSetup, board: Board) -> None:
    """Greets and arms anew a board whose link was lost between runs, or that was not listened to for long."""
    if not board.link.is_open or board.neglected:
        board.connect()
        arm_board(board, setup.limits, setup.servo)
    require_unlatched(board)


@contextmanager
def opened_camera(setup: RigSetup, host_time: HostTime) -> Iterator[CameraThread | None]:
    """The setup's camera, running; None where it has none."""
    if setup.camera is None:
        yield None
        return
    camera = CameraThread(lambda: _source(setup, host_time), host_time)
    try:
        yield camera
    finally:
        camera.close()


def _source(setup: RigSetup, host_time: HostTime) -> FrameSource:
    assert setup.camera is not None
    source = setup.camera.source
    if source.isdigit():
        return WebcamSource(int(source), host_time)
    if source == EMULATED:
        optics = EmulatedOptics.of(setup.recording.declaration)
        return EmulatedSource(Path(setup.port).parent / "truth", optics, host_time)
    return FileSource(Path(source), host_time)

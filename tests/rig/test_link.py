"""One class for every port: pty, loop://, socket:// and rfc2217:// carry the same frames."""

from __future__ import annotations

import os
import socket
import threading
import time
import tty

import pytest
import serial
from serial import rfc2217

from benchmarks._rig_scene import LIMITS, gaps, played, wrong_samples
from rig.board import Board
from rig.emulator import Emulator
from rig.fault import Fault
from rig.link import Link
from rig.play import arm_board
from rig.protocol import Type, WireFrame
from rig.safety import ServoCalibration
from tentacle.errors import InputError

FRAMES = [
    WireFrame(Type.PING, 0, bytes([7, 0, 0, 0])),
    WireFrame(Type.POINTS, 9, bytes(range(112))),
    WireFrame(Type.CLEAR, 3),
]


class Echo(threading.Thread):
    """Sends back what it reads, from a pty's far end or a socket."""

    def __init__(self, read, write) -> None:
        super().__init__(daemon=True)
        self._read, self._write = read, write
        self.start()

    def run(self) -> None:
        try:
            while data := self._read(4096):
                self._write(data)
        except OSError:
            pass


@pytest.fixture(params=["pty", "loop", "socket"])
def url(request: pytest.FixtureRequest):
    if request.param == "loop":
        yield "loop://"
    elif request.param == "pty":
        far, near = os.openpty()
        tty.setraw(near)
        Echo(lambda n: os.read(far, n), lambda d: os.write(far, d))
        yield os.ttyname(near)
        os.close(near)
        os.close(far)
    else:
        with socket.create_server(("127.0.0.1", 0)) as server:

            def accept() -> None:
                peer, _ = server.accept()
                with peer:
                    Echo(peer.recv, peer.sendall).join(5)

            thread = threading.Thread(target=accept, daemon=True)
            thread.start()
            yield f"socket://127.0.0.1:{server.getsockname()[1]}"


def collect(link: Link, count: int) -> list[WireFrame]:
    got: list[WireFrame] = []
    until = time.monotonic() + 3.0
    while len(got) < count and time.monotonic() < until:
        got += link.receive(0.02)
    return got


def test_frames_go_there_and_back(url: str) -> None:
    link = Link(url)
    link.open()
    for frame in FRAMES:
        link.send(frame)
    assert collect(link, len(FRAMES)) == FRAMES
    assert link.bad_frames == 0
    link.close()
    assert not link.is_open


class PtyPort(serial.Serial):
    """A pty as a port that a server offers: it has no modem lines to set or to read."""

    cts = dsr = ri = cd = False  # type: ignore[assignment]

    def _update_dtr_state(self) -> None:
        pass

    def _update_rts_state(self) -> None:
        pass


class Rfc2217Server(threading.Thread):
    """Offers a port on 127.0.0.1 as RFC 2217 says, to one client: pyserial's PortManager between a socket and it."""

    def __init__(self, port: str) -> None:
        super().__init__(daemon=True)
        self._port = PtyPort(port, 115200, timeout=0.002)
        self._server = socket.create_server(("127.0.0.1", 0))
        self.url = f"rfc2217://127.0.0.1:{self._server.getsockname()[1]}"
        self._client: socket.socket | None = None
        self.start()

    def write(self, data: bytes) -> None:
        """What the manager itself has to say."""
        assert self._client is not None
        self._client.sendall(data)

    def run(self) -> None:
        self._client, _ = self._server.accept()
        self._client.settimeout(0.002)
        manager = rfc2217.PortManager(self._port, self)  # type: ignore[arg-type]
        try:
            while True:
                if data := self._port.read(max(1, self._port.in_waiting)):
                    self._client.sendall(b"".join(manager.escape(data)))
                try:
                    data = self._client.recv(4096)
                except TimeoutError:
                    continue
                if not data:
                    return
                self._port.write(b"".join(manager.filter(data)))
        except OSError:
            pass
        finally:
            self._client.close()
            self._server.close()
            self._port.close()


@pytest.mark.filterwarnings("ignore:set(Daemon|Name):DeprecationWarning")  # of pyserial 3.5
def test_a_board_behind_an_rfc2217_server_plays_a_run(emulator: Emulator) -> None:
    board = Board(Link(Rfc2217Server(emulator.url).url))
    board.connect()
    arm_board(board, LIMITS, ServoCalibration())
    samples, start, end = played(board, 1.0)
    board.close()
    assert end.outcome == "complete"
    assert gaps(samples) == 0
    assert wrong_samples(samples, start, 1.0) == 0


@pytest.mark.filterwarnings("ignore:set(Daemon|Name):DeprecationWarning")
def test_an_rfc2217_server_that_is_not_there_is_one_clear_fault() -> None:
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        with pytest.raises(Fault, match="cannot be opened"):
            Link(f"rfc2217://127.0.0.1:{closed.getsockname()[1]}").open()


@pytest.mark.parametrize("place", ["", "127.0.0.1", "127.0.0.1:99999", "127.0.0.1:x", ":5000"])
def test_a_network_port_without_host_and_number_is_refused(place: str) -> None:
    with pytest.raises(InputError, match="names no host and port"):
        Link(f"socket://{place}").open()


@pytest.mark.parametrize("name", ["/dev/no_such_port", "/dev/tty\0"])
def test_a_missing_port_is_one_clear_fault(name: str) -> None:
    with pytest.raises(Fault, match="cannot be opened") as caught:
        Link(name).open()
    assert caught.value.kind == "link_lost"
    assert "\n" not in str(caught.value)


def test_a_port_that_goes_is_a_lost_link() -> None:
    far, near = os.openpty()
    link = Link(os.ttyname(near))
    link.open()
    os.close(near)
    os.close(far)
    with pytest.raises(Fault, match="has gone"):
        collect(link, 1)
    assert not link.is_open

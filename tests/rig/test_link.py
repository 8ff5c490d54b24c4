"""One class for every port: pty, loop://, socket:// and rfc2217:// carry the same frames."""

from __future__ import annotations

import os
import socket
import threading
import time
import tty

import pytest
from serial import rfc2217

from rig.fault import Fault
from rig.link import Link
from rig.protocol import Frame, Type

FRAMES = [Frame(Type.PING, 0, bytes([7, 0, 0, 0])), Frame(Type.POINTS, 9, bytes(range(112))), Frame(Type.CLEAR, 3)]


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


def collect(link: Link, count: int) -> list[Frame]:
    got: list[Frame] = []
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


def test_rfc2217_is_taken_as_a_port() -> None:
    # pyserial's own class: the server side needs a real port, so here only that the url reaches it and fails in one
    # line.
    assert rfc2217.Serial is not None
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        with pytest.raises(Fault, match="cannot be opened"):
            Link(f"rfc2217://127.0.0.1:{closed.getsockname()[1]}").open()


def test_a_missing_port_is_one_clear_fault() -> None:
    with pytest.raises(Fault, match="cannot be opened") as caught:
        Link("/dev/no_such_port").open()
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

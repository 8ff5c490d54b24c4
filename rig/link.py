"""One class for all connections to a board: a serial port, a pty, loop://, socket://HOST:PORT, rfc2217://HOST:PORT."""

from __future__ import annotations

import contextlib
import os
import time
from dataclasses import dataclass
from urllib.parse import urlsplit

import serial
from serial.tools import list_ports

from rig.fault import Fault
from rig.protocol import Parser, WireFrame, encode
from tentacle.errors import InputError

BAUD = 115200
SCHEMES = ("socket", "rfc2217", "loop")
READ_PATIENCE = 0.002  # s, time-out of a read; set once: over rfc2217:// every change is negotiated with the server


@dataclass(frozen=True)
class PortFound:
    """A serial port of this computer: device, what it says it is, and whether it looks like an Arduino Due."""

    device: str
    description: str
    due: bool


def serial_ports() -> list[PortFound]:
    """The serial ports present. The Due's programming port (2341:003d) is the one to use, not its native port."""
    found = []
    for port in list_ports.comports():
        due = port.vid == 0x2341 and port.pid == 0x003D
        found.append(PortFound(port.device, port.description or "", due))
    return found


def require_scheme(url: str) -> None:
    """InputError if a port's scheme is not one of SCHEMES: pyserial has others, one of which writes a file."""
    scheme, separator, _ = url.partition("://")
    if separator and scheme.lower() not in SCHEMES:
        known = ", ".join(f"{one}://" for one in SCHEMES)
        raise InputError(f"{scheme}:// is not opened", field="port", expected=f"a device, or {known}")
    if separator and ("?" in url or "&" in url):
        raise InputError(f"{url} has options", field="port", expected="a port without a question mark")
    if separator and scheme.lower() != "loop" and not _has_place(url):
        raise InputError(f"{url} names no host and port", field="port", expected=f"{scheme}://HOST:PORT")


def _has_place(url: str) -> bool:
    try:
        found = urlsplit(url)
        return bool(found.hostname and found.port)
    except ValueError:  # a port beyond 65535, or no number
        return False


class Link:
    """Frames over a port. Opened exclusively; reading and writing raise Fault("link_lost") when the port is gone."""

    def __init__(self, url: str) -> None:
        self.url = url
        self._parser = Parser()
        self._bad_before = 0
        self._port: serial.Serial | None = None

    def open(self) -> None:
        """Opens the port; Fault("link_lost") where it cannot be opened."""
        self.close()
        require_scheme(self.url)
        try:
            # A link's pty may change under its name.
            target = self.url if "://" in self.url else os.path.realpath(self.url)
            port = serial.serial_for_url(target, baudrate=BAUD, timeout=READ_PATIENCE)
            if "://" not in self.url:
                port.exclusive = True
                port.write_timeout = 0.5  # rfc2217:// knows none
        except (OSError, ValueError) as error:  # SerialException is an OSError
            raise Fault("link_lost", f"{self.url} cannot be opened: {_reason(error)}") from None
        with contextlib.suppress(
            OSError
        ):  # a pty has no modem lines and says ENOTTY; it may have no input queue either
            port.reset_input_buffer()
        self._bad_before, self._parser = self.bad_frames, Parser()
        self._port = port

    @property
    def bad_frames(self) -> int:
        """Number of damaged frames, over all openings."""
        return self._bad_before + self._parser.bad

    @property
    def is_open(self) -> bool:
        """Whether the port was opened and has not failed since."""
        return self._port is not None

    def close(self) -> None:
        """Closes the port; a port that has gone makes no fuss."""
        if self._port is not None:
            with contextlib.suppress(OSError):
                self._port.close()
            self._port = None

    def send(self, frame: WireFrame) -> None:
        """Writes one frame."""
        data = encode(frame)
        port = self._require()
        try:
            port.write(data)
        except OSError as error:
            self._lost(error)

    def receive(self, wait: float) -> list[WireFrame]:
        """The received frames, after at most `wait` real seconds."""
        port = self._require()
        data = b""
        until = time.monotonic() + wait
        try:
            while not data:
                data = port.read(max(1, port.in_waiting))
                if time.monotonic() >= until:
                    break
            if data and port.in_waiting:
                data += port.read(port.in_waiting)
        except (OSError, TypeError) as error:  # pyserial reads a closed descriptor as TypeError
            self._lost(error)
        return self._parser.feed(data) if data else []

    def _require(self) -> serial.Serial:
        if self._port is None:
            raise Fault("link_lost", f"{self.url} is not open")
        return self._port

    def _lost(self, error: Exception) -> None:
        self.close()
        raise Fault("link_lost", f"{self.url} has gone: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    return getattr(error, "strerror", None) or str(error)

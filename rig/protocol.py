"""The wire between computer and board, version 1: messages, CRC-32, COBS frames (docs/protocol.md).

A frame is COBS(type, sequence, body, CRC-32 of these) and a zero. Only exact, known messages are accepted.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from enum import IntEnum

VERSION = 1
MAX_BODY = 112
MAX_POINTS = 26  # set points in one POINTS message
MAX_ENCODED = MAX_BODY + 7  # COBS bytes between two zeros
NO_ANGLE = -(2**31)  # a servo without position feedback


class Type(IntEnum):
    """Message types; from 0x81 on they go from the board to the host."""

    HELLO = 0x01
    PING = 0x02
    LIMITS = 0x03
    STREAM = 0x04
    POINTS = 0x05
    START = 0x06
    NEUTRAL = 0x07
    FLASH = 0x08
    RESEND = 0x09
    CLEAR = 0x0A
    BOOT = 0x81
    ACK = 0x82
    NAK = 0x83
    PONG = 0x84
    LOAD = 0x85
    SERVO = 0x86
    EVENT = 0x87
    GONE = 0x88


class Reason(IntEnum):
    """Reasons of the board for refusing a command."""

    UNKNOWN_TYPE = 1
    BAD_LENGTH = 2
    BAD_VERSION = 3
    NO_LIMITS = 4
    BAD_LIMITS = 5
    OUTSIDE_LIMITS = 6
    QUEUE_FULL = 7
    TOO_FEW_POINTS = 8
    BAD_START = 9
    BUSY = 10
    LATCHED = 11
    NOT_CLEARED = 12


class BoardState(IntEnum):
    """State of the board; it is RETURNING to neutral after every run, for every kind of end.

    LATCHED: the servo is off after a fault, until CLEAR and LIMITS. UNKNOWN: a newer board's state.
    """

    UNARMED = 0
    READY = 1
    WAITING = 2
    PLAYING = 3
    RETURNING = 4
    LATCHED = 5
    UNKNOWN = 255


class EventCode(IntEnum):
    """Events of the board; WATCHDOG has the silence in ms, CELL_ERROR the error's number."""

    STARTED = 1
    COMPLETE = 2
    UNDERRUN = 3
    WATCHDOG = 4
    CLIPPED = 5
    OVERCURRENT = 6
    FLASH_ON = 7
    FLASH_OFF = 8
    CELL_ERROR = 9
    CELL_GOOD = 10
    STOPPED = 11


def event_name(code: int) -> str:
    """An event's name; a newer board may know events that this program does not."""
    return EventCode(code).name if code in set(EventCode) else f"EVENT_{code}"


def reason_words(code: int) -> str:
    """Why the board refused, in words; a newer board may know reasons that this program does not."""
    if code not in set(Reason):
        return f"for a reason that this program does not know (number {code}: is the firmware newer?)"
    return Reason(code).name.lower().replace("_", " ")


@dataclass(frozen=True)
class WireFrame:
    """One checked frame, not yet taken apart."""

    type: int
    sequence: int
    body: bytes = b""


@dataclass(frozen=True)
class Boot:
    """The board has started, or was greeted: its limits of build (pulses [us], angle [urad], speed [urad/s]), clock
    [us].
    """

    version: int
    boot_id: int
    board_us: int
    pulse_min_us: int
    pulse_max_us: int
    angle_urad: int
    speed_urad_s: int
    watchdog_us: int
    next_sample: int


@dataclass(frozen=True)
class Pong:
    """Answer to a ping: the board's clock at its arrival, state, room for set points, points played, next sample."""

    token: int
    board_us: int
    boot_id: int
    state: int
    room: int
    played: int
    next_sample: int
    bad_frames: int


@dataclass(frozen=True)
class CommandAnswer:
    """ACK (reason 0) or NAK of the command with this sequence and type."""

    sequence: int
    type: int
    reason: int = 0


@dataclass(frozen=True)
class LoadSample:
    """One load-cell conversion: its number in the board's one sequence of samples, board time [us], raw counts."""

    number: int
    board_us: int
    counts: int


@dataclass(frozen=True)
class ServoSample:
    """One servo frame: angle at the pin and measured angle [urad] (NO_ANGLE without feedback), pulse [us], current
    [mA].
    """

    number: int
    board_us: int
    command_urad: int
    angle_urad: int
    pulse_us: int
    current_ma: int


@dataclass(frozen=True)
class BoardEvent:
    """Something happened on the board at board_us [us]; value's meaning goes with the code."""

    number: int
    board_us: int
    code: int
    value: int


@dataclass(frozen=True)
class Gone:
    """Of the samples asked for again, `count` from `first` on are no longer held."""

    first: int
    count: int


Sample = LoadSample | ServoSample | BoardEvent
Message = Boot | Pong | CommandAnswer | LoadSample | ServoSample | BoardEvent | Gone

_LAYOUTS = {
    Type.BOOT: ("<BIQHHiIII", Boot),
    Type.PONG: ("<IQIBHIII", Pong),
    Type.LOAD: ("<IQi", LoadSample),
    Type.SERVO: ("<IQiiHH", ServoSample),
    Type.EVENT: ("<IQBi", BoardEvent),
    Type.GONE: ("<IB", Gone),
}


def encode(frame: WireFrame) -> bytes:
    """The frame's bytes, delimiter included. ValueError where the body is longer than MAX_BODY."""
    if len(frame.body) > MAX_BODY:
        raise ValueError(f"a body of {len(frame.body)} bytes; at most {MAX_BODY} go into a frame")
    payload = bytes((frame.type, frame.sequence)) + frame.body
    payload += struct.pack("<I", zlib.crc32(payload))
    return b"".join(bytes((len(run) + 1,)) + run for run in payload.split(b"\0")) + b"\0"


def decode_frame(encoded: bytes) -> WireFrame | None:
    """The frame in the COBS bytes between two zeros; None where stuffing, length or CRC is wrong."""
    payload = bytearray()
    at, size = 0, len(encoded)
    if size > MAX_ENCODED:
        return None
    while at < size:
        code = encoded[at]
        if code == 0 or at + code > size:
            return None
        payload += encoded[at + 1 : at + code]
        at += code
        if at < size:
            payload.append(0)
    if len(payload) < 6 or struct.unpack("<I", payload[-4:])[0] != zlib.crc32(payload[:-4]):
        return None
    return WireFrame(payload[0], payload[1], bytes(payload[2:-4]))


class Parser:
    """Turns bytes into checked frames. `bad` counts the byte sequences between zeros that were no frame."""

    def __init__(self) -> None:
        self._rest = b""
        self._skipping = False
        self.bad = 0

    def feed(self, data: bytes) -> list[WireFrame]:
        """The frames that these bytes complete, in order."""
        *whole, rest = (self._rest + data).split(b"\0")
        frames = []
        for encoded in whole:
            if not encoded and not self._skipping:
                continue  # idle line
            frame = None if self._skipping else decode_frame(encoded)
            self._skipping = False
            if frame is None:
                self.bad += 1
            else:
                frames.append(frame)
        if len(rest) > MAX_ENCODED:
            rest, self._skipping = b"", True
        self._rest = rest
        return frames


def decode(frame: WireFrame) -> Message | None:
    """What the board said; None where type or length is not of version 1, or a sample contradicts its own sequence."""
    if frame.type == Type.ACK and len(frame.body) == 1:
        return CommandAnswer(frame.sequence, frame.body[0])
    if frame.type == Type.NAK and len(frame.body) == 2:
        return CommandAnswer(frame.sequence, frame.body[0], frame.body[1])
    layout = _LAYOUTS.get(frame.type)  # type: ignore[call-overload]
    if layout is None or struct.calcsize(layout[0]) != len(frame.body):
        return None
    message = layout[1](*struct.unpack(layout[0], frame.body))
    if isinstance(message, LoadSample | ServoSample | BoardEvent) and message.number & 0xFF != frame.sequence:
        return None
    return message

"""Bodies of the commands that the host sends to the board (rig.protocol has the frames around them)."""

from __future__ import annotations

import struct
from collections.abc import Sequence

from rig.protocol import VERSION


def hello() -> bytes:
    """Body of HELLO: the host's version."""
    return struct.pack("<B", VERSION)


def ping(token: int) -> bytes:
    """Body of PING."""
    return struct.pack("<I", token)


def limits(min_urad: int, max_urad: int, speed_urad_s: int, current_ma: int, centre_us: int, us_per_rad: int) -> bytes:
    """Body of LIMITS: angles [urad], speed [urad/s], current [mA]; the pulse at angle 0 [us] and its slope [us/rad]."""
    return struct.pack("<iiIHHh", min_urad, max_urad, speed_urad_s, current_ma, centre_us, us_per_rad)


def stream(on: bool) -> bytes:
    """Body of STREAM: samples on or off."""
    return struct.pack("<B", on)


def points(index: int, urad: Sequence[int]) -> bytes:
    """Body of POINTS: set points [urad] from `index` on."""
    return struct.pack(f"<IB{len(urad)}i", index, len(urad), *urad)


def start(at_us: int, period_us: int, total: int) -> bytes:
    """Body of START: `total` set points, one every period_us from board time at_us on."""
    return struct.pack("<QII", at_us, period_us, total)


def flash(milliseconds: int) -> bytes:
    """Body of FLASH: light the LED for so long."""
    return struct.pack("<H", milliseconds)


def resend(first: int, count: int) -> bytes:
    """Body of RESEND: samples to be sent again."""
    return struct.pack("<IB", first, count)

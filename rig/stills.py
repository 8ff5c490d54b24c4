"""Makes one video of JPEG pictures from a camera; each picture keeps its own time and its own bytes.

A picture becomes a packet of the film (Motion JPEG) as it is. H.264 took 20 times the processor's time and up to a
quarter fewer bytes, but the shape tracked in it erred 1.2 to 2.8 times as much (crf 10, 720p, four of vision.looks).
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from fractions import Fraction
from itertools import chain
from pathlib import Path

TICK = Fraction(1, 90_000)  # s, of time stamps
START, END = b"\xff\xd8", b"\xff\xd9"  # of a JPEG picture
FRAME_HEADERS = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}  # markers of the segment that states the size
SCAN = 0xDA  # marker of the coded picture, which follows the size
SEGMENT = struct.Struct(">BBH")  # 255, marker, length of the segment with the length's own two bytes
SIZE = struct.Struct(">HH")  # rows, columns; they follow the length and the precision


def write_film(stills: Iterable[tuple[float, bytes]], path: Path) -> int:
    """Times >= 0 [s] and JPEG pictures as a Motion JPEG film, one at a time; how many.

    Left out: a picture whose time does not rise, that was cut off, or whose size is not the first one's.
    """
    import av  # 0.1 s to import, and only runs with a camera need it

    sized = ((t, data, size) for t, data in stills if (size := picture_size(data)) is not None)
    head = next(sized, None)
    if head is None:
        return 0
    width, height = head[2]
    count, last = 0, -1
    # The film's beginning is counted in the movie's ticks: in milliseconds, where nobody asks for finer ones.
    ticks = {name: str(TICK.denominator) for name in ("video_track_timescale", "movie_timescale")}
    with av.open(str(path), mode="w", options=ticks) as container:
        stream = container.add_mux_stream("mjpeg", width=width, height=height)
        stream.time_base = TICK
        for t, data, size in chain([head], sized):
            stamp = round(t / TICK)
            if stamp <= last or size != (width, height):
                continue
            packet = av.Packet(data)
            packet.stream, packet.time_base = stream, TICK
            packet.duration = stamp - max(last, 0) or 1  # a last picture that lasts no time is not shown
            packet.pts = packet.dts = last = stamp
            packet.is_keyframe = True
            container.mux(packet)
            count += 1
    return count


def picture_size(data: bytes) -> tuple[int, int] | None:
    """Width and height [px] of a whole JPEG picture, as its header states; None where it is none or is cut off."""
    if not (data.startswith(START) and data.endswith(END)):
        return None
    at = len(START)
    while at + SEGMENT.size + 1 + SIZE.size <= len(data):
        lead, marker, length = SEGMENT.unpack_from(data, at)
        if lead != 0xFF or marker == SCAN:
            return None
        if marker in FRAME_HEADERS:
            height, width = SIZE.unpack_from(data, at + SEGMENT.size + 1)
            return (width, height) if width and height else None
        at += 2 + length
    return None

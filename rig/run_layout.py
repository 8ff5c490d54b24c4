"""Where a run's .rrd keeps what, and the rows of each entity; rig.recorder writes them, rig.run_file reads them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rig.camera import CameraFrame
from rig.clock import ClockFit
from rig.live_feed import BOARD_TIME
from rig.protocol import BoardEvent, Sample, event_name
from tentacle.io.checksums import columns_digest, frame_digest

RUN_FORMAT = "tentacle-rig-run"
VERSION = 1
START, STOP = "/rig/start", "/rig/stop"
LOAD, THRUST = "/rig/load_cell/counts", "/rig/load_cell/thrust"
COMMAND, ANGLE, CURRENT = "/rig/servo/command", "/rig/servo/angle", "/rig/servo/current"
EVENTS, CLOCK, CAMERA = "/rig/events", "/rig/clock", "/rig/camera"
HOST_TIME, SAMPLE = "host_time", "sample"

Index = list[rr.TimeColumn]
Columns = list[rr.ComponentColumn]


def sample_index(samples: Sequence[Sample]) -> tuple[NDArray[np.int64], NDArray[np.int64], Index]:
    """Board times (N,) [ns] and numbers (N,) of samples, and both as time lines."""
    board = np.array([s.board_us for s in samples], dtype=np.int64) * 1000
    number = np.array([s.number for s in samples])
    indexes = [
        rr.TimeColumn(BOARD_TIME, duration=board.astype("timedelta64[ns]")),
        rr.TimeColumn(SAMPLE, sequence=number),
    ]
    return board, number, indexes


def event_rows(event: BoardEvent) -> tuple[str, Index, Columns]:
    """An event in words, and its row with a checksum."""
    words = f"{event_name(event.code)} {event.value}"
    index = [
        rr.TimeColumn(BOARD_TIME, duration=[np.timedelta64(1000 * event.board_us, "ns")]),
        rr.TimeColumn(SAMPLE, sequence=[event.number]),
    ]
    digest = columns_digest({"event": [words], "board_us": np.array([event.board_us])})
    return words, index, [*rr.TextLog.columns(text=[words], level=["INFO"]), *rr.AnyValues.columns(sha256=[digest])]


def clock_rows(fit: ClockFit) -> tuple[Index, Columns]:
    """A fit of the clocks as a row with its checksum."""
    values = np.array([[fit.host_zero, fit.board_zero, fit.skew, fit.sigma, fit.round_trip]])
    index = [rr.TimeColumn(BOARD_TIME, duration=[np.timedelta64(round(1e9 * fit.board_zero), "ns")])]
    digest = columns_digest({"fit": values})
    return index, [*rr.Scalars.columns(scalars=values), *rr.AnyValues.columns(sha256=[digest])]


def frame_rows(frames: Sequence[CameraFrame]) -> tuple[Index, Columns]:
    """Frames as rows, each with a checksum of its picture and time.

    Together they are one chunk: Rerun keeps some kB of each chunk until a file is closed, and again when it is read.
    """
    host_ns = [round(1e9 * frame.host_s) for frame in frames]
    sums = [frame_digest(at, frame.jpeg) for at, frame in zip(host_ns, frames, strict=True)]
    pictures = rr.EncodedImage.columns(blob=[frame.jpeg for frame in frames], media_type=["image/jpeg"] * len(frames))
    index = rr.TimeColumn(HOST_TIME, duration=np.array(host_ns, dtype="timedelta64[ns]"))
    return [index], [*pictures, *rr.AnyValues.columns(sha256=sums)]

"""The live view of a run: the signals at once, and small pictures of the camera at a low rate. It has a separate
stream, so that a slow or closed viewer does not disturb the recording.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import cv2
import numpy as np
import rerun as rr

from rig.camera import CameraFrame
from rig.clock import ClockFit

RIG_APPLICATION = "tentacle-twin rig"
BOARD_TIME = "board_time"
PREVIEW = "/rig/preview"
PREVIEW_EVERY = 0.25  # s
PREVIEW_WIDTH = 320  # px, at most
PREVIEW_QUALITY = 70
CLOSE_WITHIN = 1.0  # s; after that, data that the viewer has not taken are dropped


class LiveFeed:
    """Feeds the viewer at an address (rerun+http://...). `clock` must have been called before pictures are shown."""

    def __init__(self, viewer: str) -> None:
        self._stream = rr.RecordingStream(RIG_APPLICATION)
        self._stream.connect_grpc(viewer)
        self._stream.set_log_time_enabled(False)
        self._stream.set_log_tick_enabled(False)
        self._fit: ClockFit | None = None
        self._shown_at = -np.inf

    def columns(self, entity: str, indexes: Sequence[Any], columns: Any) -> None:
        """Rows of a signal, as RecordingStream.send_columns takes them."""
        self._stream.send_columns(entity, indexes=indexes, columns=columns)

    def event(self, entity: str, board_us: int, words: str) -> None:
        """Something that happened on the board."""
        self._stream.set_time(BOARD_TIME, duration=np.timedelta64(1000 * board_us, "ns"))
        self._stream.log(entity, rr.TextLog(words, level="INFO"))

    def clock(self, fit: ClockFit) -> None:
        """The clock fit for placing frames on the board's time from now on."""
        self._fit = fit

    def frames(self, frames: Sequence[CameraFrame]) -> None:
        """Shows one of them from time to time, at the time of its arrival."""
        if self._fit is None or not frames or frames[-1].host_s < self._shown_at + PREVIEW_EVERY:
            return
        self._shown_at = frames[-1].host_s
        board_s = self._fit.to_board(self._shown_at)
        self._stream.set_time(BOARD_TIME, duration=np.timedelta64(round(1e9 * board_s), "ns"))
        self._stream.log(PREVIEW, rr.EncodedImage(contents=preview(frames[-1].jpeg), media_type="image/jpeg"))

    def close(self) -> None:
        """Disconnects from the viewer, which keeps its data."""
        with suppress(Exception):  # of undocumented kinds: a viewer that was closed is no fault
            self._stream.flush(timeout_sec=CLOSE_WITHIN)
        # Rerun tries for seconds to reach a viewer that is gone; nobody waits for that.
        threading.Thread(target=self._stream.disconnect, name="viewer", daemon=True).start()


def preview(jpeg: bytes) -> bytes:
    """A picture at most PREVIEW_WIDTH wide. Decoding it reduced costs a 4K frame a tenth of the time."""
    data = np.frombuffer(jpeg, np.uint8)
    image = np.asarray(cv2.imdecode(data, cv2.IMREAD_REDUCED_COLOR_8), dtype=np.uint8)
    if image.shape[1] < PREVIEW_WIDTH:
        image = np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), dtype=np.uint8)
    share = min(PREVIEW_WIDTH / image.shape[1], 1.0)
    small = cv2.resize(image, None, fx=share, fy=share, interpolation=cv2.INTER_AREA)
    _, encoded = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, PREVIEW_QUALITY])
    return encoded.tobytes()

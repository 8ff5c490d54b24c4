"""The camera: frames with the host time of their arrival, from a webcam, from a video file, or from the
emulated tank.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from rig.fault import Fault
from rig.host_time import HostTime
from tentacle.errors import InputError
from tentacle.signals import Array

Image = NDArray[np.uint8]
JPEG_QUALITY = 92
THUMBNAIL = (16, 12)  # pixels, for finding the flash
MOST_FRAMES = 600  # waiting frames, at most; between runs nobody takes them
STALLED_AFTER = 0.5  # s without a frame


@dataclass(frozen=True)
class CameraFrame:
    """host_s [s] of arrival, the picture as JPEG, and a thumbnail (12, 16) of grey levels."""

    host_s: float
    jpeg: bytes
    thumbnail: Array


class FrameSource(Protocol):
    """A source of pictures. `read` blocks until the next one: (image, host_s of arrival), None at the end."""

    def read(self) -> tuple[Image, float] | None:
        """The next picture."""
        ...

    def close(self) -> None:
        """Lets the source go."""
        ...


class WebcamSource:
    """A camera that OpenCV opens by its index."""

    def __init__(self, index: int, host_time: HostTime) -> None:
        self._time = host_time
        self._capture = cv2.VideoCapture(index)
        if not self._capture.isOpened():
            raise Fault("camera", f"camera {index} cannot be opened")
        self._capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)

    def read(self) -> tuple[Image, float] | None:
        """The next picture, stamped when it arrives."""
        grabbed = self._capture.grab()
        now = self._time.now()
        if not grabbed:
            return None
        found, image = self._capture.retrieve()
        return (np.asarray(image, dtype=np.uint8), now) if found else None

    def close(self) -> None:
        """Lets the camera go."""
        self._capture.release()


class FileSource:
    """A video file played at its own pace, instead of a camera."""

    def __init__(self, path: Path, host_time: HostTime) -> None:
        self._time = host_time
        self._capture = cv2.VideoCapture(str(path))
        if not path.exists() or not self._capture.isOpened():
            raise InputError("cannot be read as a video", file=path, field="camera.source")
        self._fps = self._capture.get(cv2.CAP_PROP_FPS) or 30.0
        self._start, self._count = host_time.now(), 0

    def read(self) -> tuple[Image, float] | None:
        """The next picture, when its time has come; None at the file's end."""
        found, image = self._capture.read()
        if not found:
            return None
        due = self._start + self._count / self._fps
        self._count += 1
        self._time.wait(due - self._time.now())
        return np.asarray(image, dtype=np.uint8), due

    def close(self) -> None:
        """Closes the file."""
        self._capture.release()


class CameraThread:
    """Reads a source in a thread of its own, so that a slow camera never keeps the board waiting."""

    def __init__(self, open_source: Callable[[], FrameSource], host_time: HostTime) -> None:
        self._time = host_time
        self._source = open_source()
        self._frames: deque[CameraFrame] = deque(maxlen=MOST_FRAMES)
        self._running = True
        self._ended = False
        self._last = time.monotonic()
        self._thread = threading.Thread(target=self._run, name="camera", daemon=True)
        self._thread.start()

    def take(self) -> list[CameraFrame]:
        """The frames that have come since the last call."""
        frames = []
        while self._frames:
            frames.append(self._frames.popleft())
        return frames

    @property
    def stalled(self) -> bool:
        """Whether no frame has come for STALLED_AFTER real seconds."""
        return self._ended or time.monotonic() - self._last > STALLED_AFTER

    @property
    def silence(self) -> float:
        """Host-time seconds since the last frame came."""
        return (time.monotonic() - self._last) * self._time.rate

    def close(self) -> None:
        """Stops the thread and lets the source go."""
        self._running = False
        self._thread.join(2.0)

    def _run(self) -> None:
        try:
            while self._running:
                read = self._source.read()
                if read is None:
                    self._ended = True
                    return
                self._frames.append(compressed(*read))
                self._last = time.monotonic()
        finally:
            self._source.close()


def compressed(image: Image, host_s: float) -> CameraFrame:
    """A picture as it is kept."""
    grey = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    thumbnail = cv2.resize(grey, THUMBNAIL, interpolation=cv2.INTER_AREA).astype(float)
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return CameraFrame(host_s, data.tobytes(), thumbnail)

"""A camera during a run: the flashes that place its frames in time, and the gaps in which it gave none."""

from __future__ import annotations

from typing import Any

import numpy as np

from rig.camera import CameraFrame, CameraThread
from rig.camera_offset import CameraOffset, combined, estimate_offset, lit_frames
from rig.clock import ClockFit
from rig.fault import Fault
from rig.frame_times import steadied
from rig.host_time import HostTime
from rig.protocol import BoardEvent, EventCode
from rig.setup_file import CameraSettings

FLASH_MS = 120
FLASH_EVERY = (0.3, 0.5)  # s, at random in between: flashes must not be synchronous with the frames
WORST_SIGMA = 0.01  # s; with a larger standard deviation the flashes are useless


class Flashes:
    """Frames and flashes as they come, and the camera's delay from both."""

    def __init__(self) -> None:
        self._frames: list[CameraFrame] = []
        self._edges: dict[int, list[float]] = {EventCode.FLASH_ON: [], EventCode.FLASH_OFF: []}

    def add_frames(self, frames: list[CameraFrame]) -> None:
        """Frames, oldest first."""
        self._frames += frames

    def add_event(self, event: BoardEvent) -> None:
        """An event of the board; flashes are kept."""
        if event.code in self._edges:
            self._edges[event.code].append(1e-6 * event.board_us)

    def offset(self, fit: ClockFit) -> CameraOffset:
        """The camera's delay; Fault("camera") where the flashes are not seen, or seen too dimly to tell."""
        arrival = steadied(np.array([frame.host_s for frame in self._frames]))
        times = np.array([fit.to_board(float(host_s)) for host_s in arrival])
        on, off = (np.array(edges) for edges in self._edges.values())
        lit = lit_frames(np.array([frame.thumbnail for frame in self._frames]), times, on, off)
        found = estimate_offset(times, lit, on, off)
        if found.sigma > WORST_SIGMA:
            raise Fault("camera", f"the flashes tell the camera's delay to {1e3 * found.sigma:.0f} ms only")
        return found


class CameraWatch:
    """A camera while one run lasts. Frames from before it are let go."""

    def __init__(self, camera: CameraThread, settings: CameraSettings, host_time: HostTime) -> None:
        self._camera, self._settings, self._time = camera, settings, host_time
        self._flashes: Flashes | None = Flashes()
        self._offset: CameraOffset | None = None
        self._gaps: list[tuple[float, float]] = []
        self._stalled_since: float | None = None
        camera.take()

    def take(self) -> list[CameraFrame]:
        """The frames that have come since the last call.

        A stalled camera does not end a run, because motor and load cell are complete; the gap is recorded.
        """
        frames = self._camera.take()
        if self._flashes is not None:
            self._flashes.add_frames(frames)
        now = self._time.now()
        if self._camera.stalled and self._stalled_since is None:
            self._stalled_since = now - self._camera.silence
        elif not self._camera.stalled and self._stalled_since is not None:
            self._gaps.append((self._stalled_since, now))
            self._stalled_since = None
        return frames

    def event(self, event: BoardEvent) -> None:
        """An event of the board."""
        if self._flashes is not None:
            self._flashes.add_event(event)

    def synchronise(self, fit: ClockFit) -> None:
        """After the flashes: the camera's delay from them, combined with its calibration."""
        assert self._flashes is not None
        known = CameraOffset(self._settings.offset, self._settings.sigma, 0) if self._settings.sigma > 0 else None
        try:
            self._offset = combined(self._flashes.offset(fit), known)
        except Fault:
            self._offset = None  # the lamp is not visible: the calibrated offset is used, and the record says so
        self._flashes = None

    def record(self) -> dict[str, Any]:
        """For the stop record: the delay and its source, and the gaps [s] of host time."""
        offset, sigma, source = self._settings.offset, self._settings.sigma, "calibrated"
        if self._offset is not None:
            offset, sigma, source = self._offset.offset, self._offset.sigma, "flashes of this run"
        still = [(self._stalled_since, self._time.now())] if self._stalled_since is not None else []
        return {"offset_s": offset, "offset_sigma_s": sigma, "offset_from": source, "gaps_host_s": self._gaps + still}

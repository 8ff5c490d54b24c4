"""What a viewer is fed while a run lasts: small pictures, seldom; and a viewer that is gone costs nothing."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from rig.camera import CameraFrame, compressed
from rig.clock import ClockFit
from rig.live_feed import PREVIEW_EVERY, PREVIEW_WIDTH, LiveFeed, preview
from rig.record import Attendance


@pytest.mark.parametrize("width", [160, 640, 3840])
def test_a_preview_is_small_and_shows_the_same(width: int) -> None:
    picture = np.full((width * 9 // 16, width), 200, dtype=np.uint8)
    picture[:, : width // 2] = 40
    small = cv2.imdecode(np.frombuffer(preview(compressed(picture, 0.0).jpeg), np.uint8), cv2.IMREAD_GRAYSCALE)
    assert small is not None
    assert small.shape == (min(width, PREVIEW_WIDTH) * 9 // 16, min(width, PREVIEW_WIDTH))
    middle = small.shape[1] // 2
    assert small[:, : middle - 8].mean() == pytest.approx(40, abs=2)  # JPEG rings beside an edge
    assert small[:, middle + 8 :].mean() == pytest.approx(200, abs=2)


def test_pictures_go_out_a_few_times_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    """A minute at 30 frames a second: one in PREVIEW_EVERY, on the board's time; none before the clock is known."""
    shown: list[float] = []
    feed = LiveFeed("rerun+http://127.0.0.1:1/proxy")  # nobody listens there
    monkeypatch.setattr(feed._stream, "set_time", lambda _line, duration: shown.append(1e-9 * duration.astype(float)))
    monkeypatch.setattr(feed._stream, "log", lambda *_: None)
    jpeg = compressed(np.zeros((12, 16), dtype=np.uint8), 0.0).jpeg
    frames = [CameraFrame(100.0 + k / 30, jpeg, np.zeros((12, 16))) for k in range(1800)]
    feed.frames(frames[:30])
    assert shown == []
    feed.clock(ClockFit(host_zero=100.0, board_zero=7.0, skew=0.0, sigma=1e-4, round_trip=1e-3))
    for frame in frames:
        feed.frames([frame])
    assert np.diff(shown).min() > PREVIEW_EVERY - 1e-6
    assert len(shown) == pytest.approx(60 / PREVIEW_EVERY, rel=0.1)
    assert shown[0] == pytest.approx(7.0)
    feed.close()


def test_a_viewer_that_is_not_there_leaves_the_file_whole(emulator, tmp_path: Path) -> None:
    from benchmarks._rig_scene import TABLE, WAVE, setup_for
    from rig.connection import connected
    from rig.motion import rig_motion
    from rig.record import record_run
    from rig.run_file import read_run

    setup, path = setup_for(emulator), tmp_path / "run.rrd"
    with connected(setup) as board:
        motion = rig_motion(WAVE, 0.5, setup.limits, TABLE)
        result = record_run(
            setup, board, None, motion, path, Attendance(name="seen", viewer="rerun+http://127.0.0.1:1/proxy")
        )
    assert result.outcome == read_run(path).outcome == "complete"
    assert result.lost == 0

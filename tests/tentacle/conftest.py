"""Small videos that the tests of recordings share."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest


@pytest.fixture
def png_frames(tmp_path: Path) -> Path:
    folder = tmp_path / "some_frames"
    folder.mkdir()
    rng = np.random.default_rng(5)
    for number in range(4):
        picture = rng.integers(0, 256, (24, 32), dtype=np.uint8)
        cv2.imwrite(str(folder / f"{number:05d}.png"), picture)
    return folder

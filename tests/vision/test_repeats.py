"""Copies of a picture are told from pictures that differ by noise, also under flickering light."""

import numpy as np
import pytest

from vision.repeats import Repeats


@pytest.mark.parametrize("flicker", [0.0, 0.15])
def test_only_copies_are_repeats(flicker):
    """Two pictures in a row have equal light by chance (k = 12, 13); only the copy of picture 20 repeats."""
    rng = np.random.default_rng(1)
    light = 1.0 + flicker * np.sin(2.3 * np.arange(30))
    light[13] = light[12]
    pictures = [np.clip(150.0 * gain + rng.normal(0.0, 2.0, (140, 200)), 0, 255).astype(np.uint8) for gain in light]
    pictures.insert(21, pictures[20].copy())
    repeats = Repeats()
    repeats.begin(pictures[:8])
    assert [k for k, picture in enumerate(pictures) if repeats.repeats(picture)] == [21]

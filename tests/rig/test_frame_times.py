"""A camera's own rhythm, found behind a line that delays each picture differently."""

from __future__ import annotations

import numpy as np
import pytest

from rig.frame_times import steadied

JITTER = 1.5e-3  # s
TRUE = 5.0 + np.delete(np.arange(450), [100, 101, 200]) / 29.97  # 15 s, three pictures dropped


@pytest.mark.parametrize("seed", range(5))
def test_a_steady_camera_loses_the_lines_jitter(seed: int) -> None:
    """Two numbers from 447 arrivals: an error of JITTER sqrt(2 / 447) rms, 0.1 ms; three times that at most."""
    arrival = TRUE + JITTER * np.random.default_rng(seed).normal(size=TRUE.size)
    assert np.sqrt(np.mean((steadied(arrival) - TRUE) ** 2)) < 3e-4


def test_pictures_that_came_very_late_do_not_move_the_line() -> None:
    """A computer that was busy for a moment: 8 pictures are 12 ms late. Clipped, they leave the line where it was."""
    arrival = TRUE + JITTER * np.random.default_rng(1).normal(size=TRUE.size)
    arrival[50:440:50] += 0.012
    assert np.sqrt(np.mean((steadied(arrival) - TRUE) ** 2)) < 3e-4


def test_a_camera_that_changes_its_rhythm_keeps_its_arrivals() -> None:
    """The light falls, the exposure grows: 30 pictures a second become 24. No line holds for both."""
    arrival = np.cumsum(np.r_[np.full(200, 1 / 30), np.full(200, 1 / 24)])
    arrival += JITTER * np.random.default_rng(2).normal(size=arrival.size)
    np.testing.assert_array_equal(steadied(arrival), arrival)


def test_few_pictures_keep_their_arrivals() -> None:
    np.testing.assert_array_equal(steadied(TRUE[:30]), TRUE[:30])

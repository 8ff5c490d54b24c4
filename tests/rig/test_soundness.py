"""A run that is to be diagnosed from its film has one, of the whole motion."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.export import arm
from rig.run_file import read_run
from rig.soundness import film_gap, is_complete_run, is_filmed_run
from tentacle.waveform import Chirp
from tests.rig.filmed import filmed_run


def test_the_longest_time_without_a_picture_is_found(tmp_path: Path) -> None:
    """30 pictures a second over 2 s: 33 ms apart. Without those from 0.5 to 1.7 s the gap is 1.2 s and one interval."""
    file = tmp_path / "run.rrd"
    filmed_run(arm(), {}, Chirp(0.3, 0.5, 1.0, 2.0), 2.0, file, {"kind": "chirp"})
    run = read_run(file)
    interval = 1 / 30
    assert film_gap(run) == pytest.approx(interval, abs=1e-3)
    assert is_complete_run(file)
    assert is_filmed_run(file)
    t = run.frame_host_t - run.zero
    stalled = replace(run, frame_host_t=run.frame_host_t[(t < 0.5) | (t > 1.7)])
    assert film_gap(stalled) == pytest.approx(1.2, abs=2 * interval)
    assert film_gap(replace(run, frame_host_t=np.empty(0))) == pytest.approx(2.0, abs=0.02)  # two set points

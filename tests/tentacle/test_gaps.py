"""Gaps in a signal are told, and times in other units than seconds refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rig.bench_log import read_bench_log
from tentacle.errors import InputError
from tentacle.io.recording_summary import gap_words
from tentacle.io.sound_recording import require_steps


def test_a_gap_of_more_than_a_second_is_told() -> None:
    t = np.arange(0.0, 3.0, 0.01)
    assert gap_words(t) == ""
    assert gap_words(np.where(t > 1.005, t + 30.0, t)) == ", a gap of 30.01 s after 1 s"
    assert gap_words(np.where(t > 1.005, t + 0.9, t)) == ""  # a rig's load cell may be silent for so long


def test_pictures_that_are_seconds_apart_have_no_gap() -> None:
    assert gap_words(np.arange(0.0, 60.0, 5.0)) == ""
    assert gap_words(np.array([0.0, 5.0, 10.0, 40.0])) == ", a gap of 30 s after 10 s"
    assert gap_words(np.array([1.0])) == ""


def test_samples_closer_than_a_microsecond_are_a_time_in_other_units(tmp_path: Path) -> None:
    t = 1e-6 * np.arange(100)
    require_steps(t, "t_s", tmp_path)
    with pytest.raises(InputError, match=r"100 samples within 9\.9e-11 s; expected times in seconds"):
        require_steps(1e-6 * t, "t_s", tmp_path)
    log = tmp_path / "log.csv"
    log.write_text("timestamp_s,thrust_raw\n" + "".join(f"{k}e-12,{k}\n" for k in range(5)))
    with pytest.raises(InputError, match="5 samples within"):
        read_bench_log(log)

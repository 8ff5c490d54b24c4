"""A run that was not measured all along is not called complete: what is missing is told in seconds."""

from __future__ import annotations

import numpy as np
import pytest

from rig.coverage import told_gaps
from rig.play import PlayEnd

START = 5_000_000  # us
SECONDS = 60.0
LOAD = np.arange(0.0, SECONDS, 0.0107)
SERVO = np.arange(0.0, SECONDS, 0.02)


def told(load: np.ndarray, servo: np.ndarray) -> PlayEnd:
    """What is said of a run with readings at these times [s]."""
    load_us, servo_us = ([round(START + 1e6 * t) for t in series] for series in (load, servo))
    return told_gaps(PlayEnd("complete", "", START), load_us, servo_us, SECONDS)


def test_a_run_that_was_measured_all_along_is_complete() -> None:
    assert (told(LOAD, SERVO).outcome, told(LOAD, SERVO).words) == ("complete", "")
    slow = np.arange(0.0, SECONDS, 0.0856)  # the load cell's slow rate
    assert told(slow, SERVO).words == ""


def test_thirty_seconds_that_the_host_slept_are_missing() -> None:
    awake = [series[(series < 10.0) | (series > 40.0)] for series in (LOAD, SERVO)]
    for load, servo, outcome in ((awake[0], awake[1], "load_cell"), (LOAD, awake[1], "no_answer")):
        end = told(load, servo)
        assert end.outcome == outcome
        assert "gave no reading for 30.0" in end.words


@pytest.mark.parametrize(("share", "outcome"), [(0.3, "complete"), (0.7, "load_cell")])
def test_a_cell_that_saturates_at_each_stroke_is_told(share: float, outcome: str) -> None:
    """Gaps of .3 s a second lose less than a quarter in seconds over .2 s; gaps of .7 s lose the peaks."""
    period, seen = 2.0 if outcome == "complete" else 1.0, LOAD
    kept = seen[(seen % period) >= share]
    end = told(kept, SERVO)
    missing = share * SECONDS / period
    assert end.outcome == outcome
    assert float(end.words.split("for ")[1].split()[0]) == pytest.approx(missing, abs=0.02 * SECONDS)

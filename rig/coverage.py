"""Checks that a run was measured without gaps: with a long gap in the readings its outcome is not complete."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rig.play import PlayEnd

LONGEST_SILENCE = 1.0  # s without a reading; the cell's chip takes half of it to be started again after a bad read
SHORT_GAP = 0.2  # s; two conversions of the load cell at its slow rate
MOST_MISSING = 0.25  # of a run, sum of short gaps: a load cell that saturates in each stroke loses the peaks


def told_gaps(end: PlayEnd, load_us: Sequence[int], servo_us: Sequence[int], seconds: float) -> PlayEnd:
    """The end of a run of so many seconds, with what its readings' times on the board [us] say of it."""
    if end.outcome != "complete":
        return end
    for name, times in (("the load cell", load_us), ("the servo", servo_us)):
        gaps = gap_seconds(np.asarray(times, dtype=float), end.start_us, seconds)
        long, short = (float(gaps[gaps > least].sum()) for least in (LONGEST_SILENCE, SHORT_GAP))
        words = f"{name} gave no reading for {short:.2f} of {seconds:.2f} s"
        if long > 0.0 or short > MOST_MISSING * seconds:
            return PlayEnd("load_cell" if name == "the load cell" else "no_answer", words, end.start_us)
        if short > 0.0:  # the run is complete, and its record states the gaps
            end = PlayEnd(end.outcome, "; ".join(filter(None, (end.words, words))), end.start_us)
    return end


def gap_seconds(times_us: np.ndarray, start_us: float, seconds: float) -> np.ndarray:
    """The times between readings within a run, its begin and end included [s]."""
    t = 1e-6 * (times_us - start_us)
    return np.diff(np.concatenate([[0.0], t[(t > 0.0) & (t < seconds)], [seconds]]))

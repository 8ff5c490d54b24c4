"""Whether a run was measured all along: readings that are missing for long make it another outcome than complete."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rig.play import PlayEnd

LONGEST_SILENCE = 1.0  # s without a reading; the cell's chip takes half of it to be started again after a bad read


def told_gaps(end: PlayEnd, load_us: Sequence[int], servo_us: Sequence[int], seconds: float) -> PlayEnd:
    """The end of a run of so many seconds, with what its readings' times on the board [us] say of it."""
    if end.outcome != "complete":
        return end
    for name, times in (("the load cell", load_us), ("the servo", servo_us)):
        missing = missing_seconds(np.asarray(times, dtype=float), end.start_us, seconds)
        if missing > 0.0:
            words = f"{name} gave no reading for {missing:.2f} of {seconds:.2f} s"
            return PlayEnd("load_cell" if name == "the load cell" else "no_answer", words, end.start_us)
    return end


def missing_seconds(times_us: np.ndarray, start_us: float, seconds: float) -> float:
    """The sum of the gaps over LONGEST_GAP within a run, its begin and end included [s]."""
    t = 1e-6 * (times_us - start_us)
    inside = np.concatenate([[0.0], t[(t > 0.0) & (t < seconds)], [seconds]])
    gaps = np.diff(inside)
    return float(gaps[gaps > LONGEST_SILENCE].sum())

"""The first part of a recording is that part of the whole one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inference.horizon import AFTERWARDS, first_part, until
from inference.prepare import prepare
from tests.made_recordings import base_of


def test_an_early_problem_has_the_first_residuals_of_the_whole_one(recorded) -> None:
    """A run knows nothing of what comes later."""
    fit = base_of(recorded(seconds=6.0))
    problem, fitted = fit.problem, fit.fitted
    early = first_part(problem, fitted.nuisances, 0.25, 0.05)
    frames = early.experiments[0].used.size
    assert 6 < frames < problem.experiments[0].used.size / 2  # the motion is steady after its first second
    unknowns = np.concatenate([fitted.values, *fitted.nuisances])[:, None]
    whole = replace(problem, filters=()).residuals(unknowns)[1][0]
    part = replace(early, filters=()).residuals(unknowns)[1][0]
    # To the rounding of a base motion that is tabulated over another number of steps.
    np.testing.assert_allclose(part, whole[:frames], rtol=1e-9, atol=1e-9)


def test_a_horizon_beyond_the_end_is_the_whole_recording(recorded) -> None:
    recording = recorded(seconds=3.0)
    whole = prepare(recording, hold_out=False).experiment
    assert until(whole, 1e3).used.size == whole.used.size
    assert until(whole, 1e3).duration == whole.duration
    half = until(whole, whole.t0 + 1.5)
    assert half.duration == 1.5 + AFTERWARDS
    assert half.observation.t[-1] < whole.t0 + 1.5

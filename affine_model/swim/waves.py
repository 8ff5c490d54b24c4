"""Single waves: gaits of one term of eq. 20, over frequency and bend. The best of them is where optimise begins.

As printed, eq. 20 adds its phase to every harmonic alike, so alpha_8 and alpha_9 bend the square and the saw-tooth
into a family of shapes. With all that a hobby servo can do, the best gaits found are one square wave bent towards a
triangle, at the servo's full speed from end to end. In the nine-dimensional box it lies on a narrow ridge that a search
may miss; this grid finds it. If the frequency is limited, the search finds better gaits (Table II: up to 19 %).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from affine_model.swim.objectives import Objective, gait_scores
from affine_model.swim.trial import GaitTrial, run

SQUARE, SAW = 1, 2  # places of the two terms with a shape to bend


def single_waves(term: NDArray[np.intp], frequency: Array, bend: Array, amplitude: float) -> Array:
    """Gaits (9, B) of one term each: term (B,) its place, frequency (B,) [Hz], bend (B,) [rad] its phase."""
    alpha, every = np.zeros((9, len(term))), np.arange(len(term))
    alpha[term, every] = amplitude
    alpha[3:6] = 2.0 * np.pi * frequency
    alpha[6 + term, every] = bend
    return alpha


def best_wave(trial: GaitTrial, objective: Objective, rounds: int = 4) -> tuple[Array, float]:
    """The best single wave at the servo's limits: alpha (9,) and its score.

    First both terms at 12 frequencies and 16 phases, then grids of 7 by 7 that shrink around the best. A climb by
    gradients would stop where two limits meet, and the best waves lie there.
    """
    low, high = trial.limits.lowest_frequency, trial.limits.highest_frequency
    terms, frequencies, bends = (
        np.array([SQUARE, SAW], np.intp),
        np.linspace(low, high, 12),
        2.0 * np.pi * np.arange(16) / 16,
    )
    width, turn = frequencies[1] - frequencies[0], bends[1]
    best_alpha, best_score, centre, middle = np.zeros(9), -np.inf, low, 0.0
    for _ in range(rounds):
        frequency, bend = (axis.ravel() for axis in np.meshgrid(frequencies, bends, indexing="ij"))
        term = np.repeat(terms, len(frequency))
        frequency, bend = np.tile(frequency, len(terms)), np.tile(bend, len(terms))
        outcome = run(trial, single_waves(term, frequency, bend, trial.limits.servo.angle))
        values = gait_scores(objective, trial, outcome)
        leader = int(np.argmax(values))
        if values[leader] > best_score:
            best_alpha, best_score = outcome.alpha[:, leader], float(values[leader])
            terms, centre, middle = term[[leader]], frequency[leader], bend[leader]
        steps = np.linspace(-1.0, 1.0, 7)
        frequencies, bends = np.clip(centre + width * steps, low, high), middle + turn * steps
        width, turn = width / 3.0, turn / 3.0
    return best_alpha, best_score

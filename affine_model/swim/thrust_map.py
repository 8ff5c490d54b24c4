"""The paper's baseline: sines over amplitude and frequency (Fig. 9), and the best of them within the servo's limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array
from affine_model.swim.objectives import Objective, gait_scores
from affine_model.swim.trial import GaitTrial, run


@dataclass(frozen=True)
class SineMap:
    """amplitudes (A,) [rad] asked for, frequencies (F,) [Hz], values (A, F) of the objective, NaN where the servo
    cannot follow.
    """

    amplitudes: Array
    frequencies: Array
    values: Array


def sine_gaits(amplitude: Array, frequency: Array) -> Array:
    """Gaits (9, B) that are plain sines: amplitude (B,) [rad], frequency (B,) [Hz]. Silent terms get the same
    frequency.
    """
    alpha = np.zeros((9, len(amplitude)))
    alpha[0] = amplitude
    alpha[3:6] = 2.0 * np.pi * frequency
    return alpha


def sine_map(trial: GaitTrial, objective: Objective, amplitudes: Array, frequencies: Array) -> SineMap:
    """The objective over a grid of sines, each exactly as asked for or not at all."""
    grid = np.meshgrid(amplitudes, frequencies, indexing="ij")
    outcome = run(trial, sine_gaits(grid[0].ravel(), grid[1].ravel()))
    values = gait_scores(objective, trial, outcome)
    as_asked = outcome.alpha[0] > (1.0 - 1e-9) * grid[0].ravel()
    values = np.where(as_asked, values, np.nan).reshape(grid[0].shape)
    return SineMap(np.asarray(amplitudes), np.asarray(frequencies), values)


def best_sine(trial: GaitTrial, objective: Objective, rounds: int = 3, count: int = 48) -> tuple[Array, float]:
    """The best sine that the servo can follow: alpha (9,) and its score.

    At every frequency the largest possible amplitude and smaller ones are tried, on grids that shrink around the best.
    """
    limits = trial.limits
    frequency = np.linspace(limits.lowest_frequency, limits.highest_frequency, count)
    share = np.array([0.5, 0.75, 1.0])
    width = frequency[1] - frequency[0]
    best_alpha, best_score = np.zeros(9), -np.inf
    for _ in range(rounds):
        frequencies, shares = (axis.ravel() for axis in np.meshgrid(frequency, share))
        omega = 2.0 * np.pi * frequencies
        largest = np.min(limits.bounds.kinematic[:, None] / np.stack([np.ones_like(omega), omega, omega**2]), axis=0)
        outcome = run(trial, sine_gaits(shares * largest, frequencies))
        values = gait_scores(objective, trial, outcome)
        leader = int(np.argmax(values))
        if values[leader] > best_score:
            best_alpha, best_score = outcome.alpha[:, leader], float(values[leader])
        centre = best_alpha[3] / (2.0 * np.pi)
        frequency = np.linspace(centre - width, centre + width, count // 3)
        frequency = np.clip(frequency, limits.lowest_frequency, limits.highest_frequency)
        width = 2.0 * width / (count // 3 - 1)
        share = np.unique(np.clip(shares[leader] + np.array([-0.1, 0.0, 0.1]), 0.1, 1.0))
    return best_alpha, best_score

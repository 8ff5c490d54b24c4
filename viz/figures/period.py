"""The average period of q1, q2 with its standard deviation over the recording (the paper's Fig. 4)."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from tentacle.errors import InputError
from tentacle.signals import Array
from viz.figures.style import house_style, legend_above, new_figure
from viz.palette import BASE, MEASURED
from viz.spectrum import amplitude_spectrum

PHASE_BINS = 50
APERIODIC = 0.1  # of the variance; a sine cut into 50 bins leaves 0.1 %, a chirp 90 %


def fundamental_period(t: Array, theta: Array) -> float:
    """Period [s] of the base motion theta (T,) at t (T,): that of the sine which fits best, near the strongest line.

    Raises InputError where the motion does not repeat itself twice or more: folded by the period, its mean must explain
    all but APERIODIC of its variance.
    """
    frequency, amplitude = amplitude_spectrum(t, theta)
    peak = int(np.argmax(amplitude)) if len(amplitude) else 0
    if not len(frequency) or amplitude[peak] <= 1e-9 or peak < 1 or peak >= len(frequency) - 1:
        raise InputError("no period can be seen in the motion", field="motor", expected="at least two cycles of a sine")
    bin_width = float(frequency[1] - frequency[0])
    best = float(frequency[peak])
    for reach in (bin_width, 0.1 * bin_width, 0.01 * bin_width):
        tried = best + np.linspace(-reach, reach, 41)
        best = float(tried[np.argmin([sine_misfit(t, theta, one) for one in tried])])
    period = 1.0 / best
    _, _, deviation = average_over_period(t, theta[:, None], period)
    if not np.nanmean(deviation**2) <= APERIODIC * np.nanvar(theta):
        raise InputError("the motion does not repeat itself", field="motor", expected="a periodic base motion")
    return period


def sine_misfit(t: Array, values: Array, frequency: float) -> float:
    """Sum of squares that a sine of that frequency [Hz] with an offset, fitted to values (T,) at t (T,), leaves."""
    columns = np.stack([np.sin(2 * np.pi * frequency * t), np.cos(2 * np.pi * frequency * t), np.ones_like(t)], axis=1)
    solution, *_ = np.linalg.lstsq(columns, values, rcond=None)
    return float(np.sum((values - columns @ solution) ** 2))


def average_over_period(t: Array, q: Array, period: float, bins: int = PHASE_BINS) -> tuple[Array, Array, Array]:
    """Phase (bins,) in [0, 1), mean and deviation (bins, K) of q (T, K) folded by the period [s], NaN left out."""
    index = np.floor(((t / period) % 1.0) * bins).astype(int) % bins
    mean, deviation = np.full((bins, q.shape[1]), np.nan), np.full((bins, q.shape[1]), np.nan)
    for k in range(bins):
        values = q[index == k]
        values = values[np.isfinite(values).all(axis=1)]
        if len(values):
            mean[k], deviation[k] = values.mean(axis=0), values.std(axis=0)
    return (np.arange(bins) + 0.5) / bins, mean, deviation


def period_figure(t: Array, q: Array, period: float) -> Figure:
    """q (T, 2) [rad] folded by the period [s]: dotted the mean, coloured its standard deviation."""
    with house_style():
        figure = new_figure(2.6)
        axes = figure.subplots()
        phase, mean, deviation = average_over_period(t, q, period)
        for index, role in enumerate((MEASURED, BASE)):
            low, high = mean[:, index] - deviation[:, index], mean[:, index] + deviation[:, index]
            axes.fill_between(phase * period, low, high, color=role.hex, alpha=0.35, lw=0)
            axes.plot(phase * period, mean[:, index], ":", color=role.hex, lw=1.8, label=f"q{index + 1}")
        axes.set_xlabel(f"time within the period of {period:.3f} s [s]")
        axes.set_ylabel("curvature coordinate [rad]")
        legend_above(figure, axes)
        return figure

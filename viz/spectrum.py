"""One-sided amplitude spectrum of a signal that may be sampled unevenly and have gaps."""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array


def amplitude_spectrum(t: Array, values: Array) -> tuple[Array, Array]:
    """Frequencies (F,) [Hz] and amplitudes (F,) in the unit of values, of values (T,) at times t (T,) [s].

    A sine of amplitude a on a bin reads a (Hann window, coherent gain divided out). Gaps (NaN) are bridged linearly,
    the mean is taken off. Empty arrays where fewer than 8 samples are present.
    """
    present = np.isfinite(values)
    if present.sum() < 8:
        return np.empty(0), np.empty(0)
    t_present, present_values = t[present], values[present]
    # the median step, not the mean: one long gap must not coarsen the grid
    step = float(np.median(np.diff(t_present)))
    grid = np.arange(t_present[0], t_present[-1] + 0.5 * step, step)
    signal = np.interp(grid, t_present, present_values)
    window = np.hanning(len(grid))
    weighted = (signal - np.average(signal, weights=window)) * window
    amplitude = 2.0 * np.abs(np.fft.rfft(weighted)) / window.sum()
    frequency = np.asarray(np.fft.rfftfreq(len(grid), step), dtype=np.float64)
    return frequency[1:], amplitude[1:]

"""The noise floor of a measured signal, from its fourth differences: a smooth motion has almost none."""

from __future__ import annotations

import numpy as np

from affine_model.curvature import Array

FOURTH_DIFFERENCE = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
FOURTH_GAIN = float(np.sum(FOURTH_DIFFERENCE**2))  # 70: variance of the fourth difference of white noise


def noise_deviation(series: Array) -> Array:
    """Standard deviation of the white noise in each column of series (T, ...), NaN rows skipped; robust to jumps.

    A motion at frequency f sampled at f_s keeps (2 pi f / f_s)^4 of its amplitude in a fourth difference: .2 % at
    2 Hz and 60 frames/s. Columns with fewer than 12 usable differences give NaN.
    """
    flat = series.reshape(series.shape[0], -1)
    differences = sum(weight * flat[k : flat.shape[0] - 4 + k] for k, weight in enumerate(FOURTH_DIFFERENCE))
    result = np.full(flat.shape[1], np.nan)
    for column in range(flat.shape[1]):
        values = np.asarray(differences)[:, column]
        values = values[np.isfinite(values)]
        if values.size >= 12:
            result[column] = 1.4826 * np.median(np.abs(values)) / np.sqrt(FOURTH_GAIN)
    return result.reshape(series.shape[1:])

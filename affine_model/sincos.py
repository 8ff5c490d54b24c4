"""Sine and cosine for loops over many lanes. The kernel's template contains the text of this function."""

from __future__ import annotations

import numpy as np


def sincos(angle):
    """Sine and cosine to 1e-15 without a branch, so that the loop around it vectorises."""
    quadrant = np.floor(angle * 0.6366197723675814 + 0.5)
    y = (angle - quadrant * 1.5707963267341256) - quadrant * 6.077100506506192e-11
    yy = y * y
    sine = y + y * yy * (
        -1.6666666666666632e-01
        + yy
        * (
            8.333333333322489e-03
            + yy
            * (
                -1.984126982985795e-04
                + yy * (2.7557313707070068e-06 + yy * (-2.5050760253406863e-08 + yy * 1.58969099521155e-10))
            )
        )
    )
    cosine = (
        1.0
        - 0.5 * yy
        + yy
        * yy
        * (
            4.16666666666666e-02
            + yy
            * (
                -1.388888888887411e-03
                + yy
                * (
                    2.4801587289476728e-05
                    + yy * (-2.7557314351390663e-07 + yy * (2.0875723212981748e-09 - yy * 1.1359647557788195e-11))
                )
            )
        )
    )
    turn = quadrant - 4.0 * np.floor(quadrant * 0.25)
    odd = (turn == 1.0) | (turn == 3.0)
    sine_sign = 1.0 if turn < 2.0 else -1.0
    cosine_sign = 1.0 if (turn < 1.0) | (turn > 2.0) else -1.0
    return sine_sign * (cosine if odd else sine), cosine_sign * (sine if odd else cosine)

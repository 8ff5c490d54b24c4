"""The nine-parameter gait of eq. 20 as a base motion: a sine, a square wave and a saw-tooth, five terms each.

The paper sums infinitely many terms, and the sum's acceleration is unbounded. Here the first five of each series are
taken, and harmonics fade out towards the servo's bandwidth: harmonic n >= 2 of a fundamental f is weighed by cos^2(pi/2
n f / bandwidth), zero from there on, so that the motion is smooth in time and in its parameters. As in the paper, the
same phase is added to every harmonic, so alpha_8 and alpha_9 change the shape of the square wave and the saw-tooth and
do not shift them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tentacle.errors import InputError
from tentacle.signals import Array

# The definition's constants: for every harmonic its multiple n of the fundamental, its coefficient, and which of the
# three waves of eq. 20 it belongs to (0 sine, 1 square wave, 2 saw-tooth).
GAIT_TERMS = 5
_HARMONICS = (
    [(1, 1.0, 0)]
    + [(2 * k - 1, 1.0 / (2 * k - 1), 1) for k in range(1, GAIT_TERMS + 1)]
    + [(k, 1.0 / k, 2) for k in range(1, GAIT_TERMS + 1)]
)
MULTIPLE = np.array([harmonic[0] for harmonic in _HARMONICS])
COEFFICIENT = np.array([harmonic[1] for harmonic in _HARMONICS])
TERM = np.array([harmonic[2] for harmonic in _HARMONICS])
GAIT_PARAMETERS = 9


def harmonic_weights(fundamental: ArrayLike, bandwidth: float) -> Array:
    """Weight of every harmonic (H, ...) for fundamentals (3, ...) [Hz] of the three terms and a bandwidth
    [Hz].
    """
    frequency = np.abs(np.asarray(fundamental, dtype=float))[TERM]
    multiple = MULTIPLE.reshape(-1, *([1] * (frequency.ndim - 1)))
    share = multiple * frequency / bandwidth
    return np.where(multiple == 1, 1.0, np.cos(0.5 * np.pi * np.minimum(share, 1.0)) ** 2)


@dataclass(frozen=True)
class Gait:
    """Eq. 20: alpha (9,) = amplitudes alpha_1..3 [rad], angular frequencies alpha_4..6 [rad/s], phases alpha_7..9
    [rad].

    bandwidth [Hz]: harmonics above the fundamental fade out up to it. Raises InputError on numbers that make no motion.
    """

    alpha: tuple[float, ...]
    bandwidth: float = 5.0

    def __post_init__(self) -> None:
        if len(self.alpha) != GAIT_PARAMETERS or not np.all(np.isfinite(self.alpha)):
            raise InputError(f"{self.alpha!r} is not usable", field="alpha", expected="nine finite numbers")
        if not (np.isfinite(self.bandwidth) and self.bandwidth > 0.0):
            raise InputError(f"{self.bandwidth!r} is not usable", field="bandwidth_hz", expected="a positive number")

    def __call__(self, t: ArrayLike) -> Array:
        """theta, its rate and its acceleration, (3, ...) [rad, s]."""
        t = np.asarray(t, dtype=float)
        amplitude, omega, phase = np.array(self.alpha).reshape(3, 3)
        strength = amplitude[TERM] * COEFFICIENT * harmonic_weights(omega / (2.0 * np.pi), self.bandwidth)
        rate = (MULTIPLE * omega[TERM]).reshape(-1, *([1] * t.ndim))
        angle = rate * t + phase[TERM].reshape(-1, *([1] * t.ndim))
        waves = np.stack([np.sin(angle), rate * np.cos(angle), -(rate**2) * np.sin(angle)])
        return np.tensordot(waves, strength, axes=([1], [0]))

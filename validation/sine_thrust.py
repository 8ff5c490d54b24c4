"""Fig. 9: mean thrust of sines over amplitude and frequency, from the model and from a load cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from affine_model.arm import arm_of, parameter_vector
from affine_model.simulate import Timing, simulate
from tentacle.model import Model
from tentacle.signals import Array, LoadCellSignal, MotorSignal
from tentacle.waveform import Sine

STEP, SECONDS = 1.0 / 300.0, 10.0  # s; the paper averages over 10 s

SineRun = tuple[float, MotorSignal, LoadCellSignal]  # frequency [Hz] of the sine, its motor log and load cell


@dataclass(frozen=True)
class SineThrust:
    """amplitude (A,) [rad], frequency (F,) [Hz]; mean forward thrust (A, F) [N], modelled and measured.

    measured is NaN where no recording has that sine, and None without any recording. Forward is base first, along -y.
    """

    amplitude: Array
    frequency: Array
    modelled: Array
    measured: Array | None


def sine_thrust(model: Model, recordings: Sequence[SineRun]) -> SineThrust:
    """On the grid that the recordings' sines span; without recordings 0.1 to 0.7 rad and 0.3 to 1.8 Hz.

    Force and load cell (tared) change their sign, because both are positive along +y.
    """
    amplitude, frequency, measured = np.linspace(0.1, 0.7, 5), np.linspace(0.3, 1.8, 6), None
    if recordings:
        tried = [(float(np.ptp(motor.angle) / 2), f) for f, motor, _ in recordings]
        amplitude = np.unique(np.round([a for a, _ in tried], 2))
        frequency = np.unique(np.round([f for _, f in tried], 2))
        measured = np.full((len(amplitude), len(frequency)), np.nan)
        for (a, f), (_, _, cell) in zip(tried, recordings, strict=True):
            place = int(np.argmin(np.abs(amplitude - a))), int(np.argmin(np.abs(frequency - f)))
            measured[place] = -cell.thrust.mean()
    middles = (np.arange(round(SECONDS / STEP)) + 0.5) * STEP
    grid = [(a, f) for a in amplitude for f in frequency]
    base = np.stack([Sine(a, f)(middles) for a, f in grid], axis=-1)
    parameters = np.repeat(parameter_vector(model)[:, None], len(grid), axis=1)
    batch = simulate(arm_of(model), parameters, base, Timing(STEP, 0))
    return SineThrust(amplitude, frequency, -batch.mean_thrust.reshape(len(amplitude), len(frequency)), measured)

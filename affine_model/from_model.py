"""A simulation that starts from a model as data (tentacle.model): its arm, its parameters, its servo's lag and play."""

from __future__ import annotations

import numpy as np

from affine_model.arm import arm_of, parameter_index, parameter_vector, refuse_soft_sections
from affine_model.base_signal import base_table
from affine_model.curvature import Array
from affine_model.simulate import Batch, Rail, Servo, simulate
from tentacle.model import Model
from tentacle.waveform import Waveform


def simulate_model(
    model: Model,
    waveform: Waveform,
    duration: float,
    *,
    step: float = 1 / 500,
    q: Array | None = None,
    q_rate: Array | None = None,
    servo: Servo | None = None,
    rail: Rail | None = None,
    t0: float = 0.0,
    stride: int = 1,
) -> Batch:
    """The model under a base motion (with a servo: under that command) for `duration` [s]; one individual.

    q, q_rate (n,): initial curvature and rates, zero if None. InputError where k(s) <= 0 somewhere, or the model names
    an unknown parameter.
    """
    arm, parameters = arm_of(model), parameter_vector(model)
    refuse_soft_sections(arm, parameters)
    lag, play = (parameters[[parameter_index(*name)]] for name in (("servo_lag", "tau"), ("backlash", "play")))
    base = base_table(waveform, t0, step, round(duration / step), lag, play)
    start, rate = (None if value is None else np.asarray(value, dtype=float)[:, None] for value in (q, q_rate))
    return simulate(
        arm, parameters[:, None], base, step, q=start, q_rate=rate, servo=servo, rail=rail, t0=t0, stride=stride
    )

"""A simulation that starts from a model as data (tentacle.model): its arm, its parameters, its servo's lag and play."""

from __future__ import annotations

import numpy as np

from affine_model.advance import PRESCRIBED, Drive
from affine_model.arm import arm_of, parameter_vector, refuse_soft_sections
from affine_model.base_signal import Steps, base_table
from affine_model.simulate import STRAIGHT, Batch, Start, Timing, simulate
from tentacle.model import Model
from tentacle.waveform import Waveform

EVERY_STEP = Timing(1 / 500)


def simulate_model(
    model: Model,
    waveform: Waveform,
    duration: float,
    *,
    timing: Timing = EVERY_STEP,
    start: Start = STRAIGHT,
    drive: Drive = PRESCRIBED,
) -> Batch:
    """The model under a base motion (with a servo: under that command) for `duration` [s]; one individual.

    start: as for simulate, with (n,) in place of (n, B). InputError where k(s) <= 0 somewhere, or the model names
    an unknown parameter.
    """
    arm, parameters = arm_of(model), parameter_vector(model)
    refuse_soft_sections(arm, parameters)
    steps = Steps(start.t0, timing.step, round(duration / timing.step))
    base = base_table(waveform, steps, parameters[:, None])
    q, rate, memory = (
        None if value is None else np.asarray(value, dtype=float)[:, None]
        for value in (start.q, start.q_rate, start.memory)
    )
    begins = Start(q, rate, memory, start.t0)
    return simulate(arm, parameters[:, None], base, timing, start=begins, drive=drive)

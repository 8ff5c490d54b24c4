"""The base motion as the kernel takes it: tables of theta and its derivatives behind the servo effects."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from affine_model.arm import parameter_index
from affine_model.curvature import Array
from affine_model.effect import BaseLaw
from affine_model.effects.backlash import BACKLASH
from affine_model.effects.servo_lag import SERVO_LAG
from tentacle.waveform import Waveform

DRIVE_TRAIN = (SERVO_LAG, BACKLASH)  # in the order in which the motion passes them: the motor turns the gear
FORGOTTEN = 5.0  # s: a lag or a gear does not remember what happened longer ago than this
BaseDrive = tuple[tuple[BaseLaw, tuple[tuple[str, float], ...]], ...]


@dataclass(frozen=True)
class Steps:
    """`count` steps of `step` [s] from t0 [s] on."""

    t0: float
    step: float
    count: int

    @property
    def middles(self) -> Array:
        """Times (S,) of their middles."""
        return step_middles(self.t0, self.step, self.count)


def step_middles(t0: float, step: float, steps: int) -> Array:
    """Times (S,) of the middles of the steps, at which the kernel takes the base motion."""
    return t0 + step * (np.arange(steps, dtype=np.float64) + 0.5)


def base_table(waveform: Waveform, steps: Steps, parameters: Array, *, known_from: float | None = None) -> Array:
    """theta, rate, acceleration at the step middles for B individuals: (3, S, B), or (3, S, 1) where all share one.

    parameters (R, B): those of the servo effects bend the motion.
    known_from [s]: since when the waveform is known (default: t0). The lag and the gear carry over from the motion
    between then and t0.
    """
    individuals = _drives(parameters)
    if not any(individuals):
        return waveform(steps.middles)[:, :, None]
    t0, step = steps.t0, steps.step
    before = 0 if known_from is None else round(min(max(t0 - known_from, 0.0), FORGOTTEN) / step)
    table = waveform(step_middles(t0 - before * step, step, before + steps.count))
    bent = {}
    for drive in set(individuals):
        behind = table
        for law, values in drive:
            behind = law(behind, step, SimpleNamespace(**dict(values)))
        bent[drive] = behind[:, before:]
    return np.stack([bent[drive] for drive in individuals], axis=-1)


def has_servo_effects(parameters: Array) -> bool:
    """Whether a servo effect of the parameters (R, B) acts."""
    return any(_drives(parameters))


def _drives(parameters: Array) -> list[BaseDrive]:
    """Of each individual of parameters (R, B): the laws of the servo effects that act, with their parameters."""
    drives: list[BaseDrive] = [()] * parameters.shape[1]
    for effect in DRIVE_TRAIN:
        assert effect.base is not None
        rows = {p.name: parameters[parameter_index(effect.name, p.name)].tolist() for p in effect.parameters}
        for b in range(len(drives)):
            if any(rows[p.name][b] != 0.0 for p in effect.strengths):
                drives[b] += ((effect.base, tuple((name, row[b]) for name, row in rows.items())),)
    return drives

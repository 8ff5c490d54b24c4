"""The base motion as the kernel takes it: tables of theta and its derivatives, bent by the servo effects where they
act.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import cont2discrete, lfilter, lfiltic, ss2tf

from affine_model.arm import parameter_index
from affine_model.curvature import Array
from tentacle.waveform import Waveform

BRIEF = 0.1  # steps: an oscillation of a shorter time moves nothing in a step
FORGOTTEN = 5.0  # s: what a lag or a gear saw longer ago than this is of no account
PLAY_SMOOTHING = 0.006  # s: the play operator's corners are rounded over this time, so that theta has two derivatives


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
    """Times (S,) of the middles of the steps, where the kernel wants the base motion."""
    return t0 + step * (np.arange(steps, dtype=np.float64) + 0.5)


@dataclass(frozen=True)
class Servo:
    """What lies between the recorded angle and the clamp, for B individuals, (B,) each: the servo's low-pass, then a
    gear's play [rad], then the low-pass of its coupling; a low-pass has a delay and a natural period [s].
    """

    play: Array
    coupling: tuple[Array, Array]
    lag: tuple[Array, Array]

    @staticmethod
    def of(parameters: Array) -> Servo:
        """That of parameters (R, B)."""

        def rows(*names: tuple[str, str]) -> tuple[Array, ...]:
            return tuple(parameters[parameter_index(*name)] for name in names)

        play, delay, period = rows(("backlash", "play"), ("backlash", "delay"), ("backlash", "period"))
        tau, own = rows(("servo_lag", "tau"), ("servo_lag", "period"))
        return Servo(play, (play * delay, play * period), (tau, np.where(tau > 0.0, own, 0.0)))

    @property
    def individuals(self) -> list[tuple[float, ...]]:
        """Play, delay and period of the coupling, of the lag: of each individual."""
        return list(zip(*(one.tolist() for one in (self.play, *self.coupling, *self.lag)), strict=True))


def low_pass(table: Array, step: float, delay: float, period: float) -> Array:
    """Each row of a table (3, S) behind (period / 2 pi)^2 y'' + delay y' + y = u, started in its steady state.

    Exact for an input that is linear between samples.
    """
    if delay <= 0.0 and period <= 2.0 * np.pi * BRIEF * step:
        return table
    inertia = (period / (2.0 * np.pi)) ** 2
    if inertia > (BRIEF * step) ** 2:
        system = np.array([[0.0, 1.0], [-1.0 / inertia, -delay / inertia]]), np.array([[0.0], [1.0 / inertia]])
        seen = np.array([[1.0, 0.0]])
    else:
        system, seen = (np.array([[-1.0 / delay]]), np.array([[1.0 / delay]])), np.array([[1.0]])
    discrete: Any = cont2discrete((*system, seen, np.zeros((1, 1))), step, method="foh")
    numerator, denominator = cast("Any", ss2tf)(*discrete[:4])
    b, a = np.asarray(numerator[0]), np.asarray(denominator)
    rows = []
    for row, rate in zip(table, (*table[1:], np.gradient(table[2], step)), strict=True):
        before = row[0] - step * rate[0] * np.arange(1, a.size)
        zi = lfiltic(b, a, before - delay * rate[0], before)
        rows.append(lfilter(b, a, row, zi=zi)[0])
    return np.array(rows)


def play_operator(angle: Array, play: float) -> Array:
    """Output (S,) of a gear with total play [rad]: it follows the input once the play is used up."""
    half = 0.5 * play
    output = np.empty_like(angle)
    position = angle[0]
    for k, value in enumerate(angle):
        position = min(max(position, value - half), value + half)
        output[k] = position
    return output


def _with_play(table: Array, step: float, play: float) -> Array:
    """theta behind a gear with play, and its derivatives. Only the difference to the input is smoothed."""
    if play <= 0.0:
        return table
    lost = gaussian_filter1d(play_operator(table[0], play) - table[0], PLAY_SMOOTHING / step, mode="nearest")
    rate = np.gradient(lost, step)
    return table + np.array([lost, rate, np.gradient(rate, step)])


def base_table(waveform: Waveform, steps: Steps, servo: Servo, *, known_from: float | None = None) -> Array:
    """theta, rate, acceleration at the step middles for B individuals: (3, S, B), or (3, S, 1) where all share one.

    known_from [s]: since when the waveform is known (default: t0); what the lag and the gear hold at t0 comes from
    there.
    """
    individuals = servo.individuals
    if not any(any(values) for values in individuals):
        return waveform(steps.middles)[:, :, None]
    t0, step = steps.t0, steps.step
    before = 0 if known_from is None else round(min(max(t0 - known_from, 0.0), FORGOTTEN) / step)
    table = waveform(step_middles(t0 - before * step, step, before + steps.count))
    bent = {}
    for values in set(individuals):
        play, delay, period, tau, own_period = values
        turned = low_pass(table, step, tau, own_period)
        bent[values] = low_pass(_with_play(turned, step, play), step, delay, period)[:, before:]
    return np.stack([bent[values] for values in individuals], axis=-1)

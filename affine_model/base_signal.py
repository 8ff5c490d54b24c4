"""The base motion as the kernel takes it: tables of theta and its derivatives, bent by the servo effects where they
act.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from affine_model.curvature import Array
from tentacle.waveform import Waveform

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


def _lagged(table: Array, step: float, tau: float) -> Array:
    """First-order lag of each row (exact for piecewise linear input), started in the steady state."""
    if tau <= 0.0:
        return table
    decay = np.exp(-step / tau)
    ahead = tau / step * (1.0 - decay)
    b, a = np.array([1.0 - ahead, ahead - decay]), np.array([1.0, -decay])
    rows = []
    for row, rate in zip(table, (*table[1:], np.gradient(table[2], step)), strict=True):
        before = row[0] - step * rate[0]
        lagged_before = before - tau * rate[0]
        filtered, _ = lfilter(b, a, row, zi=[b[1] * before - a[1] * lagged_before])
        rows.append(filtered)
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


def base_table(waveform: Waveform, steps: Steps, lag: Array, play: Array, *, known_from: float | None = None) -> Array:
    """theta, rate, acceleration at the step middles for B individuals: (3, S, B), or (3, S, 1) where all share one.

    lag (B,) [s] is that of servo_lag, play (B,) [rad] that of backlash (the gear comes before the lag). known_from [s]:
    since when the waveform is known (default: t0); what the lag and the gear hold at t0 comes from there.
    """
    if not (np.any(lag > 0.0) or np.any(play > 0.0)):
        return waveform(steps.middles)[:, :, None]
    t0, step = steps.t0, steps.step
    before = 0 if known_from is None else round(min(max(t0 - known_from, 0.0), FORGOTTEN) / step)
    table = waveform(step_middles(t0 - before * step, step, before + steps.count))
    bent = {}
    for pair in zip(lag.tolist(), play.tolist(), strict=True):
        if pair not in bent:
            bent[pair] = _lagged(_with_play(table, step, pair[1]), step, pair[0])[:, before:]
    return np.stack([bent[pair] for pair in zip(lag.tolist(), play.tolist(), strict=True)], axis=-1)

"""The motor's motion: a waveform with a smooth start, behind the servo's lag and an elastic coupling.

    (period / 2 pi)^2 y'' + delay y' + y = u

A stiff coupling's play is part of the mount (mujoco_ref.mount). With an elastic coupling the arm's load on it is
neglected: the clamp follows the motor's motion behind the play.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from mujoco_ref.influence import Parameters, value
from tentacle.signals import Array
from tentacle.waveform import Waveform


def motor_signal(waveform: Waveform, times: Array, parameters: Parameters, lead_in: float) -> Array:
    """Angle, rate and acceleration (3, N) at times (N,), evenly spaced, behind the servo where it lags or has play.

    During lead_in [s], before t = 0, the motion grows from rest, with two continuous derivatives.
    """
    wave = np.asarray(waveform(times), dtype=float)
    if lead_in > 0.0:
        u = np.clip(times / lead_in + 1.0, 0.0, 1.0)
        swell = u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
        first = 30.0 * u**2 * (1.0 - u) ** 2 / lead_in
        second = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / lead_in**2
        wave = np.stack(
            [
                swell * wave[0],
                swell * wave[1] + first * wave[0],
                swell * wave[2] + 2.0 * first * wave[1] + second * wave[0],
            ]
        )
    play = value(parameters, "backlash", "play")
    delay, period = (play * value(parameters, "backlash", name) for name in ("delay", "period"))
    step, lag = float(times[1] - times[0]), value(parameters, "servo_lag", "tau")
    if lag > 0.0:
        wave = low_pass(wave, step, lag, value(parameters, "servo_lag", "period"))
    if play > 0.0 and sprung(parameters):
        wave = low_pass(_beyond_play(wave, play), step, delay, period)
    return wave


def sprung(parameters: Parameters) -> bool:
    """Whether the coupling behind the play is elastic."""
    return any(value(parameters, "backlash", name) > 0.0 for name in ("delay", "period"))


def _beyond_play(wave: Array, play: float) -> Array:
    """Angle (3, N) of a hub that the horn carries with it once it has crossed the play, and its derivatives."""
    angle, hub = wave[0], wave[0].copy()
    for i in range(1, angle.size):
        hub[i] = np.clip(hub[i - 1], angle[i] - 0.5 * play, angle[i] + 0.5 * play)
    moves = np.diff(hub, prepend=hub[0]) != 0.0
    return np.stack([hub, np.where(moves, wave[1], 0.0), np.where(moves, wave[2], 0.0)])


def low_pass(wave: Array, step: float, delay: float, period: float) -> Array:
    """Angle, rate and acceleration (3, N) behind the low-pass, from its steady state: exact where u is a cubic between
    samples, from its values and rates there.
    """
    inertia = (period / (2.0 * np.pi)) ** 2
    order = 1 if inertia == 0.0 else 2
    # State: y (and y'), then u and its three derivatives; the matrix exponential carries it over a step.
    system = np.zeros((order + 4, order + 4))
    system[order:, order:] = np.eye(4, k=1)
    if order == 1:
        system[0, :2] = -1.0 / delay, 1.0 / delay
    else:
        system[0, 1] = 1.0
        system[1, :3] = -1.0 / inertia, -delay / inertia, 1.0 / inertia
    carry = np.asarray(expm(step * system))[:order]
    u, u_rate = wave[0], step * wave[1]
    quadratic = 3.0 * (u[1:] - u[:-1]) - 2.0 * u_rate[:-1] - u_rate[1:]
    cubic = 2.0 * (u[:-1] - u[1:]) + u_rate[:-1] + u_rate[1:]
    pieces = np.stack([u[:-1], wave[1, :-1], 2.0 * quadratic / step**2, 6.0 * cubic / step**3])
    pushed = (carry[:, order:] @ pieces).T
    free = carry[:, :order]
    states = np.empty((u.size, order))
    states[0] = [u[0] - delay * wave[1, 0], wave[1, 0]][:order]
    for i in range(u.size - 1):
        states[i + 1] = free @ states[i] + pushed[i]
    angle = states[:, 0]
    if order == 1:
        rate = (u - angle) / delay
        return np.stack([angle, rate, (wave[1] - rate) / delay])
    rate = states[:, 1]
    return np.stack([angle, rate, (u - angle - delay * rate) / inertia])

"""Gaits on the MuJoCo reference, to check an optimum of the reduced model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from affine_model.simulate import Rail
from affine_model.swim import PAPER_RAIL
from mujoco_ref.mount import MountRail as ReferenceRail
from mujoco_ref.simulate import Setup, simulate
from tentacle.gait import Gait
from tentacle.model import Model

LEAD_IN_S, SETTLE_S, WINDOW_S, FPS = 1.0, 4.0, 16.0, 50.0


def reference_speed(model: Model, gait: Gait, rail: Rail | None = None) -> float:
    """Forward speed [m/s] of the MuJoCo reference under a gait, on the level rail of the affine trials."""
    rail = rail or PAPER_RAIL
    level = replace(model, gravity=replace(model.gravity, magnitude=0.0))
    carriage = ReferenceRail(rail.mass, viscous=rail.viscous, dry=rail.dry)
    run = simulate(level, gait, SETTLE_S + WINDOW_S, FPS, setup=Setup(rail=carriage, lead_in=LEAD_IN_S))
    start = round(SETTLE_S * FPS)
    # Forward is -y (affine_model.swim.trial).
    return -float((run.mount[-1, 1] - run.mount[start, 1]) / (run.t[-1] - run.t[start]))


def reference_thrust(model: Model, gait: Gait) -> float:
    """Mean forward thrust [N] of the MuJoCo reference under a gait, base clamped (eq. 17 averaged)."""
    run = simulate(model, gait, SETTLE_S + WINDOW_S, FPS, setup=Setup(lead_in=LEAD_IN_S))
    return -float(np.mean(run.thrust[round(SETTLE_S * FPS) :]))


def reference_gains(model: Model, gait: Gait, sine: Gait) -> dict[str, float]:
    """A gait beside a sine on the MuJoCo reference: speeds [m/s] on the rail, mean thrusts [N] clamped, both ratios."""
    speed, sine_speed = reference_speed(model, gait), reference_speed(model, sine)
    thrust, sine_thrust = reference_thrust(model, gait), reference_thrust(model, sine)
    return {
        "speed_m_s": speed,
        "sine_speed_m_s": sine_speed,
        "speed_gain": speed / sine_speed,
        "thrust_n": thrust,
        "sine_thrust_n": sine_thrust,
        "thrust_gain": thrust / sine_thrust,
    }

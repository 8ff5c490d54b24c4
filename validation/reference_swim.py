"""Gaits on the MuJoCo reference, to check an optimum of the reduced model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from affine_model.free_body import Hull
from affine_model.simulate import Rail
from affine_model.swim import PAPER_RAIL, SERVO_HULL
from affine_model.swim.free import HullCourse, forward_speed, yaw_drift
from mujoco_ref.mount import MountHull
from mujoco_ref.mount import MountRail as ReferenceRail
from mujoco_ref.simulate import Setup, simulate
from tentacle.gait import Gait
from tentacle.model import Model

LEAD_IN_S, SETTLE_S, WINDOW_S, FPS = 1.0, 4.0, 16.0, 50.0
FREE_SETTLE_S, FREE_WINDOW_S = 16.0, 12.0  # as the affine trial's finest (affine_model.swim.trial)


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


def reference_free(model: Model, gait: Gait, hull: Hull = SERVO_HULL) -> tuple[float, float]:
    """Speed along the mean heading [m/s] and yaw drift [rad/s] of the MuJoCo reference with a free hull, level."""
    level = replace(model, gravity=replace(model.gravity, magnitude=0.0))
    viscous = hull.viscous_across, hull.viscous_along, hull.yaw_viscous
    drag = hull.drag_across, hull.drag_along, hull.yaw_drag
    mount = MountHull(hull.mass, hull.yaw_inertia, viscous, drag)
    run = simulate(level, gait, FREE_SETTLE_S + FREE_WINDOW_S, FPS, setup=Setup(rail=mount, lead_in=LEAD_IN_S))
    course = HullCourse(run.mount[:, :, None], (run.theta - run.command)[:, None])
    settled = course.after(round(FREE_SETTLE_S * FPS))
    return float(forward_speed(settled, FREE_WINDOW_S)[0]), float(yaw_drift(settled, FREE_WINDOW_S)[0])


def reference_gains(model: Model, gait: Gait, sine: Gait, hull: Hull | None = None) -> dict[str, float]:
    """A gait beside a sine on the MuJoCo reference: speeds [m/s] on the rail, mean thrusts [N] clamped, both ratios;
    with a hull its free speeds too, and the gait's yaw drift [rad/s].
    """
    speed, sine_speed = reference_speed(model, gait), reference_speed(model, sine)
    thrust, sine_thrust = reference_thrust(model, gait), reference_thrust(model, sine)
    afloat: dict[str, float] = {}
    if hull is not None:
        (free, drift), (sine_free, _) = reference_free(model, gait, hull), reference_free(model, sine, hull)
        afloat = {"free_speed_m_s": free, "sine_free_speed_m_s": sine_free, "yaw_drift_rad_s": drift}
    return {
        "speed_m_s": speed,
        "sine_speed_m_s": sine_speed,
        "speed_gain": speed / sine_speed,
        "thrust_n": thrust,
        "sine_thrust_n": sine_thrust,
        "thrust_gain": thrust / sine_thrust,
        **afloat,
    }

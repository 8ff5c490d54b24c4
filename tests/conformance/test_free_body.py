"""A hull that floats freely, by the two models: path, yaw and torque of the servo under the same motion."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.advance import Drive, Pace, advance
from affine_model.arm import arm_of, parameter_vector
from affine_model.free_body import Hull
from affine_model.swim.free import hull_course, launched
from mujoco_ref.mount import MountHull, MountServo, base_record
from mujoco_ref.simulate import Initial, Setup, simulate
from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.specimen import Cone, Fluid, Gravity, Specimen
from tentacle.waveform import Ramped, Sine

HULL = Hull(0.3, 3.1e-4, 0.02, 0.01, 3.0, 1.0, 1e-5, 9.4e-5)
SECONDS, FPS, STEP = 4.0, 50, 1e-3
EFFECTS = {
    "elasticity": {"E": 1.5e5}, "damping": {"eta": 600.0}, "drag": {"C_perp": 1.1}, "added_mass": {"C_a": 1.0},
    "skin_drag": {"C_t": 0.05}, "current": {"U_x": 0.01, "U_y": -0.02},
}  # fmt: skip


def test_both_models_swim_the_same_path():
    parameters = {name: {k: Estimate.exact(v) for k, v in own.items()} for name, own in EFFECTS.items()}
    arm = Specimen(Cone(0.0125, 0.004), 0.21, 1070.0, tip_mass=2e-3)
    model = Model(arm, Fluid(998.0), Gravity(0.0, 0.0), 6, parameters)
    wave = Ramped(Sine(0.6, 1.3), duration=1.0)
    mount = MountHull(HULL.mass, HULL.yaw_inertia, (0.02, 0.01, 1e-5), (3.0, 1.0, 9.4e-5))
    straight = Initial(np.zeros(2))  # not bent by the current already
    setup = Setup(links=40, rail=mount, longest_step=STEP, initial=straight)
    chain = simulate(model, wave, SECONDS, FPS, setup=setup)
    drive, ready = Drive(hull=HULL), replace(arm_of(model), nodes=12)
    base = wave((np.arange(round(SECONDS / STEP)) + 0.5) * STEP)[:, :, None]
    start = np.zeros(1), launched(ready, drive, np.zeros((3, 1)))
    pace = Pace(STEP, round(1.0 / (FPS * STEP)), iterations=2)
    course = advance(ready, drive, parameter_vector(model)[:, None], base, start, pace)
    hull = hull_course(ready, course.u, wave(chain.t)[0][:, None])
    assert np.ptp(chain.mount[:, 1]) > 0.15  # m
    # From 40 to 80 links the chain's own path and yaw change by .04 mm and .08 mrad; the step of 1 ms leaves .25 mm of
    # path (.02 mm at half of it, with order 8). Measured here: .3 mm of 220 mm, .2 mrad.
    path = np.max(np.abs(hull.place[:, :, 0] - chain.mount))
    yaw = np.max(np.abs(hull.yaw[:, 0] - (chain.theta - chain.command)))
    assert path < 2e-3 * np.ptp(chain.mount[:, 1])
    assert yaw < 6e-4
    torque = course.force[:, 3, 0]  # means of the intervals between frames
    apart = 0.5 * (torque[1:] + torque[:-1]) - chain.torque[1:-1]
    assert np.max(np.abs(apart)) < 0.02 * np.max(np.abs(torque))


def test_a_hull_in_mujoco_takes_neither_torque_servo_nor_play():
    hull = MountHull(0.3, 3e-4)
    with pytest.raises(InputError, match="hull"):
        base_record({}, MountServo(1.0, 0.0, 1.0), hull, 0.05)
    with pytest.raises(InputError, match="hull"):
        base_record({"backlash": {"play": 0.01}}, None, hull, 0.05)
    with pytest.raises(InputError, match="yaw_inertia"):
        MountHull(0.3, 0.0)

"""The force arrows' data: both rooms' drag along a drawn arm, against closed forms and against their own dynamics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import arm_of, parameter_vector
from affine_model.drag_along import drag_along
from affine_model.run_forces import rest_load
from mujoco_ref.drag_along import chain_drag_along as reference_drag
from mujoco_ref.simulate import Setup, simulate
from tentacle.midline_motion import midline_motion
from tentacle.model import Estimate, Model
from tentacle.specimen import AIR, WATER, Cone, Gravity, Specimen
from tentacle.waveform import Sine

ARM = Specimen(Cone(0.0125, 0.003), 0.14, 1070.0)
MODEL = Model(ARM, WATER, parameters={
    "elasticity": {"E": Estimate.exact(2e5, "Pa")},
    "damping": {"eta": Estimate.exact(1e3, "Pa s")},
    "drag": {"C_perp": Estimate.exact(1.1)},
    "skin_drag": {"C_t": Estimate.exact(0.05)},
    "added_mass": {"C_a": Estimate.exact(1.0), "convective": Estimate.exact(0.5)},
    "oscillating_drag": {"share": Estimate.exact(1.0), "f": Estimate.exact(1.0, "Hz")},
    "current": {"U_x": Estimate.exact(0.03, "m/s"), "U_y": Estimate.exact(0.01, "m/s")},
})  # fmt: skip
S = np.linspace(0.0, 1.0, 41)


def stiff_swing(amplitude: float, frequency: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """t (T,), theta (T,) and the midline (T, 41, 2) of a straight arm that turns about the clamp."""
    t = np.arange(0.0, 1.0, 1 / 60)
    theta = amplitude * np.sin(2 * np.pi * frequency * t)
    direction = np.stack([-np.sin(theta), np.cos(theta)], axis=-1)
    return t, theta, ARM.length * S[:, None] * direction[:, None]


def test_a_turning_rod_moves_as_theta_says():
    t, theta, xy = stiff_swing(0.4, 2.0)
    motion = midline_motion(t, S, xy)
    rate = 0.4 * 2 * np.pi * 2.0 * np.cos(2 * np.pi * 2.0 * t)
    across = np.sum(motion.velocity * motion.normal, axis=-1)
    inside = slice(3, -3)  # a spline is less exact at its ends; elsewhere (2 pi f h)^4 / 180 = 1e-5
    np.testing.assert_allclose(across[inside], -rate[inside, None] * ARM.length * S, atol=1e-4)
    np.testing.assert_allclose(motion.angle, np.broadcast_to(theta[:, None], motion.angle.shape), atol=1e-6)


def test_drag_of_a_turning_rod_is_equation_15():
    t, theta, xy = stiff_swing(0.4, 1.0)
    still = replace(MODEL, parameters={name: MODEL.parameters[name] for name in ("elasticity", "damping", "drag")})
    force = drag_along(arm_of(still), parameter_vector(still), t, S, xy)
    u_n = -0.4 * 2 * np.pi * np.cos(2 * np.pi * t)[:, None] * ARM.length * S
    expected = -0.5 * WATER.density * 1.1 * ARM.section.width(S) * np.abs(u_n) * u_n
    normal = np.stack([np.cos(theta), np.sin(theta)], axis=-1)[:, None]
    inside = slice(3, -3)
    tolerance = 1e-3 * np.abs(expected).max()  # of the splined velocity
    np.testing.assert_allclose(force[inside], (expected[..., None] * normal)[inside], atol=tolerance)


def test_both_rooms_agree_on_the_same_motion_and_with_the_references_own_thrust():
    run = simulate(MODEL, Sine(0.4, 1.0), 2.0, 60.0, setup=Setup(s=S))
    one = drag_along(arm_of(MODEL), parameter_vector(MODEL), run.t, S, run.midline.xy)
    other = reference_drag(MODEL, run.t, S, run.midline.xy)
    np.testing.assert_allclose(one, other, atol=1e-9)  # the affine law smooths |u| by 1e-8 m/s
    # The simulation sums the drag at its Gauss points; here the trapezium rule over 41 points and a splined velocity.
    thrust = ARM.length * np.trapezoid(other[..., 1], S, axis=1)
    inside = slice(4, -4)
    apart = np.sqrt(np.mean((thrust - run.thrust)[inside] ** 2))
    assert apart < 0.02 * np.sqrt(np.mean(run.thrust[inside] ** 2))


def test_a_missing_instant_has_no_arrow():
    t, _, xy = stiff_swing(0.4, 1.0)
    xy[10] = np.nan
    force = drag_along(arm_of(MODEL), parameter_vector(MODEL), t, S, xy)
    assert np.isnan(force[10]).all()
    assert np.isfinite(np.delete(force, 10, axis=0)).all()


@pytest.mark.parametrize(("fluid", "density"), [(WATER, 1070.0 - WATER.density), (AIR, 1070.0)])
def test_a_load_cell_at_rest_carries_weight_less_buoyancy(fluid, density):
    plain = Model(ARM, fluid, Gravity(), parameters={"elasticity": MODEL.parameters["elasticity"]})
    volume = ARM.mass / ARM.density
    assert rest_load(plain) == pytest.approx(volume * density * 9.80665, rel=1e-6)

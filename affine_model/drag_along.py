"""The water's drag along an arm with a prescribed motion: the force laws of the fluid, evaluated at the sections."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array
from affine_model.dynamics import parameters_of
from tentacle.midline_motion import midline_motion


def drag_along(arm: Arm, parameters: Array, t: Array, s: Array, xy: Array) -> Array:
    """Drag per length (T, P, 2) [N/m] in the base frame, of a midline xy (T, P, 2) [m] at t (T,) [s] and s (P,).

    parameters (R,) as in arm.parameter_vector. It is the sum of the `force` laws (eq. 15 and the other drag laws) at
    the velocity relative to the moving water, without the reaction of added mass. NaN where the motion is NaN.
    """
    motion = midline_motion(t, s, xy)
    section = arm.specimen.section
    x = SimpleNamespace(
        **arm.arm_quantities, t=t[:, None], s=s, area=section.area(s), second_moment=section.second_moment(s),
        width=section.width(s), perimeter=section.perimeter(s), phi=motion.angle, x=xy[..., 0], y=xy[..., 1],
    )  # fmt: skip
    own = [(effect, parameters_of(effect, parameters)) for effect in active_effects(parameters)]
    coefficients = (effect.drag_coefficient(x, p) for effect, p in own if effect.drag_coefficient is not None)
    x.drag_coefficient = sum(coefficients, 0.0)
    water = np.zeros(xy.shape)
    for effect, p in own:
        if effect.water_velocity is not None:
            water += np.stack(np.broadcast_arrays(*effect.water_velocity(x, p), x.phi)[:2], axis=-1)
    relative = motion.velocity - water
    x.u_n, x.u_t = np.sum(relative * motion.normal, axis=-1), np.sum(relative * motion.tangent, axis=-1)
    x.speed = np.hypot(x.u_n, x.u_t)
    force = np.zeros(xy.shape)
    for effect, p in own:
        if effect.force is not None and effect.couple is None:  # with a couple it is a part of added mass
            along_normal, along_tangent = (np.asarray(part)[..., None] for part in effect.force(x, p))
            force = force + along_normal * motion.normal + along_tangent * motion.tangent
    return force

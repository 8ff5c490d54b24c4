"""The reference's drag along a prescribed midline, for pictures."""

from __future__ import annotations

import numpy as np

from mujoco_ref.influence import Fields, water_record
from mujoco_ref.section_water import beside_wall, felt_speed, shed_lift, viscous_resistance, water_motion
from mujoco_ref.simulate import plain_parameters
from tentacle.compiled import njit
from tentacle.midline_motion import midline_motion
from tentacle.model import Model
from tentacle.signals import Array


def chain_drag_along(model: Model, t: Array, s: Array, xy: Array) -> Array:
    """Drag per length (T, P, 2) [N/m] in the base frame, of a midline xy (T, P, 2) [m] at t (T,) [s] and s (P,).

    Relative to the water of the model's effects; added mass and buoyancy are left out. NaN where the motion is.
    """
    motion = midline_motion(t, s, xy)
    section = model.specimen.section
    water = water_record(plain_parameters(model), model.fluid.density, model.specimen.length, (0.0, 0.0))
    sizes = section.width(s), section.perimeter(s)
    return _drag(t, xy, motion.velocity, motion.normal, sizes, water[0])


@njit(cache=True)
def _drag(t: Array, xy: Array, velocity: Array, normal: Array, section: tuple[Array, Array], water: Fields) -> Array:
    """The resistances of water.water_forces, point by point; section: width and perimeter (P,) [m]."""
    width, perimeter = section
    force = np.empty_like(xy)
    for k in range(xy.shape[0]):
        for i in range(xy.shape[1]):
            x, y = xy[k, i]
            c, s = normal[k, i]
            wx, wy, _, _ = water_motion(x, y, t[k], water)
            ux, uy = velocity[k, i, 0] - wx, velocity[k, i, 1] - wy
            u_n, u_t = ux * c + uy * s, -ux * s + uy * c
            speed = np.sqrt(u_n * u_n + u_t * u_t)
            C_perp, wall_n, wall_t = water.C_perp, 0.0, 0.0
            if water.wall_B != 0.0:
                more, _, wall_n, wall_t = beside_wall(x, 0.5 * width[i], (c, s), (u_n, u_t), water)
                C_perp += more
            felt = felt_speed(speed, u_n, width[i], C_perp, water)
            slow = water.c_n + viscous_resistance(width[i], water)
            f_n = wall_n - (0.5 * water.density * C_perp * width[i] * felt + slow) * u_n
            if water.lift_cos != 0.0 or water.lift_sin != 0.0:
                f_n += shed_lift(width[i], t[k], water)
            f_t = wall_t - (0.5 * water.density * water.C_t * perimeter[i] * speed + 0.5 * water.c_n) * u_t
            force[k, i, 0], force[k, i, 1] = f_n * c - f_t * s, f_n * s + f_t * c
    return force

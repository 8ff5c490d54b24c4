"""The water around one section (compiled): its own motion, and the forces per length of drag, a wall and vortices."""

from __future__ import annotations

import numpy as np

from mujoco_ref.influence import Fields
from tentacle.compiled import njit

WATERS_VISCOSITY = 1e-6  # m^2/s, at 20 degrees C
SECOND_WAVE = 1.7320508075688772  # of a deep tank's odd standing waves: frequency over the first's, sqrt(3)


@njit(cache=True)
def water_motion(x: float, y: float, t: float, water: Fields) -> tuple[float, float, float, float]:
    """Velocity and acceleration of the undisturbed water at (x, y): current, sloshing, and the flow into a suction
    port.
    """
    omega = 2.0 * np.pi * water.slosh_f
    cos, sin = np.cos(omega * t), np.sin(omega * t)
    ux = water.U_x + water.U_cos * cos + water.U_sin * sin
    ax = omega * (water.U_sin * cos - water.U_cos * sin)
    if water.V_cos != 0.0 or water.V_sin != 0.0:
        faster = SECOND_WAVE * omega
        cos, sin = np.cos(faster * t), np.sin(faster * t)
        ux += water.V_cos * cos + water.V_sin * sin
        ax += faster * (water.V_sin * cos - water.V_cos * sin)
    if water.suction_U != 0.0:
        beat = 2.0 * np.pi * water.suction_f
        near = water.suction_U * np.exp(-(x * x + y * y) / water.suction_reach**2)
        ux += near * max(0.0, np.sin(beat * t)) ** 2
        ax += near * 2.0 * max(0.0, np.sin(beat * t)) * beat * np.cos(beat * t)
    return ux, water.U_y, ax, 0.0


@njit(cache=True)
def beside_wall(
    x: float, half_width: float, direction: tuple[float, float], speed: tuple[float, float], water: Fields
) -> tuple[float, float, float, float]:
    """What a wall at wall_x adds: drag coefficient, inertia along the normal [kg/m], force along n and t [N/m].

    direction: cosine and sine of the section's angle; speed: along its normal and tangent [m/s]. The forces follow from
    an added mass that grows towards the wall: they draw the body to the wall and slow it.
    """
    cosine, sine = direction
    u_n, u_t = speed
    squared = half_width * half_width
    distance = water.wall_x - x
    diameters = (np.sqrt(distance * distance + squared) - half_width) / (2.0 * half_width)
    coefficient = water.wall_B * water.C_perp / (2.0 + 10.0 * diameters)
    near = distance * distance + 0.25 * squared
    inertia = water.wall_carried * water.wall_B * 0.5 * np.pi * water.density * squared * squared / near
    growth = 2.0 * distance * inertia / near
    approach = u_n * cosine - u_t * sine
    push_n = growth * u_n * (0.5 * u_n * cosine - approach)
    return coefficient, inertia, push_n, -0.5 * growth * u_n * u_n * sine


@njit(cache=True)
def felt_speed(speed: float, u_n: float, width: float, coefficient: float, water: Fields) -> float:
    """The speed that multiplies u_n in the normal drag: |u| (eq. 15) or |u_n| (cross-flow), times the growth of a
    smooth cylinder's coefficient at small Reynolds numbers. A wall's additional drag follows eq. 15.
    """
    if coefficient == 0.0 or (water.cross_flow == 0.0 and water.reynolds == 0.0):
        return speed
    own = water.C_perp / coefficient
    slow = 10.0 / (speed * width / WATERS_VISCOSITY + 1e-3) ** (2.0 / 3.0)
    return speed + own * (water.reynolds * slow * speed - water.cross_flow * (speed - abs(u_n)))


@njit(cache=True)
def viscous_resistance(width: float, water: Fields) -> float:
    """Force per length and speed [Pa s] of the attached, laminar flow round a cylinder that oscillates (Stokes)."""
    if water.oscillating == 0.0:
        return 0.0
    depths = max(width * np.sqrt(np.pi * water.oscillating_f / WATERS_VISCOSITY), 1.0)
    viscosity = water.density * WATERS_VISCOSITY
    return water.oscillating * 2.0 * np.pi * viscosity * (depths + 1.0 - 0.25 / depths)


@njit(cache=True)
def shed_lift(width: float, t: float, water: Fields) -> float:
    """Lift per length [N/m] of vortices that a stream across the plane sheds, Strouhal number 0.2."""
    phase = 2.0 * np.pi * 0.2 * water.stream / width * t
    return (
        0.5
        * water.density
        * width
        * water.stream**2
        * (water.lift_cos * np.cos(phase) + water.lift_sin * np.sin(phase))
    )

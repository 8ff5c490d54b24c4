"""Forces at the base: the servo or the coupling that turns theta, an elastic stand, a rail with friction, a floating
hull (compiled).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mujoco_ref.chain import Mount
from mujoco_ref.hinges import bristle
from mujoco_ref.influence import BASE_RECORD, Fields, Parameters, Record, make_record, value
from mujoco_ref.motor import sprung
from mujoco_ref.section_water import water_motion
from mujoco_ref.step_arguments import Equation, Laws, Midpoint, Now
from tentacle.compiled import njit
from tentacle.errors import InputError
from tentacle.signals import Array

# The base's memory: stretch of the slipping coupling, of the hub's friction, integral of the servo's error, rail.
COUPLING, HUB, INTEGRAL, RAIL = range(4)
HUB_STRETCH = 2e-4  # [rad] at which the hub's friction yields
RAIL_STRETCH = 1e-5  # [m] at which the rail's friction yields


@dataclass(frozen=True)
class MountServo:
    """PID servo: stiffness [N m/rad], damping [N m s/rad], torque_limit [N m], integral [N m/(rad s)]; rotor [kg m^2]
    at the horn."""

    stiffness: float
    damping: float
    torque_limit: float
    integral: float = 0.0
    rotor_inertia: float = 1e-5

    def __post_init__(self) -> None:
        for name in ("stiffness", "torque_limit", "rotor_inertia"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"{getattr(self, name)!r} is not usable", field=name, expected="a positive number")


@dataclass(frozen=True)
class MountRail:
    """A carriage that slides along y: its mass [kg], viscous friction [N s/m], dry friction [N]."""

    mass: float
    viscous: float = 0.0
    dry: float = 0.0

    def __post_init__(self) -> None:
        if not self.mass > 0.0:
            raise InputError(f"{self.mass!r} is not usable", field="rail mass", expected="a positive number")


@dataclass(frozen=True)
class MountHull:
    """A hull that floats, with the motor in it: mass [kg], yaw inertia [kg m^2] about the motor's axis; drag across,
    along and against yaw, linear [N s/m, N m s] and quadratic [N s^2/m^2, N m s^2].
    """

    mass: float
    yaw_inertia: float
    viscous: tuple[float, float, float] = (0.0, 0.0, 0.0)
    drag: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("mass", "yaw_inertia"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"{getattr(self, name)!r} is not usable", field=f"hull {name}", expected="positive")

    @property
    def fields(self) -> dict[str, float]:
        """Its fields of the base's record."""
        named = {"hull": 1.0, "hull_inertia": self.yaw_inertia, "free_x": 1.0, "free_y": 1.0, "free_theta": 1.0}
        for kind, numbers in (("viscous", self.viscous), ("drag", self.drag)):
            named |= {f"hull_{kind}_{way}": one for way, one in zip(("n", "t", "yaw"), numbers, strict=True)}
        return named


def base_record(
    parameters: Parameters, servo: MountServo | None, rail: MountRail | MountHull | None, arm_mass: float
) -> tuple[Record, Mount]:
    """The base's mechanics, with the mass and inertia that move with it. Without servo, rail, hull or an influence it
    is rigid.
    """
    if isinstance(rail, MountHull):
        if servo is not None or {"backlash", "clamp_slip", "mount_resonance"} & set(parameters):
            raise InputError("cannot act with a hull", field="mount", expected="a motor that turns as prescribed")
        return make_record(BASE_RECORD, **rail.fields), Mount(rail.mass, rail.yaw_inertia)
    fields: dict[str, float] = {}
    mass, inertia = 1e-3, 1e-6
    if servo is not None:
        fields |= {"free_theta": 1.0, "servo": 1.0, "servo_p": servo.stiffness, "servo_i": servo.integral}
        fields |= {"servo_d": servo.damping, "servo_limit": servo.torque_limit}
        inertia = servo.rotor_inertia
    if rail is not None:
        fields |= {"free_y": 1.0, "rail_friction": rail.dry, "rail_damping": rail.viscous}
        mass = rail.mass
    play = 0.0 if sprung(parameters) else value(parameters, "backlash", "play")
    slip = value(parameters, "clamp_slip", "moment")
    if (play > 0.0 or slip > 0.0) and servo is None:
        # A horn that is stiff against the arm (1 mrad per 20 mN m); the seal's friction holds the hub inside the play.
        fields |= {"free_theta": 1.0, "coupling": 20.0, "coupling_damping": 0.02, "play": play, "slip_moment": slip}
        fields |= {"hub_friction": 4e-3 if play > 0.0 else 0.0}
        inertia = 2e-5
    elif play > 0.0 or slip > 0.0:
        raise InputError("cannot act with a torque servo", field="backlash/clamp_slip", expected="a prescribed base")
    if "mount_resonance" in parameters:
        mass = value(parameters, "mount_resonance", "mass", 0.3)
        omega = 6.283185307179586 * value(parameters, "mount_resonance", "f", 3.0)
        moving = mass + arm_mass
        ratio = value(parameters, "mount_resonance", "damping_ratio", 0.05)
        fields |= {"free_x": 1.0, "spring_x": moving * omega**2, "damper_x": 2.0 * ratio * omega * moving}
    return make_record(BASE_RECORD, **fields), Mount(mass=mass, hub_inertia=inertia)


@njit(cache=True)
def base_forces(course: Midpoint, motor: Array, base: Fields, memory: Array, step: float, equation: Equation) -> float:
    """Add the forces on the free coordinates of the mount at the middle of a step; returns the motor's torque [N m].

    motor (3, 3): the motor's angle, rate, acceleration at the start, middle and end of the step.
    """
    start, middle, rate = course.start, course.middle, course.rate
    force, matrix = equation.force, equation.matrix
    half = 0.5 * step
    torque = 0.0
    if base.free_x != 0.0:
        force[0] -= base.spring_x * middle[0] + base.damper_x * rate[0]
        matrix[0, 0] += half * base.damper_x + half * half * base.spring_x
    if base.free_y != 0.0:
        force[1] -= base.rail_damping * rate[1]
        matrix[1, 1] += half * base.rail_damping
        if base.rail_friction > 0.0:
            stretch, sticks = bristle(memory[RAIL] + middle[1] - start[1], RAIL_STRETCH)
            force[1] -= base.rail_friction * stretch / RAIL_STRETCH
            matrix[1, 1] += half * half * sticks * base.rail_friction / RAIL_STRETCH
    if base.free_theta == 0.0 or base.hull != 0.0:
        return 0.0
    twist, twist_rate = motor[1, 0] - middle[2], motor[1, 1] - rate[2]
    slope, damping = 0.0, 0.0
    if base.servo != 0.0:
        torque = base.servo_p * twist + base.servo_d * twist_rate + base.servo_i * (memory[INTEGRAL] + half * twist)
        slope, damping = base.servo_p, base.servo_d
        if abs(torque) > base.servo_limit:
            torque = base.servo_limit if torque > 0.0 else -base.servo_limit
            slope, damping = 0.0, 0.0
    elif base.slip_moment > 0.0:
        stretched = memory[COUPLING] + twist - (motor[0, 0] - start[2])
        stretch, sticks = bristle(stretched, base.slip_moment / base.coupling)
        slope, damping = sticks * base.coupling, sticks * base.coupling_damping
        torque = base.coupling * stretch + damping * twist_rate
    else:
        inside, within = bristle(twist, 0.5 * base.play)
        slope, damping = (1.0 - within) * base.coupling, (1.0 - within) * base.coupling_damping
        torque = base.coupling * (twist - inside) + damping * twist_rate
    force[2] += torque
    matrix[2, 2] += half * damping + half * half * slope
    if base.hub_friction > 0.0:
        stretch, sticks = bristle(memory[HUB] + middle[2] - start[2], HUB_STRETCH)
        force[2] -= base.hub_friction * stretch / HUB_STRETCH
        matrix[2, 2] += half * half * sticks * base.hub_friction / HUB_STRETCH
    return torque


@njit(cache=True)
def hull_forces(course: Midpoint, motor: Array, laws: Laws, now: Now, acceleration: float, equation: Equation) -> float:
    """Add a hull's drag, and what the motor's own acceleration gives to theta; returns the motor's torque [N m].

    The hull's yaw is theta less the motor's angle. MuJoCo carries its yaw inertia J with the first link, so J theta''
    is in the equation and J delta'' stands here. acceleration: that of theta, as predicted.
    """
    base, water = laws.base[0], laws.water[0]
    middle, rate, force, matrix, half = course.middle, course.rate, equation.force, equation.matrix, 0.5 * now.step
    yaw, turning = middle[2] - motor[1, 0], rate[2] - motor[1, 1]
    c, s = np.cos(yaw), np.sin(yaw)
    wx, wy, _, _ = water_motion(middle[0], middle[1], now.t, water)
    ux, uy = rate[0] - wx, rate[1] - wy
    u_n, u_t = ux * c + uy * s, uy * c - ux * s
    f_n = (base.hull_viscous_n + base.hull_drag_n * abs(u_n)) * u_n
    f_t = (base.hull_viscous_t + base.hull_drag_t * abs(u_t)) * u_t
    against = (base.hull_viscous_yaw + base.hull_drag_yaw * abs(turning)) * turning
    force[0] -= f_n * c - f_t * s
    force[1] -= f_n * s + f_t * c
    force[2] += base.hull_inertia * motor[1, 2] - against
    slope_n = half * (base.hull_viscous_n + 2.0 * base.hull_drag_n * abs(u_n))
    slope_t = half * (base.hull_viscous_t + 2.0 * base.hull_drag_t * abs(u_t))
    matrix[0, 0] += slope_n * c * c + slope_t * s * s
    matrix[1, 1] += slope_n * s * s + slope_t * c * c
    matrix[0, 1] += (slope_n - slope_t) * c * s
    matrix[1, 0] += (slope_n - slope_t) * c * s
    matrix[2, 2] += half * (base.hull_viscous_yaw + 2.0 * base.hull_drag_yaw * abs(turning))
    return -base.hull_inertia * (acceleration - motor[1, 2]) - against


@njit(cache=True)
def base_remember(
    ends: tuple[Array, Array], motor: Array, torque: float, base: Fields, memory: Array, step: float
) -> None:
    """Carry the base's memory (4,) over a step; ends: positions (n + 3,) at its start and end, motor as above."""
    start, end = ends
    motor_start, motor_end = motor[0, 0], motor[2, 0]
    if base.rail_friction > 0.0:
        memory[RAIL], _ = bristle(memory[RAIL] + end[1] - start[1], RAIL_STRETCH)
    if base.hub_friction > 0.0:
        memory[HUB], _ = bristle(memory[HUB] + end[2] - start[2], HUB_STRETCH)
    if base.slip_moment > 0.0:
        change = (motor_end - end[2]) - (motor_start - start[2])
        memory[COUPLING], _ = bristle(memory[COUPLING] + change, base.slip_moment / base.coupling)
    if base.servo != 0.0 and abs(torque) < base.servo_limit:  # no wind-up while the torque is cut
        memory[INTEGRAL] += 0.5 * step * ((motor_start - start[2]) + (motor_end - end[2]))

"""All influences on the chain as numbers, in records that the compiled kernels read. A field that is zero has no
effect.

The parameters of the catalogue's effects keep their names and units (docs/catalogue.md); each is turned here into the
quantities of this room's own physics. Influences outside the catalogue have fields of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.law.in_use import laws_in_use

Record = NDArray[np.void]
Fields = Any  # one record, or a row of them, inside compiled code: its fields are attributes there
Parameters = Mapping[str, Mapping[str, float]]

_F = np.float64
WATER_RECORD = np.dtype(
    [
        ("density", _F),  # [kg/m^3]
        ("C_perp", _F),  # normal drag coefficient on the width, eq. 15
        ("C_t", _F),  # skin friction coefficient on the wetted perimeter
        ("C_a", _F),  # added mass over the water in a circle of the width
        ("tangential", _F),  # added mass along the tangent, over that along the normal
        ("convective", _F),  # share of Kirchhoff's convective terms; 0: Morison's normal acceleration alone
        ("c_n", _F),  # linear drag along the normal [Pa s]; half of it along the tangent
        ("U_x", _F),  # steady current [m/s]
        ("U_y", _F),
        ("U_cos", _F),  # swaying water along x [m/s] at slosh_f [Hz]
        ("U_sin", _F),
        ("slosh_f", _F),
        ("V_cos", _F),  # the second standing wave, of sqrt(3) times the first's frequency
        ("V_sin", _F),
        ("wall_B", _F),  # the wall's strength, over the published one of a smooth cylinder
        ("wall_x", _F),  # where the wall stands [m]
        ("wall_carried", _F),  # share of the published added mass that acts
        ("suction_U", _F),  # a port at the clamp draws water along x: velocity [m/s], frequency [Hz], reach [m]
        ("suction_f", _F),
        ("suction_reach", _F),
        ("cross_flow", _F),  # 1: the drag follows |u_n| u_n, 0: |u| u_n
        ("reynolds", _F),  # share of 10 Re^(-2/3) by which C_perp grows
        ("oscillating", _F),  # share of an oscillating cylinder's viscous drag, at a frequency [Hz]
        ("oscillating_f", _F),
        ("shed", _F),  # extent of the tip's edge, from which the carried water leaves the arm [m]
        ("lift_cos", _F),  # lift of vortices shed by a stream across the plane [m/s]
        ("lift_sin", _F),
        ("stream", _F),
        ("vortex_C_L", _F),  # side force of vortices shed at vortex_f [Hz], on 1/2 rho w speed^2
        ("vortex_f", _F),
        ("gravity_x", _F),  # [m/s^2], for the buoyancy
        ("gravity_y", _F),
    ]
)
TIP = np.dtype(
    [
        ("thread_x", _F),  # a thread from the tip to (x, y) [m]: pulls beyond its slack length [m], stiffness [N/m]
        ("thread_y", _F),
        ("thread_slack", _F),
        ("thread_stiffness", _F),
        ("magnet_x", _F),  # a magnet at (x, y) [m] draws the tip with strength / r^2 [N m^2]
        ("magnet_y", _F),
        ("magnet_strength", _F),
    ]
)
HINGE = np.dtype(
    [
        ("stiffness", _F),  # [N m/rad of hinge angle]
        ("damping", _F),  # [N m s/rad]
        ("rest", _F),  # hinge angle at rest [rad]
        ("cubic", _F),  # beta n^2: relative change of stiffness per squared hinge angle [1/rad^2]
        ("yield_moment", _F),  # dry friction [N m]
        ("yield_angle", _F),  # hinge angle at which it yields [rad]
        ("maxwell", _F),  # stiffness of the Maxwell branch [N m/rad]
        ("sliding_moment", _F),  # dry friction that depends on the rate alone [N m]
        ("sliding_rate", _F),  # rate of the hinge angle at which it is 3/4 of that [rad/s]
        ("relaxation", _F),  # its relaxation time [s]
        ("bent_loss", _F),  # damping over stiffness, per squared hinge angle [s/rad^2]
    ]
)
BASE_RECORD = np.dtype(
    [
        ("free_x", _F),  # 1: the mount moves along x on a spring [N/m] and damper [N s/m]
        ("spring_x", _F),
        ("damper_x", _F),
        ("free_y", _F),  # 1: the mount slides along y on a rail
        ("rail_friction", _F),  # [N], dry
        ("rail_damping", _F),  # [N s/m]
        ("free_theta", _F),  # 1: theta is moved by a torque
        ("coupling", _F),  # torsion spring between motor and clamp [N m/rad] and damper [N m s/rad]
        ("coupling_damping", _F),
        ("play", _F),  # total play of the coupling [rad]
        ("slip_moment", _F),  # moment at which the coupling slips [N m]; 0: never
        ("hub_friction", _F),  # dry friction of the clamp against the mount [N m]
        ("servo", _F),  # 1: theta is moved by a PID servo of gains [N m/rad, N m/(rad s), N m s/rad] and limit [N m]
        ("servo_p", _F),
        ("servo_i", _F),
        ("servo_d", _F),
        ("servo_limit", _F),
        ("hull", _F),  # 1: the mount is a hull that floats; its yaw inertia [kg m^2], drag linear and quadratic
        ("hull_inertia", _F),
        ("hull_viscous_n", _F),  # [N s/m], across; t: along
        ("hull_viscous_t", _F),
        ("hull_drag_n", _F),  # [N s^2/m^2]
        ("hull_drag_t", _F),
        ("hull_viscous_yaw", _F),  # [N m s]
        ("hull_drag_yaw", _F),  # [N m s^2]
    ]
)


def make_record(dtype: np.dtype, **values: float) -> Record:
    """One record (1,) of that type, zero but for the values given."""
    made = np.zeros(1, dtype)
    for name, value in values.items():
        made[name] = value
    return made


# Effects that act on the water, the hinges or the weight: their parameters as the catalogue names them.
KNOWN: dict[str, tuple[str, ...]] = {
    "elasticity": ("E", "k0", "k1"),
    "damping": ("eta", "d0", "d1"),
    "drag": ("C_perp",),
    "inertia": (),
    "weight": (),
    "third_curvature": (),
    "added_mass": ("C_a", "tangential", "convective"),
    "skin_drag": ("C_t",),
    "linear_drag": ("c_n",),
    "current": ("U_x", "U_y"),
    "sloshing": ("U_cos", "U_sin", "V_cos", "V_sin", "f"),
    "wall": ("B", "distance", "carried"),
    "cross_flow": ("share",),
    "reynolds_drag": ("share",),
    "oscillating_drag": ("share", "f"),
    "shed_tip": ("span",),
    "vortex_lift": ("C_cos", "C_sin", "U"),
    "buoyancy": ("density_error",),
    "gravity_tilt": ("tilt",),
    "tip_mass": ("mass", "reach", "drop"),
    "payload_place": ("along", "aside"),
    "cubic_stiffness": ("beta",),
    "intrinsic_curvature": ("c0", "slope"),
    "viscoelasticity": ("g", "tau"),
    "amplitude_damping": ("b",),
    "dry_friction": ("c_f", "slip", "sliding", "rate"),
    "soft_spot": ("depth", "s0"),
    "stiffness_drift": ("rate", "settling"),
    "servo_lag": ("tau", "period"),
    "backlash": ("play", "delay", "period"),
    "time_offset": ("offset", "drift"),
    "camera_roll": ("roll", "centre"),
    "camera_scale": ("excess",),
    # Not in the catalogue, so that "unknown" can be tested:
    "thread": ("stiffness", "slack", "anchor_x", "anchor_y"),
    "clamp_slip": ("moment",),
    "suction": ("U", "f", "reach"),
    "mount_resonance": ("mass", "f", "damping_ratio"),
    "vortex": ("C_L", "f"),
    "magnet": ("strength", "x", "y"),
}
UNCATALOGUED = ("thread", "clamp_slip", "suction", "mount_resonance", "vortex", "magnet")


def refuse_unknown(parameters: Parameters) -> None:
    """InputError where an effect or one of its parameters is not known here, or a value is not finite."""
    all_known = KNOWN | {law.name: tuple(p.name for p in law.parameters) for law in laws_in_use()}
    for effect, values in parameters.items():
        if effect not in all_known:
            raise InputError("no such effect", field=effect, expected=f"one of {', '.join(all_known)}")
        for name, given in values.items():
            if name not in all_known[effect]:
                expected = f"one of {', '.join(all_known[effect]) or '(it has no parameters)'}"
                raise InputError("no such parameter", field=f"{effect}.{name}", expected=expected)
            if not np.isfinite(given):
                raise InputError(f"{given!r} is not usable", field=f"{effect}.{name}", expected="a finite number")


def value(parameters: Parameters, effect: str, name: str, default: float = 0.0) -> float:
    """One parameter's value; the default where the effect or the parameter is absent."""
    return float(parameters.get(effect, {}).get(name, default))


def water_record(parameters: Parameters, density: float, length: float, gravity: tuple[float, float]) -> Record:
    """The water around the arm of that length [m]; the catalogue gives the wall's distance in arm lengths."""

    def take(effect: str, name: str, default: float = 0.0) -> float:
        return value(parameters, effect, name, default)

    return make_record(
        WATER_RECORD,
        density=density,
        C_perp=take("drag", "C_perp"),
        C_t=take("skin_drag", "C_t"),
        C_a=take("added_mass", "C_a"),
        tangential=take("added_mass", "tangential"),
        convective=take("added_mass", "convective", 1.0),
        c_n=take("linear_drag", "c_n"),
        U_x=take("current", "U_x"),
        U_y=take("current", "U_y"),
        U_cos=take("sloshing", "U_cos"),
        U_sin=take("sloshing", "U_sin"),
        slosh_f=take("sloshing", "f", 1.2),
        V_cos=take("sloshing", "V_cos"),
        V_sin=take("sloshing", "V_sin"),
        wall_B=take("wall", "B"),
        wall_x=length * take("wall", "distance", 0.6),
        wall_carried=take("wall", "carried", 1.0),
        suction_U=take("suction", "U"),
        suction_f=take("suction", "f", 0.5),
        suction_reach=take("suction", "reach", 0.3 * length),
        cross_flow=take("cross_flow", "share"),
        reynolds=take("reynolds_drag", "share"),
        oscillating=take("oscillating_drag", "share"),
        oscillating_f=take("oscillating_drag", "f", 1.0),
        shed=take("shed_tip", "span"),
        lift_cos=take("vortex_lift", "C_cos"),
        lift_sin=take("vortex_lift", "C_sin"),
        stream=take("vortex_lift", "U", 0.1),
        vortex_C_L=take("vortex", "C_L"),
        vortex_f=take("vortex", "f", 1.5),
        gravity_x=gravity[0],
        gravity_y=gravity[1],
    )


def tip_record(parameters: Parameters, length: float) -> Record:
    """What pulls at the tip. Default places are beside the hanging arm."""

    def take(effect: str, name: str, default: float = 0.0) -> float:
        return value(parameters, effect, name, default)

    return make_record(
        TIP,
        thread_x=take("thread", "anchor_x", -0.5 * length),
        thread_y=take("thread", "anchor_y", length),
        thread_slack=take("thread", "slack", 0.55 * length),
        thread_stiffness=take("thread", "stiffness"),
        magnet_x=take("magnet", "x", 0.4 * length),
        magnet_y=take("magnet", "y", 1.1 * length),
        magnet_strength=take("magnet", "strength"),
    )

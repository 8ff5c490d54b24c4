"""An identified arm as an MJCF file: the hinge chain of the reference, complete in itself, for MuJoCo alone.

MuJoCo's own means represent these: joint stiffness (a cubic law too), damping, curvature at rest, weight, buoyancy
(gravcomp), a payload, a steady current (wind) and drag (ellipsoid fluid model). Added mass is put into the links' mass,
the same along every direction, with gravcomp rescaled so that the weight stays. The exact forces are in arm_forces.py,
which removes these substitutes (mujoco_ref.export.arm_forces). A clamp that gives is hinge_1, behind link_0, a hub
without length.

Drag: MuJoCo's is rho |u| (C_blunt A_proj + C_slender (A_max - A_proj)) u for an ellipsoid, so links as round as the arm
bring end area and do not converge with their number. The fluid geoms are plates instead, thin along the normal: half
width b = 2 r/pi and half length h give A_proj = pi b h = 2 r h across the flow, C_blunt = C_perp is eq. 15, and
Kutta's lift with the same coefficient turns the force from the velocity's direction to the normal.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mujoco_ref.chain import SMALLEST_INERTIA, SMALLEST_MASS, Chain
from mujoco_ref.engine import mujoco
from mujoco_ref.export.arm_forces import NAME_PREFIX, WATER
from mujoco_ref.export.carried import Carried, carried_by
from mujoco_ref.simulate import make_stepper
from mujoco_ref.step import Stepper
from mujoco_ref.water import (
    ALONG,
    AREA,
    CARRIED,
    CARRIED_CENTRE,
    CARRIED_TURNING,
    PERIMETER,
    SPHERE,
    WEIGHT,
    WIDTH,
)  # fmt: skip
from tentacle.model import Model
from tentacle.signals import Array

EXPORT_STEP = (
    5e-4  # s; the tip moves by less than 1e-3 of its swing where it is halved (tests/mujoco_ref/test_export.py)
)
THINNESS = 0.02  # of a plate's half thickness over its half width
# A flywheel at the clamp and a spring and damper to the command: the arm's torque turns it by less than a microradian.
FLYWHEEL, HOLD = 1.0, 200.0  # kg m^2, rad/s
HINGE_FIELDS = ("stiffness", "damping", "cubic", "rest", "maxwell", "relaxation", "yield_moment", "yield_angle",
                "sliding_moment", "sliding_rate", "bent_loss")  # fmt: skip
BODIES = ("payload", "hung")  # of the reference's chain, at the tip


@dataclass(frozen=True)
class Mjcf:
    """The text of arm.xml, and which effects it and arm_forces.py carry."""

    xml: str
    carried: Carried


def export_mjcf(model: Model, links: int = 20) -> Mjcf:
    """The arm of a model as MJCF with `links` hinges, and one more for a clamp that gives. InputError where the
    reference refuses the model.
    """
    carried = carried_by(model)
    stepper = make_stepper(carried.kept, links=links)
    spec = _spec(stepper)
    _add_numbers(spec, stepper)
    spec.compile()
    return Mjcf(_headed(spec.to_xml(), carried), carried)


def _spec(stepper: Stepper) -> Any:
    """The chain with the clamp's drive and MuJoCo's own water."""
    chain, water = stepper.chain, stepper.laws.water[0]
    source = chain.model
    spec = mujoco.MjSpec()
    spec.modelname, spec.compiler.degree = "tentacle", False
    spec.option.gravity = source.opt.gravity
    spec.option.integrator, spec.option.timestep = mujoco.mjtIntegrator.mjINT_IMPLICITFAST, EXPORT_STEP
    spec.option.density = float(water["density"])
    spec.option.wind = [float(water["U_x"]), float(water["U_y"]), 0.0]
    spec.visual.scale.framelength = 0.1
    body = spec.worldbody
    geometry = _Plates(chain, water)
    for k in range(chain.links + 1):
        body = body.add_body(name=f"link_{k}", pos=[0.0, 0.0 if k == 0 else float(chain.length[k - 1]), 0.0])
        _add_joint(body, stepper, k)
        _set_mass(body, stepper, k)
        geometry.add(body, k)
    _add_points(body, stepper)
    _add_drive(spec)
    return spec


def _add_joint(body: Any, stepper: Stepper, k: int) -> None:
    joint = body.add_joint(name="theta" if k == 0 else f"hinge_{k}", axis=[0, 0, 1])
    joint.type = mujoco.mjtJoint.mjJNT_HINGE
    if k == 0:
        joint.armature = FLYWHEEL
        return
    hinge = stepper.laws.hinges[k - 1]
    stiffness = float(hinge["stiffness"])
    joint.stiffness = [stiffness, 0.0, stiffness * float(hinge["cubic"])]  # of the bend, its square and its cube
    joint.damping = [float(hinge["damping"]), 0.0, 0.0]
    joint.springref = float(hinge["rest"])


def _set_mass(body: Any, stepper: Stepper, k: int) -> None:
    """Mass, centre and inertia including added mass; gravcomp keeps the weight unchanged."""
    own, water = own_link(stepper, k), stepper.laws.water[0]
    link = stepper.body.links[k]
    added = float(water["C_a"] * water["density"] * link[CARRIED])
    mass = own.mass + added
    centre = (own.mass * own.centre + added * link[CARRIED_CENTRE]) / mass
    turning = own.across + own.mass * (own.centre - centre) ** 2 + added * (link[CARRIED_CENTRE] - centre) ** 2
    turning += float(water["C_a"] * water["density"] * link[CARRIED_TURNING])
    body.mass, body.ipos, body.explicitinertial = mass, [0.0, centre, 0.0], True
    body.inertia = [turning, min(own.along, 2.0 * turning), turning]
    body.gravcomp = 1.0 - own.mass * (1.0 - own.gravcomp) / mass


@dataclass(frozen=True)
class OwnLink:
    """A link as it is cast: mass [kg], centre [m] from its start, inertia [kg m^2] across and along, gravcomp."""

    mass: float
    centre: float
    across: float
    along: float
    gravcomp: float


def own_link(stepper: Stepper, k: int) -> OwnLink:
    """Link k of the reference's chain, the mount's hub taken off."""
    source = stepper.chain.model
    at = source.body(f"link_{k}").id
    hub = float(source.body_inertia[source.body("mount").id, 0]) if k == 0 else 0.0
    across, along, _ = (float(inertia) for inertia in np.maximum(source.body_inertia[at] - hub, SMALLEST_INERTIA))
    return OwnLink(
        max(float(source.body_mass[at]), SMALLEST_MASS),
        float(source.body_ipos[at, 1]),
        across,
        min(along, 2.0 * across),
        float(source.body_gravcomp[at]),
    )


class _Plates:
    """Adds each link's geoms: a capsule for pictures, and a plate for MuJoCo's fluid model."""

    def __init__(self, chain: Chain, water: Any) -> None:
        self.chain, self.water = chain, water

    def add(self, body: Any, k: int) -> None:
        section, length = self.chain.specimen.section, float(self.chain.length[k])
        if length == 0.0:  # the hub behind a clamp that gives
            return
        s = (self.chain.start[k] + 0.5 * length) / self.chain.specimen.length
        half = 0.5 * float(section.width(s))
        eye = body.add_geom(name=f"skin_{k}", type=mujoco.mjtGeom.mjGEOM_CYLINDER, pos=[0.0, 0.5 * length, 0.0])
        eye.size, eye.quat = [half, 0.5 * length, 0.0], [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0]
        eye.mass, eye.contype, eye.conaffinity, eye.rgba = 0.0, 0, 0, [0.85, 0.55, 0.45, 1.0]
        if self.water["density"] <= 0.0:
            return
        b, h = 2.0 * half / np.pi, 0.5 * length
        a = THINNESS * min(b, h)
        plate = body.add_geom(name=f"water_{k}", type=mujoco.mjtGeom.mjGEOM_ELLIPSOID, pos=[0.0, h, 0.0])
        plate.size, plate.mass, plate.contype, plate.conaffinity, plate.group = [a, h, b], 0.0, 0, 0, 3
        blunt = float(self.water["C_perp"])
        # Along the tangent: 1/2 rho C_t P l |u| u = rho |u| u C_slender pi b h.
        slender = 0.5 * float(self.water["C_t"] * section.perimeter(s)) * length / (np.pi * b * h)
        plate.fluid_ellipsoid, plate.fluid_coefs = 1.0, [blunt, slender, 0.0, blunt, 0.0]


def _add_points(tip: Any, stepper: Stepper) -> None:
    """The bodies at the tip as the chain has them, with the water that they carry every way put into their mass."""
    source = stepper.chain.model
    for name, body in zip(BODIES, stepper.chain.bodies, strict=True):
        at = mujoco.mj_name2id(source, mujoco.mjtObj.mjOBJ_BODY, name)
        if at < 0:
            continue
        own, carries = float(source.body_mass[at]), SPHERE * float(stepper.laws.water[0]["density"]) * float(body[3])
        point = tip.add_body(name=name, pos=source.body_pos[at])
        point.mass, point.inertia, point.explicitinertial = own + carries, source.body_inertia[at], True
        point.ipos = source.body_ipos[at]
        point.gravcomp = 1.0 - own * (1.0 - float(source.body_gravcomp[at])) / (own + carries)


def _tip_bodies(stepper: Stepper) -> dict[str, Array]:
    """Places of the bodies at the tip, and the mass [kg] with which the swaying water's acceleration acts on them."""
    bodies = stepper.chain.bodies
    moved = (1.0 + SPHERE) * float(stepper.laws.water[0]["density"]) * bodies[:, 3]
    return {"body_reach": bodies[:, 1], "body_drop": bodies[:, 2], "body_moved": moved}


def _add_drive(spec: Any) -> None:
    """Actuators of the clamp: ctrl = theta [rad], its rate and its acceleration."""
    for name, gain, bias in (
        ("theta", FLYWHEEL * HOLD**2, [0.0, -FLYWHEEL * HOLD**2, 0.0]),
        ("theta_rate", 2.0 * FLYWHEEL * HOLD, [0.0, 0.0, -2.0 * FLYWHEEL * HOLD]),
        ("theta_acceleration", FLYWHEEL, [0.0, 0.0, 0.0]),
    ):
        actuator = spec.add_actuator(name=name, target="theta", trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.gaintype, actuator.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
        actuator.gainprm[0], actuator.biasprm[:3] = gain, bias


def _add_numbers(spec: Any, stepper: Stepper) -> None:
    """The numbers that arm_forces.py reads, under <custom>."""
    own = [own_link(stepper, k) for k in range(stepper.chain.links + 1)]
    links, nodes, hinges, water = stepper.body.links, stepper.body.nodes, stepper.laws.hinges, stepper.laws.water[0]
    fluid = float(water["C_a"] * water["density"])
    numbers: dict[str, Array] = {
        "length": stepper.chain.length,
        "mass": np.array([link.mass for link in own]),
        "centre": np.array([link.centre for link in own]),
        "inertia_across": np.array([link.across for link in own]),
        "inertia_along": np.array([link.along for link in own]),
        "gravcomp": np.array([link.gravcomp for link in own]),
        "carried": fluid * links[:, CARRIED],
        "carried_centre": links[:, CARRIED_CENTRE],
        "carried_turning": fluid * links[:, CARRIED_TURNING],
        "node_along": nodes[:, :, ALONG].ravel(),
        "node_weight": nodes[:, :, WEIGHT].ravel(),
        "node_width": nodes[:, :, WIDTH].ravel(),
        "node_perimeter": nodes[:, :, PERIMETER].ravel(),
        "node_area": nodes[:, :, AREA].ravel(),
        "water": np.array([float(water[name]) for name in WATER]),
        "drift": np.array([stepper.drift.rate, stepper.drift.settling]),
        **_tip_bodies(stepper),
        **{f"hinge_{name}": np.array(hinges[name]) for name in HINGE_FIELDS},
    }  # fmt: skip
    for name, data in numbers.items():
        spec.add_numeric(name=f"{NAME_PREFIX}{name}", data=np.asarray(data, dtype=float), size=len(data))


def _headed(xml: str, carried: Carried) -> str:
    """The XML with a comment: which effects it has, which arm_forces.py adds, and which are in neither."""
    lines = [
        "An arm identified by tentacle. Base frame: x along the normal, y along the straight arm; metres, radians.",
        "ctrl: theta, its rate, its acceleration.",
        *carried.sentences(),
    ]
    comment = "<!--\n  " + "\n  ".join(line.replace("--", "- -") for line in lines) + "\n-->\n"
    return comment + xml

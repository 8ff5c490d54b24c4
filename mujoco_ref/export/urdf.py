"""An identified arm as a URDF: a chain of links with their masses, and hinges with their damping.

    theta --- hinge_1 --- ... --- hinge_N,    each about z; link k from the end of link k - 1, along its own y

A URDF knows rigid links, joints and a joint's viscous damping. It has no spring at a joint and no water: the bending
stiffness, drag, added mass and buoyancy are named as left out, and the arm is limp in a program that adds no springs.
The springs that belong to the hinges stand in a comment of the file. Masses, centres,
inertias and damping are those of the MJCF export. Source of the format: wiki.ros.org/urdf/XML.
"""

from __future__ import annotations

from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from mujoco_ref.export.carried import NOT_IN_THE_ARM, refuse_clamp
from mujoco_ref.export.mjcf import own_link
from mujoco_ref.simulate import make_stepper
from mujoco_ref.step import Stepper
from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.signals import Array

CARRIES = {
    "inertia": "link masses and inertias",
    "weight": "link masses, under the gravity of the program",
    "damping": "dynamics damping of the joints",
    "third_curvature": "the chain's joints",
}
WIDEST = np.pi  # rad: a joint's limit; the arm's own bends are far below


@dataclass(frozen=True)
class Urdf:
    """The text of arm.urdf; springs (N,) [N m/rad] that its hinges need; and what it carries and what not, in words."""

    text: str
    springs: Array
    words: tuple[str, ...]


def export_urdf(model: Model, links: int = 20) -> Urdf:
    """The arm of a model as a URDF with `links` hinges.

    InputError where the reference refuses the model, or where it has a body at its tip or a clamp that gives, which are
    not written.
    """
    refuse_clamp(model)
    if model.specimen.tip_mass > 0.0 or "tip_mass" in model.parameters:
        raise InputError("has a body at its tip", field="tip_mass", expected="an arm without one, or --to mjcf")
    left = [name for name in model.parameters if name in NOT_IN_THE_ARM]
    kept = {name: values for name, values in model.parameters.items() if name not in left}
    stepper = make_stepper(Model(model.specimen, model.fluid, model.gravity, model.order, kept), links=links)
    springs: Array = np.array([float(hinge["stiffness"]) for hinge in stepper.laws.hinges])
    words = _words(model)
    robot = ElementTree.Element("robot", name="tentacle")
    robot.append(ElementTree.Comment(_comment(words, springs)))
    ElementTree.SubElement(robot, "link", name="clamp")
    for k in range(links + 1):
        _add_link(robot, stepper, k)
    for k in range(links + 1):
        _add_joint(robot, stepper, k)
    ElementTree.indent(robot)
    return Urdf('<?xml version="1.0"?>\n' + ElementTree.tostring(robot, encoding="unicode") + "\n", springs, words)


def _words(model: Model) -> tuple[str, ...]:
    names = list(dict.fromkeys(("inertia", "weight", *model.parameters)))
    carried = [f"{name} ({CARRIES[name]})" for name in names if name in CARRIES]
    lines = ["arm.urdf carries: " + ", ".join(carried) + "."]
    reasons = {"elasticity": "a URDF has no spring at a joint; the hinges' springs stand in its comment"}
    for name in names:
        if name not in CARRIES:
            why = reasons.get(name) or NOT_IN_THE_ARM.get(name) or "a URDF has no law for it"
            lines.append(f"arm.urdf leaves out {name}: {why}.")
    if model.fluid.density > 0.0:
        lines.append("arm.urdf leaves out the water: drag, added mass and buoyancy are the program's.")
    return tuple(lines)


def _comment(words: tuple[str, ...], springs: Array) -> str:
    """What is in the file and what not, and the springs [N m/rad] from the clamp to the tip."""
    values = " ".join(f"{value:.6g}" for value in springs)
    text = "\n".join(["An arm identified by tentacle.", *words, f"springs_N_m_per_rad: {values}"])
    return "\n" + text.replace("--", "- -") + "\n"


def _add_link(robot: ElementTree.Element, stepper: Stepper, k: int) -> None:
    own, length = own_link(stepper, k), float(stepper.chain.length[k])
    section = stepper.chain.specimen.section
    radius = 0.5 * float(section.width((stepper.chain.start[k] + 0.5 * length) / stepper.chain.specimen.length))
    link = ElementTree.SubElement(robot, "link", name=f"link_{k}")
    inertial = ElementTree.SubElement(link, "inertial")
    ElementTree.SubElement(inertial, "origin", xyz=f"0 {own.centre:.9g} 0", rpy="0 0 0")
    ElementTree.SubElement(inertial, "mass", value=f"{own.mass:.9g}")
    across, along = f"{own.across:.9g}", f"{own.along:.9g}"
    ElementTree.SubElement(inertial, "inertia", ixx=across, iyy=along, izz=across, ixy="0", ixz="0", iyz="0")
    visual = ElementTree.SubElement(link, "visual")
    ElementTree.SubElement(visual, "origin", xyz=f"0 {0.5 * length:.9g} 0", rpy=f"{np.pi / 2.0:.9g} 0 0")
    geometry = ElementTree.SubElement(visual, "geometry")
    ElementTree.SubElement(geometry, "cylinder", radius=f"{radius:.9g}", length=f"{length:.9g}")


def _add_joint(robot: ElementTree.Element, stepper: Stepper, k: int) -> None:
    name = "theta" if k == 0 else f"hinge_{k}"
    joint = ElementTree.SubElement(robot, "joint", name=name, type="revolute")
    ElementTree.SubElement(joint, "parent", link="clamp" if k == 0 else f"link_{k - 1}")
    ElementTree.SubElement(joint, "child", link=f"link_{k}")
    before = 0.0 if k == 0 else float(stepper.chain.length[k - 1])
    ElementTree.SubElement(joint, "origin", xyz=f"0 {before:.9g} 0", rpy="0 0 0")
    ElementTree.SubElement(joint, "axis", xyz="0 0 1")
    limit = f"{WIDEST:.9g}"
    ElementTree.SubElement(joint, "limit", lower=f"-{limit}", upper=limit, effort="1000", velocity="1000")
    if k > 0:
        damping = float(stepper.laws.hinges[k - 1]["damping"])
        ElementTree.SubElement(joint, "dynamics", damping=f"{damping:.9g}", friction="0")

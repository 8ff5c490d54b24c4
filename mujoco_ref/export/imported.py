"""An arm read from an MJCF file: a chain of hinges becomes a specimen with stiffness, damping and drag.

The chain's hinges are springs k_j [N m/rad] at places s_j, a spacing l_j apart. A rod of the same curvature has

    E I(s_j) = k_j l_j,   eta I(s_j) = d_j l_j,   rho A(s) = mass per length,

so E, eta and rho are the least-squares values over the hinges and links. Where k_j l_j does not follow I(s) within
SECTION_FITS, the paper's affine law k0 + k1 s (eq. 14) is fitted instead, and the words say so.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mujoco_ref.engine import mujoco
from mujoco_ref.export.arm_forces import NAME_PREFIX
from tentacle.errors import InputError
from tentacle.io.declaration_file import LONGEST_ARM
from tentacle.model import Estimate, Model
from tentacle.signals import Array
from tentacle.specimen import Cone, Fluid, Gravity, Rectangle, Section, Specimen

SECTION_FITS = 0.2  # relative misfit up to which a law counts as the section's own
STRAIGHTNESS = 1e-3  # of the arm's length: how far links may lie from a straight line
FEWEST_HINGES = 3  # hinges that make an arm
MEASURES = (
    "body_mass",
    "body_pos",
    "geom_pos",
    "geom_size",
    "jnt_pos",
    "jnt_stiffness",
    "dof_damping",
)  # MuJoCo's names
LARGEST = 1e9  # of any of them, in SI units


@dataclass(frozen=True)
class ImportedArm:
    """model, and words: how the file was read, and which parts of it were not used."""

    model: Model
    words: tuple[str, ...]


def import_arm(file: Path, fluid_density: float | None = None) -> ImportedArm:
    """The arm in an MJCF file; fluid_density [kg/m^3], if given, replaces the file's.

    InputError where it cannot be read, or has no straight planar chain of hinges.
    """
    if not file.is_file():
        raise InputError("no such file", file=file, expected="an MJCF file (.xml)")
    try:
        source = mujoco.MjModel.from_xml_path(str(file))
    except (ValueError, RuntimeError) as error:
        raise InputError(f"MuJoCo cannot read it: {str(error).splitlines()[0]}", file=file) from None
    try:
        chain = _chain_of(source)
        return _arm_of(source, chain, fluid_density)
    except InputError as error:
        raise InputError(error.problem, file=file, field=error.field, expected=error.expected) from None
    except UnicodeDecodeError:
        raise InputError("a name in it is no UTF-8", file=file, expected="names in UTF-8") from None


@dataclass(frozen=True)
class _HingeChain:
    """joints and bodies from base to tip; place (n,) [m] of the hinges from the base, length [m]; along: unit vector of
    the straight arm, axis: of the hinges, in the world at the model's reference pose.
    """

    joints: list[int]
    bodies: list[int]
    place: Array
    length: float
    along: Array
    axis: Array


def _chain_of(source: Any) -> _HingeChain:
    """The longest chain of bodies with one hinge each; a first hinge without a spring is the drive and is left out."""
    for name in MEASURES:
        if not np.all(np.abs(getattr(source, name)) < LARGEST):
            raise InputError("is not finite, or huge", field=name, expected=f"numbers below {LARGEST:g}")
    hinge = int(mujoco.mjtJoint.mjJNT_HINGE)
    if np.any(source.jnt_type == int(mujoco.mjtJoint.mjJNT_BALL)):
        raise InputError("has ball joints", field="joint", expected="a planar chain of hinges")
    single = [b for b in range(source.nbody) if source.body_jntnum[b] == 1 and
              source.jnt_type[source.body_jntadr[b]] == hinge]  # fmt: skip
    depth: dict[int, list[int]] = {}
    for body in single:  # parents come before their children
        depth[body] = [*depth.get(int(source.body_parentid[body]), []), body]
    bodies = max(depth.values(), key=len, default=[])
    joints = [int(source.body_jntadr[body]) for body in bodies]
    springs = [joint for joint in joints if source.jnt_stiffness[joint] > 0.0]
    if len(springs) < FEWEST_HINGES:
        raise InputError(
            f"{len(springs)} hinges with a spring", field="joint", expected=f"a chain of {FEWEST_HINGES} or more"
        )
    data = mujoco.MjData(source)
    mujoco.mj_forward(source, data)
    anchors, axes = data.xanchor[joints], data.xaxis[joints]
    span = np.abs(anchors - anchors[0]).max()
    if not 0.0 < span <= LONGEST_ARM:
        raise InputError(
            f"its hinges lie {span:.3g} m apart", field="body", expected=f"above 0 and up to {LONGEST_ARM:g} m"
        )
    if np.any(np.abs(axes @ axes[0]) < 1.0 - 1e-6):
        raise InputError("its hinges turn about different axes", field="joint", expected="parallel axes: a planar arm")
    along = anchors[-1] - anchors[0]
    along = along / np.linalg.norm(along)
    tip = _reach(source, data, bodies[-1], anchors[-1], along)
    place = (anchors - anchors[0]) @ along
    length = float(place[-1] + tip)
    if np.abs(anchors - anchors[0] - np.outer(place, along)).max() > STRAIGHTNESS * length:
        raise InputError("is bent at its reference pose", field="body", expected="a straight chain")
    first = 1 if source.jnt_stiffness[joints[0]] == 0.0 else 0
    return _HingeChain(joints[first:], bodies, place[first:], length, along, axes[0])


def _reach(source: Any, data: Any, body: int, anchor: Array, along: Array) -> float:
    """Length [m] of the last link beyond its hinge: the far end of its geoms, or twice the distance to its centre."""
    ends = [0.0]
    for geom in _geoms(source, body):
        half = _half_sizes(source, geom)
        turn = data.geom_xmat[geom].reshape(3, 3)
        ends.append(float((data.geom_xpos[geom] - anchor) @ along + np.abs(turn.T @ along) @ half))
    return max(ends) if max(ends) > 0.0 else float(2.0 * (data.xipos[body] - anchor) @ along)


def _geoms(source: Any, body: int) -> list[int]:
    """Geoms of a body that have a size of their own, without those that MuJoCo's ellipsoid water meets."""
    first, count = int(source.body_geomadr[body]), int(source.body_geomnum[body])
    return [g for g in range(first, first + count) if not (source.geom_fluid[g, 0] > 0.0 and count > 1)]


def _half_sizes(source: Any, geom: int) -> Array:
    """Half extents of a geom along its own axes [m], a capsule's without its caps."""
    kind, size = int(source.geom_type[geom]), source.geom_size[geom]
    if kind in (int(mujoco.mjtGeom.mjGEOM_CAPSULE), int(mujoco.mjtGeom.mjGEOM_CYLINDER)):
        return np.array([size[0], size[0], size[1]])
    if kind == int(mujoco.mjtGeom.mjGEOM_SPHERE):
        return np.full(3, size[0])
    return np.array(size)


def _arm_of(source: Any, chain: _HingeChain, fluid_density: float | None) -> ImportedArm:
    words = [f"{len(chain.joints)} hinges with springs over {1e3 * chain.length:.1f} mm"]
    section, middles = _section(source, chain)
    own = _exported(source)
    mass = own["mass"] if "mass" in own else source.body_mass[chain.bodies]
    unit = Specimen(section, chain.length, 1.0)
    density = float(np.sum(mass) / unit.mass)
    hung = [b for b in range(source.nbody) if source.body_parentid[b] == chain.bodies[-1] and b not in chain.bodies]
    tip_mass = float(sum(source.body_subtreemass[b] for b in hung))
    if "body_moved" in own:  # 3/2 of the water that the bodies displace; they carry half of what they displace
        tip_mass -= float(np.sum(own["body_moved"])) / 3.0
    gives = int("length" in own and own["length"][0] == 0.0)  # its first spring is that of a clamp that gives
    joints, place = chain.joints[gives:], chain.place[gives:]
    s = place / chain.length
    spacing = np.gradient(place)
    stiffness = source.jnt_stiffness[joints] * spacing
    damping = source.dof_damping[source.jnt_dofadr[joints]] * spacing
    second = section.second_moment(s)
    hinges = np.array([s, second])
    law, elastic, told = _law("elasticity", stiffness, hinges, chain.length)
    words.append(told)
    effects = {"elasticity": elastic}
    if np.any(damping > 0.0):
        _, effects["damping"], told = _law("damping", damping, hinges, chain.length, law)
        words.append(told)
    density_of_fluid = float(source.opt.density) if fluid_density is None else fluid_density
    fluid = Fluid(density_of_fluid)
    if own and fluid.density > 0.0:
        water = own["water"]
        effects["drag"] = {"C_perp": Estimate.exact(float(water[1]))}
        if water[3] > 0.0:
            carried = zip(("C_a", "tangential", "convective"), water[3:6].tolist(), strict=True)
            effects["added_mass"] = {name: Estimate.exact(number) for name, number in carried}
    elif fluid.density > 0.0:
        words.append("drag of the file's fluid model is not carried over: identify C_perp, or write it into the model")
    cubic = source.jnt_stiffnesspoly[chain.joints]
    if np.any(cubic != 0.0):
        words.append("springs that harden are not carried over")
    ignored = int(source.nbody - 1 - len(chain.bodies) - len(hung))
    if ignored > 0:
        words.append(f"{ignored} other bodies are not part of the chain and were left out")
    clamp = 0.0
    if gives:  # a spring of E I(0) / l, or k0 L / l
        root = elastic["E"].value * section.second_moment(0.0) if "E" in elastic else elastic["k0"].value * chain.length
        clamp = float(root / source.jnt_stiffness[chain.joints[0]])
        words.append(f"a clamp that gives as {1e3 * clamp:.3g} mm of the arm")
    specimen = Specimen(section, chain.length, density, tip_mass, law, clamp_length=clamp)
    words.append(f"radius at {len(middles)} links, density {density:.0f} kg/m3 from {1e3 * float(np.sum(mass)):.2f} g")
    return ImportedArm(Model(specimen, fluid, _gravity(source, chain), 2, effects), tuple(words))


def _section(source: Any, chain: _HingeChain) -> tuple[Section, Array]:
    """The section that the links' geoms have: a cone, or a rectangle."""
    data = mujoco.MjData(source)
    mujoco.mj_forward(source, data)
    base = data.xanchor[chain.joints[0]] - chain.place[0] * chain.along
    places, radii, boxes = [], [], []
    for body in chain.bodies:
        for geom in _geoms(source, body)[:1]:
            half = _half_sizes(source, geom)
            places.append(float((data.geom_xpos[geom] - base) @ chain.along) / chain.length)
            turn = data.geom_xmat[geom].reshape(3, 3)
            across = np.cross(chain.axis, chain.along)
            radii.append(float(np.abs(turn.T @ across) @ half))
            boxes.append(2.0 * float(np.abs(turn.T @ chain.axis) @ half))
    if len(radii) < FEWEST_HINGES:
        raise InputError("its links have no geoms", field="geom", expected="a geom on every link: it gives the radius")
    s, radius = np.array(places), np.array(radii)
    kinds = {int(source.geom_type[g]) for b in chain.bodies for g in _geoms(source, b)[:1]}
    if kinds == {int(mujoco.mjtGeom.mjGEOM_BOX)}:
        return Rectangle(float(np.mean(boxes)), 2.0 * float(np.mean(radius))), s
    slope, base_radius = np.polyfit(s, radius, 1)
    off = np.abs(radius - base_radius - slope * s).max()
    if off > 0.05 * radius.max():
        expected = "a radius that changes evenly along the arm, within 5 %"
        raise InputError(f"its radius is {1e3 * off:.2f} mm off a cone's", field="geom", expected=expected)
    return Cone(float(base_radius), max(float(base_radius + slope), 0.0)), s


def _law(
    effect: str, bending: Array, hinges: Array, length: float, law: str | None = None
) -> tuple[Any, dict[str, Estimate], str]:
    """The section's law, or the affine law if that does not fit, with a sentence about the misfit.

    bending (n,) = k l [N m^2] at the hinges (2, n): s and the section's second moment [m^4] there.
    """
    s, second = hinges
    names = ("E", "Pa", "k0", "k1", "N m/rad") if effect == "elasticity" else ("eta", "Pa s", "d0", "d1", "N m s/rad")
    modulus = float(np.exp(np.mean(np.log(bending / second)))) if np.all(bending > 0.0) else 0.0
    misfit = float(np.abs(bending / (modulus * second) - 1.0).max()) if modulus > 0.0 else np.inf
    if law == "section" or (law is None and misfit <= SECTION_FITS):
        told = f"{effect}: {names[0]} = {modulus:.4g} {names[1]}, the hinges within {100 * misfit:.2g} % of it"
        return "section", {names[0]: Estimate.exact(modulus, names[1])}, told
    slope, start = np.polyfit(s, bending / length, 1)
    left = float(np.abs(bending / length - start - slope * s).max() / np.abs(bending / length).max())
    told = f"{effect}: does not follow the section ({100 * misfit:.0f} %); affine law, {100 * left:.2g} % off"
    values = {names[2]: Estimate.exact(float(start), names[4]), names[3]: Estimate.exact(float(slope), names[4])}
    return "affine", values, told


def _exported(source: Any) -> dict[str, Array]:
    """The numbers of an arm that this project exported; empty for others."""
    names = [source.numeric(i).name for i in range(source.nnumeric)]
    return {name[len(NAME_PREFIX) :]: source.numeric(name).data for name in names if name.startswith(NAME_PREFIX)}


def _gravity(source: Any, chain: _HingeChain) -> Gravity:
    """Gravity in the plane of motion: n is the hinges' axis turned back from the straight arm."""
    normal = np.cross(chain.along, chain.axis)
    pull = np.array(source.opt.gravity)
    return Gravity(float(np.arctan2(pull @ normal, pull @ chain.along)), float(np.linalg.norm(pull)))

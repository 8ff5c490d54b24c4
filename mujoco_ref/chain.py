"""The arm as a chain of rigid links and hinges in MuJoCo: n hinges at the middles of n equal segments.

Link 0 is the half segment that is rigid with the clamp, link n the half segment at the tip; link k is centred on
s = k/n, so its direction is the tangent angle there, and the scheme is of second order in 1/n. The clamp is a mount
body that slides along x and y and turns about z: coordinates (x, y, theta, hinge 1 .. hinge n), planar, z out of the
plane. A clamp that gives is a hinge of its own at s = 0, before all others: link 0 is then a hub without length, and
there is one hinge and one link more. The hinge stands for a further length of the root, specimen.clamp_length.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from mujoco_ref.engine import mujoco
from tentacle.errors import InputError
from tentacle.signals import Array
from tentacle.specimen import STEEL, Fluid, Gravity, Specimen

# MuJoCo refuses inertias below 1e-15 kg m^2; the last half link of a pointed cone can be smaller than that.
SMALLEST_INERTIA = 4e-15
SMALLEST_MASS = 1e-12
RIGID = 1e-9  # of the arm's length: a clamp that gives less is a spring too stiff for differences of moments


@dataclass(frozen=True)
class Mount:
    """The clamp's mount: mass [kg] that moves on the rail, hub inertia [kg m^2] that turns with the clamp."""

    mass: float = 1e-3
    hub_inertia: float = 1e-6


@dataclass(frozen=True)
class Hung:
    """A compact body at the tip: mass [kg], its centre at a reach [m] beyond the tip along the last link and a drop [m]
    beside it along the normal; density [kg/m^3], and so the water that it displaces."""

    mass: float = 0.0
    reach: float = 0.0
    drop: float = 0.0
    density: float = STEEL

    @property
    def row(self) -> tuple[float, float, float, float]:
        """Mass, reach, drop, volume [m^3]."""
        return self.mass, self.reach, self.drop, self.mass / self.density


@dataclass(frozen=True)
class Chain:
    """A compiled chain of `links` hinges and the geometry that the water needs.

    model: MuJoCo's, complete in itself (stiffness, damping, weight, buoyancy as gravcomp). Per link (n + 1,): start and
    length [m] along the arm, mass [kg]. bodies (2, 4): the payload and the undeclared body, see Hung.row.
    hinge_s (n,), stiffness (n,) [N m/rad of hinge angle], damping (n,) [N m s/rad]. sharpness (n,): curvature c a
    radian of the hinge's angle, L over the length that it stands for. links: the hinges n, a clamp that gives included.
    """

    model: Any
    specimen: Specimen
    links: int
    start: Array
    length: Array
    mass: Array
    bodies: Array
    hinge_s: Array
    stiffness: Array
    damping: Array
    sharpness: Array

    def tangent_angles(self, q: Array) -> Array:
        """Tangent angle [rad] of the arm at even s from 0 to 1, of positions q (..., n + 3)."""
        return np.cumsum(q[..., 2:], axis=-1)[..., int(clamp_gives(self.specimen)) :]

    def nodes(self, points: int = 2) -> tuple[Array, Array]:
        """Gauss points of every link: distance from its start (n + 1, points) [m], weight [m]."""
        x, w = np.polynomial.legendre.leggauss(points)
        return 0.5 * self.length[:, None] * (x + 1.0), 0.5 * self.length[:, None] * w


def clamp_gives(specimen: Specimen) -> bool:
    """Whether the chain has a hinge for the clamp."""
    return specimen.clamp_share > RIGID


def link_bounds(specimen: Specimen, links: int) -> tuple[Array, Array]:
    """Where links begin and end along s: (n + 1,) each; n is the number of links asked for, and one more behind a clamp
    that gives.
    """
    cuts = np.concatenate([[0.0], hinge_positions(specimen, links), [1.0]])
    return cuts[:-1], cuts[1:]


def flexural(specimen: Specimen, s: ArrayLike, modulus: float, at_base: float, slope: float) -> Array:
    """k(s) or d(s) [N m/rad (s)], per unit curvature c: modulus I(s)/L + at_base + slope s (eq. 13-14 and the
    section's law)."""
    s = np.asarray(s, dtype=float)
    return modulus * specimen.section.second_moment(s) / specimen.length + at_base + slope * s


def refuse_bad_stiffness(s: Array, k: Array) -> None:
    """InputError where k is not positive, naming the s."""
    bad = np.flatnonzero(~(k > 0.0))
    if bad.size:
        where = f"k = {k[bad[0]]:.3g} N m/rad at s = {s[bad[0]]:.3f}"
        raise InputError(where, field="elasticity", expected="k(s) > 0 on [0, 1]")


def _inertia_of_links(specimen: Specimen, starts: Array, ends: Array) -> tuple[Array, Array, Array, Array]:
    """Mass, centre from the link's start, inertia about the centre across and along the link; exact for a cone."""
    x, w = np.polynomial.legendre.leggauss(3)  # exact to degree 5: A x^2 and I_a of a cone are of degree 4
    length = specimen.length * (ends - starts)
    s = starts[:, None] + 0.5 * (ends - starts)[:, None] * (x + 1.0)
    along, weight = 0.5 * length[:, None] * (x + 1.0), 0.5 * length[:, None] * w
    line = specimen.density * specimen.section.area(s) * weight
    mass = line.sum(axis=1)
    centre = (line * along).sum(axis=1) / np.where(mass > 0.0, mass, 1.0)  # a hub has none
    rotary = (specimen.density * specimen.section.second_moment(s) * weight).sum(axis=1)
    across = (line * (along - centre[:, None]) ** 2).sum(axis=1) + rotary
    return mass, centre, across, 2.0 * rotary


@dataclass(frozen=True)
class Flexure:
    """Stiffness and damping (n,) of the hinges, and the number of links that was asked for."""

    stiffness: Array
    damping: Array
    links: int


def build_spec(
    specimen: Specimen,
    flexure: Flexure,
    fluid: Fluid,
    gravity: Gravity,
    hung: tuple[Hung, ...],
    mount: Mount,
) -> Any:
    """The chain as an MjSpec; stiffness and damping (n,) per hinge angle. Geoms are for pictures: they have no mass."""
    spec = mujoco.MjSpec()
    spec.modelname = "tentacle"
    spec.option.gravity = [gravity.magnitude * np.sin(gravity.angle), gravity.magnitude * np.cos(gravity.angle), 0.0]
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE
    spec.option.timestep = 1e-3
    starts, ends = link_bounds(specimen, flexure.links)
    lengths = specimen.length * (ends - starts)
    mass, centre, across, along = _inertia_of_links(specimen, starts, ends)
    body = spec.worldbody.add_body(name="mount")
    for name, axis in (("mount_x", [1, 0, 0]), ("mount_y", [0, 1, 0])):
        body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    body.mass, body.inertia, body.explicitinertial = mount.mass, [mount.hub_inertia] * 3, True
    body.ipos = [0.0, 0.0, 0.0]
    body.gravcomp = 1.0  # the rail or stand carries the mount
    for k in range(lengths.size):
        offset = 0.0 if k == 0 else lengths[k - 1]
        body = body.add_body(name=f"link_{k}", pos=[0.0, offset, 0.0])
        hinge = body.add_joint(name="theta" if k == 0 else f"hinge_{k}", axis=[0, 0, 1])
        hinge.type = mujoco.mjtJoint.mjJNT_HINGE
        if k > 0:
            hinge.stiffness = [flexure.stiffness[k - 1], 0.0, 0.0]
            hinge.damping = [flexure.damping[k - 1], 0.0, 0.0]
        turning = max(across[k], SMALLEST_INERTIA)
        spin = min(max(along[k], SMALLEST_INERTIA), 2.0 * turning)
        hub = mount.hub_inertia if k == 0 else 0.0
        body.mass, body.ipos = max(mass[k], SMALLEST_MASS), [0.0, centre[k], 0.0]
        body.inertia, body.explicitinertial = [turning + hub, spin + hub, turning + hub], True
        body.gravcomp = fluid.density / specimen.density
        if lengths[k] == 0.0:  # a hub has no picture
            continue
        middle = 0.5 * (starts[k] + ends[k])
        size = [float(specimen.section.half_thickness(middle)), 0.5 * lengths[k], 0.0]
        geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=size, pos=[0.0, 0.5 * lengths[k], 0.0])
        geom.quat, geom.mass, geom.contype, geom.conaffinity = [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0], 0.0, 0, 0
    for name, point in zip(("payload", "hung"), hung, strict=True):
        if point.mass <= 0.0:
            continue
        payload = body.add_body(name=name, pos=[point.drop, lengths[-1] + point.reach, 0.0])
        payload.gravcomp = fluid.density / point.density
        turning = max(1e-4 * point.mass * lengths[-1] ** 2, SMALLEST_INERTIA)  # as nearly a point as MuJoCo takes
        payload.mass, payload.inertia, payload.explicitinertial = point.mass, [turning] * 3, True
        payload.ipos = [0.0, 0.0, 0.0]  # left out, MuJoCo 4.0 puts it at `pos` once more
    return spec


def build_chain(
    specimen: Specimen,
    flexure: Flexure,
    fluid: Fluid,
    gravity: Gravity,
    hung: Hung | None = None,
    mount: Mount | None = None,
) -> Chain:
    """Compile the chain; stiffness k and damping d (n,) at the hinges in the paper's units (per unit curvature c).

    A hinge at the middle of a segment bends by c/n, so that its own stiffness is n k. hung: a body at the tip besides
    the specimen's payload. InputError where links < 2 or k <= 0 at some hinge, and for sections that shear: links are
    rigid.
    """
    if specimen.shear_compliance > 0.0:
        given = f"{specimen.shear_compliance:g} is not in the chain of rigid links"
        raise InputError(given, field="shear_compliance", expected="0 for the MuJoCo reference")
    if flexure.links < 2:
        raise InputError(f"{flexure.links} is too few", field="links", expected="an integer >= 2")
    (starts, ends), s = link_bounds(specimen, flexure.links), hinge_positions(specimen, flexure.links)
    refuse_bad_stiffness(s, flexure.stiffness)
    sharpness = hinge_sharpness(specimen, flexure.links)
    payload = Hung(specimen.tip_mass, specimen.tip_mass_reach, specimen.tip_mass_drop, specimen.tip_mass_density)
    bodies = payload, hung or Hung()
    spec = build_spec(
        specimen,
        Flexure(sharpness * flexure.stiffness, sharpness * flexure.damping, flexure.links),
        fluid,
        gravity,
        bodies,
        mount or Mount(),
    )
    mass, _, _, _ = _inertia_of_links(specimen, starts, ends)
    return Chain(
        model=spec.compile(),
        specimen=specimen,
        links=s.size,
        start=specimen.length * starts,
        length=specimen.length * (ends - starts),
        mass=mass,
        bodies=np.array([body.row for body in bodies]),
        hinge_s=s,
        stiffness=sharpness * flexure.stiffness,
        damping=sharpness * flexure.damping,
        sharpness=sharpness,
    )


def hinge_positions(specimen: Specimen, links: int) -> Array:
    """s of the hinges: the middles of equal segments, after that of a clamp that gives."""
    middles = (np.arange(links) + 0.5) / links
    return np.append(0.0, middles) if clamp_gives(specimen) else middles


def hinge_sharpness(specimen: Specimen, links: int) -> Array:
    """Curvature c a radian of each hinge's angle: links, and at a clamp that gives L over its length."""
    even: Array = np.full(links, float(links))
    return np.append(1.0 / specimen.clamp_share, even) if clamp_gives(specimen) else even

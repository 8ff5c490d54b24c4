"""The arm prepared for computing: sections at quadrature nodes, curvature bases, the vector of all parameters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from affine_model.curvature import (
    Array,
    Quadrature,
    angle_basis,
    curvature_basis,
    legendre_to_monomial,
    quadrature,
    with_node_at_base,
)
from affine_model.effect import Effect, Parameter
from affine_model.effects import catalogue
from affine_model.shear import Shear, energy_turned, shear_of, shear_stiffness
from tentacle.errors import InputError
from tentacle.law.in_use import follows_laws
from tentacle.model import Model
from tentacle.specimen import Fluid, Gravity, Specimen, declared_effects


@dataclass(frozen=True)
class ParameterRow:
    """One entry of the vector of all parameters of all effects."""

    effect: str
    parameter: Parameter
    index: int


@follows_laws
def parameter_rows() -> tuple[ParameterRow, ...]:
    """Every parameter of the catalogue, in the order of the parameter vector that all simulations take."""
    pairs = [(effect.name, parameter) for effect in catalogue().values() for parameter in effect.parameters]
    return tuple(ParameterRow(effect, parameter, index) for index, (effect, parameter) in enumerate(pairs))


@follows_laws
def parameter_index(effect: str, parameter: str) -> int:
    """Position of a parameter in the vector; KeyError where the catalogue has none of that name."""
    for row in parameter_rows():
        if row.effect == effect and row.parameter.name == parameter:
            return row.index
    raise KeyError(f"no parameter {effect}.{parameter}")


def neutral_parameters() -> Array:
    """The vector (R,) at which every effect with parameters is absent."""
    return np.array([row.parameter.neutral for row in parameter_rows()])


def declared_parameters(specimen: Specimen, fluid: Fluid) -> Array:
    """The vector (R,) of an arm as declared: all effects absent, except the added mass that [fluid] declares."""
    values = neutral_parameters()
    for effect, parameters in declared_effects(specimen, fluid).items():
        for name, value in parameters.items():
            values[parameter_index(effect, name)] = value
    return values


def parameter_vector(model: Model) -> Array:
    """The vector (R,) of a model; InputError where it names an effect or parameter that the catalogue lacks."""
    values = declared_parameters(model.specimen, model.fluid)
    for effect, parameters in model.parameters.items():
        for name, estimate in parameters.items():
            try:
                values[parameter_index(effect, name)] = estimate.value
            except KeyError:
                known = ", ".join(f"{row.effect}.{row.parameter.name}" for row in parameter_rows())
                raise InputError("no such parameter", field=f"{effect}.{name}", expected=f"one of {known}") from None
    return values


@dataclass(frozen=True)
class Arm:
    """Geometry, surroundings, numbers of coordinates and quadrature nodes: the same for all individuals of a batch.

    phi(s) = theta + l/L c(0) + int_0^s c dv,       2 U = int k c^2 ds + l/L k(0) c(0)^2

    l: specimen.clamp_length; U: elastic energy. A clamp that gives is one more node at s = 0. It bends with the weight
    l / L and with all the laws of the arm's root; for masses and forces its weight is 0. Sections that shear
    (specimen.shear_compliance) add gamma(0) to phi, and c is then the curvature of bending: see affine_model.shear.
    """

    specimen: Specimen
    fluid: Fluid = Fluid()
    gravity: Gravity = Gravity()
    order: int = 2
    nodes: int = 8

    def __post_init__(self) -> None:
        if self.order < 1:
            raise InputError(f"{self.order} is not usable", field="order", expected="an integer >= 1")
        if self.nodes < self.order + 2:
            raise InputError(f"{self.nodes} is too few", field="nodes", expected=f"at least {self.order + 2}")

    @property
    def clamp(self) -> float:
        """l / L, how much the clamp gives: the arm's root turns by l / L c(0)."""
        return self.specimen.clamp_share

    @property
    def node_count(self) -> int:
        """N: the nodes of the rule, and a further one at s = 0 for a clamp that gives."""
        return self.nodes + int(self.clamp > 0.0)

    @cached_property
    def rule(self) -> Quadrature:
        """The quadrature rule along the arm. The node of a clamp that gives is the first and has no weight."""
        rule = quadrature(self.nodes)
        return with_node_at_base(rule) if self.clamp > 0.0 else rule

    @cached_property
    def bending_weights(self) -> Array:
        """Weights (N,) over all that bends: the arm, and the clamp as a further length l / L of its root."""
        weights = self.rule.weights
        return np.append(self.clamp, weights[1:]) if self.clamp > 0.0 else weights

    @cached_property
    def shear(self) -> Shear | None:
        """How the sections shear; None where they do not."""
        return shear_of(self.specimen, self.order) if self.specimen.shear_compliance > 0.0 else None

    @property
    def askew(self) -> Array | None:
        """How the sections stand askew by the paper's q, (n + 1, n): Shear.gamma; None where they do not shear."""
        return None if self.shear is None else self.shear.gamma

    @cached_property
    def curvature_basis(self) -> Array:
        """dc/dz at the nodes (N, n). With shear, the square of c holds its energy too."""
        s, shear = self.rule.s, self.shear
        if shear is None:
            return curvature_basis(self.order, s)
        bending = np.vander(s, self.order, increasing=True) @ shear.bending @ self.to_monomial
        weights = self.bending_weights * self.specimen.section.second_moment(s)
        stiff = self.rule.weights * shear_stiffness(self.specimen, s)
        return energy_turned(bending, shear.angles(s) @ self.to_monomial, (weights, stiff))

    @cached_property
    def angle_basis(self) -> Array:
        """d phi/dz at the nodes (N, n)."""
        return self.angles_at(self.rule.s)

    def angles_at(self, s: ArrayLike) -> Array:
        """d phi/dz of the midline at s (P,): shape (P, n). It includes the turn of the root."""
        angles = angle_basis(self.order, s)
        return angles + self.root @ self.to_monomial if self.root.any() else angles

    def sections_at(self, s: ArrayLike) -> Array:
        """d psi/dz of the sections at s (P,): shape (P, n). Without shear they stand square to the midline."""
        angles = self.angles_at(s)
        return angles if self.shear is None else angles - self.shear.angles(s) @ self.to_monomial

    @cached_property
    def root(self) -> Array:
        """How far the midline turns at s = 0 by each of the paper's q (n,): l / L c(0) + gamma(0)."""
        if self.shear is None:
            return self.clamp * np.eye(self.order)[0]
        return np.asarray(self.clamp * self.shear.bending[0] + self.shear.gamma[0])

    def root_turn(self, q: Array, axis: int = 0) -> Array:
        """How far the midline turns at its root [rad], of the paper's q [rad] along an axis; rates likewise."""
        turn = self.root[0] * np.take(q, 0, axis)
        for j in np.flatnonzero(self.root[1:]) + 1:
            turn = turn + self.root[j] * np.take(q, j, axis)
        return np.asarray(turn)

    @cached_property
    def to_monomial(self) -> Array:
        """T (n, n) with q = T z."""
        return legendre_to_monomial(self.order).copy()  # torch takes no array that cannot be written to

    @cached_property
    def from_monomial(self) -> Array:
        """Inverse of T: z = T^-1 q."""
        return np.asarray(np.linalg.inv(self.to_monomial), dtype=np.float64)

    @cached_property
    def node_quantities(self) -> dict[str, Array]:
        """Section quantities at the nodes (N,), named as in affine_model.effect.NODE_QUANTITIES."""
        section, s = self.specimen.section, self.rule.s
        return {
            "s": s,
            "area": section.area(s),
            "second_moment": section.second_moment(s),
            "width": section.width(s),
            "perimeter": section.perimeter(s),
        }

    @cached_property
    def arm_quantities(self) -> dict[str, float]:
        """Quantities of the whole arm, named as in affine_model.effect.ARM_QUANTITIES (without the time t)."""
        return {
            "length": self.specimen.length,
            "density": self.specimen.density,
            "fluid_density": self.fluid.density,
            "payload": self.specimen.tip_mass,
            "payload_reach": self.specimen.tip_mass_reach,
            "payload_drop": self.specimen.tip_mass_drop,
            "payload_density": self.specimen.tip_mass_density,
            "gravity": self.gravity.magnitude,
        }


def arm_of(model: Model, nodes: int = 8) -> Arm:
    """The arm of a model."""
    return Arm(model.specimen, model.fluid, model.gravity, model.order, max(nodes, model.order + 4))


def refuse_soft_sections(arm: Arm, parameters: Array) -> None:
    """InputError where k(s) = E I(s)/L + k0 + k1 s is not positive somewhere on [0, 1], naming the s."""
    E, k0, k1 = (parameters[parameter_index("elasticity", name)] for name in ("E", "k0", "k1"))
    s = np.linspace(0.0, 1.0, 201)
    k = E * arm.specimen.section.second_moment(s) / arm.specimen.length + k0 + k1 * s
    # A cone that ends in a point has I(1) = 0; only there may k vanish.
    pointed = k0 == 0.0 and k1 == 0.0 and E > 0.0
    bad = np.flatnonzero(~(k > 0.0) & ~(pointed & (s == 1.0)))
    if bad.size:
        raise InputError(
            f"k(s) = {k[bad[0]]:.3g} N m/rad at s = {s[bad[0]]:.3f}", field="elasticity", expected="k(s) > 0 on [0, 1]"
        )


def active_effects(parameters: Array) -> tuple[Effect, ...]:
    """The effects that act under these parameters (R, ...): base effects,
    and those with a strength that is not zero.
    """
    differs = np.any(np.reshape(parameters, (len(parameters), -1)) != 0.0, axis=1).tolist()
    return tuple(effect for effect, rows in _strength_rows() if rows is None or any(differs[row] for row in rows))


@follows_laws
def _strength_rows() -> tuple[tuple[Effect, tuple[int, ...] | None], ...]:
    """Every effect with the rows of its strengths; a base effect, which always acts, with None."""
    strengths: dict[str, list[int]] = {}
    for row in parameter_rows():
        if not row.parameter.scan:
            strengths.setdefault(row.effect, []).append(row.index)
    return tuple(
        (effect, None if effect.family == "base" else tuple(strengths.get(effect.name, ())))
        for effect in catalogue().values()
    )

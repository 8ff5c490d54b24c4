"""The effect: one physical law, its parameters, and where it enters the equations. A model is a sum of effects.

Every law is a function of (x, p): x holds the section's quantities (see QUANTITIES), p the effect's own parameters.
An effect at its neutral parameters (all strengths zero) changes nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from affine_model.curvature import Array
from affine_model.sight import Sight

Law = Callable[[Any, Any], Any]
PairLaw = Callable[[Any, Any], tuple[Any, Any]]
BodyLaw = Callable[[Any, Any], tuple[Any, Any, Any, Any]]
BaseLaw = Callable[[Array, float, Any], Array]  # (table, step [s], p) -> table
SightLaw = Callable[[Sight, Any], Sight]

# What a law sees at each section. Per node of the arm:
NODE_QUANTITIES = {
    "s": "position along the arm, 0 at the base, 1 at the tip",
    "area": "section area [m^2]",
    "second_moment": "second moment of area about the bending axis [m^4]",
    "width": "extent across the plane of motion [m]",
    "perimeter": "wetted perimeter [m]",
}
# The same for the whole arm:
ARM_QUANTITIES = {
    "length": "length L [m]",
    "density": "density of the arm [kg/m^3]",
    "fluid_density": "density of the fluid [kg/m^3], 0 in air",
    "payload": "declared mass at the tip [kg]",
    "payload_reach": "how far its centre lies beyond the tip, along the tangent [m]",
    "payload_drop": "how far its centre lies beside the axis, along the normal [m]",
    "payload_density": "density of what hangs at the tip [kg/m^3]",
    "gravity": "magnitude of gravity [m/s^2]",
    "t": "time since the recording began [s]",
}
# Changing with the motion:
STATE_QUANTITIES = {
    "c": "curvature q1 + q2 s + ... (eq. 1) beyond that of the unloaded arm [rad]",
    "c_rate": "its rate [rad/s]",
    "stiffness": "k(s, t) of the elasticity (eq. 13), with all that changes it [N m/rad]",
    "x": "position along n at theta = 0 [m]",
    "y": "position along the straight arm at theta = 0 [m]",
    "phi": "tangent angle theta + alpha [rad]",
    "phi_rate": "its rate [rad/s]",
    "u_n": "velocity relative to the water, along the normal [m/s]",
    "u_t": "velocity relative to the water, along the tangent [m/s]",
    "speed": "its magnitude [m/s]",
    "drag_coefficient": "C_perp of the normal drag (eq. 15)",
    "memory": "curvature [rad] that the effect remembers (only with relaxation_time or yield_curvature)",
}
QUANTITIES = {**NODE_QUANTITIES, **ARM_QUANTITIES, **STATE_QUANTITIES}


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect.

    nominal is a typical size, used as the scale of the fit and as the strength in tests; the fit keeps the value
    within bounds. A strength is neutral at 0. A parameter with scan values shapes the effect and means nothing while
    the strengths are zero: a search tries each of them (default: the first).
    """

    name: str
    unit: str
    nominal: float
    bounds: tuple[float, float]
    words: str
    scan: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        low, high = self.bounds
        if not (low <= self.neutral <= high and low <= self.nominal <= high and low < high):
            raise ValueError(f"parameter {self.name}: neutral and nominal must lie within bounds {self.bounds}")

    @property
    def neutral(self) -> float:
        """The value at which the effect is absent (for a shape parameter: its first scan value)."""
        return self.scan[0] if self.scan else 0.0


@dataclass(frozen=True)
class Effect:
    """One physical effect: what it adds to the equations of motion, or how it changes the base motion or what is seen.

    Laws per length, at each section of the arm:
    stiffness [N m/rad], stiffness_share (relative change of the stiffness), natural_curvature [rad] (of the unloaded
    arm). The elastic moment is k(s, t) c, where k(s, t) = sum of stiffness * product of (1 + stiffness_share), and c is
    the curvature beyond the natural one. Every other law gets this k as x.stiffness and this c as x.c.
    bending_moment [N m] (conjugate to c, so that Q_j = -int m dc/dq_j ds, as in eq. 12-14),
    drag_coefficient (adds to C_perp; force laws get the sum as x.drag_coefficient),
    force (normal, tangential) [N/m] of the fluid, couple [N] (moment per length),
    line_inertia [kg/m] (of the arm), carried_water [kg/m] (water that moves with the arm in every direction: the
    water's own acceleration acts on it), normal_inertia [kg/m] (water that moves with the arm along the normal only),
    rotary_inertia [kg m], weight [kg/m] (mass per length on which gravity acts, buoyancy already subtracted),
    water_velocity (x, y) [m/s] in the base frame.

    Laws at the tip:
    hung_mass, a compact body: mass [kg], reach [m] beyond s = 1 along the tangent, drop [m] along the normal, density
    [kg/m^3]. It displaces water, and water of half the displaced mass moves with it, as with a sphere.
    tip_force (normal, tangential) [N]; its x holds position, angle and velocity of the tip.
    payload_shift (along the tangent, along the normal) [m]: from the declared to the true centre of the payload.

    For the whole arm: gravity_tilt [rad].
    Memory: relaxation_time [s] or yield_curvature [rad], not both. The law gets x.memory, the curvature of a spring
    in series with a dashpot, or with an element that slips at that curvature.
    Outside the equations of motion: base (the table (3, S) of the base angle and its derivatives behind the effect),
    sight (what camera and clock show), extra_order (number of curvature coordinates added).
    levels_off: its moment or force stays the same beyond some rate (tanh, or a yield_curvature), so that a step makes
    more Newton corrections (affine_model.kernel.generate.CAUTIOUS).
    family "option": another form of a base law. A model may choose it; the search does not try it.
    """

    name: str
    title: str
    parameters: tuple[Parameter, ...]
    source: str
    family: Literal["base", "fluid", "weight", "elastic", "shape", "servo", "measurement", "option"]
    dissipative: bool = False
    levels_off: bool = False
    stiffness: Law | None = None
    stiffness_share: Law | None = None
    natural_curvature: Law | None = None
    bending_moment: Law | None = None
    force: PairLaw | None = None
    couple: Law | None = None
    drag_coefficient: Law | None = None
    line_inertia: Law | None = None
    carried_water: Law | None = None
    normal_inertia: Law | None = None
    rotary_inertia: Law | None = None
    weight: Law | None = None
    water_velocity: PairLaw | None = None
    hung_mass: BodyLaw | None = None
    payload_shift: PairLaw | None = None
    tip_force: PairLaw | None = None
    gravity_tilt: Law | None = None
    relaxation_time: Law | None = None
    yield_curvature: Law | None = None
    base: BaseLaw | None = None
    sight: SightLaw | None = None
    extra_order: int = 0

    @property
    def strengths(self) -> tuple[Parameter, ...]:
        """The parameters that are zero when the effect is absent."""
        return tuple(parameter for parameter in self.parameters if not parameter.scan)

    @property
    def remembers(self) -> bool:
        """Whether its law sees x.memory."""
        return self.relaxation_time is not None or self.yield_curvature is not None

    @property
    def shapes(self) -> tuple[Parameter, ...]:
        """The parameters that only shape the effect."""
        return tuple(parameter for parameter in self.parameters if parameter.scan)

"""The ladder of comparisons: frequencies and shape at rest (also from theory), a release, driven motion, and thrust."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from tentacle.notebook import html_table
from tentacle.specimen import AIR, Cone, Gravity
from validation.model_pair import Twin, affine_twin, reference_twin, shape_error

if TYPE_CHECKING:
    from tentacle.model import Model

LADDER_ORDERS = (2, 3, 4)
LADDER_LINKS = (10, 20, 40, 80)
# Frequencies over sqrt(E I0 / (rho A0 L^4)), clamped-free, without rotary inertia (Rayleigh-Ritz): r_tip / r0 -> two
# modes.
CONES = {0.0: (8.7193, 21.1457), 0.1: (7.2049, 18.68), 0.5: (4.6252, 19.548), 1.0: (3.51602, 22.0345)}


@dataclass(frozen=True)
class Rung:
    """One quantity: theory (None where there is none), the reference by number of links, the reduced model by order.

    error: |reduced - reference| by order, relative, or in the unit itself where `absolute`.
    """

    name: str
    unit: str
    theory: float | None
    reference: dict[int, float]
    affine: dict[int, float]
    absolute: bool = False

    @property
    def best(self) -> float:
        """The reference with the most links."""
        return self.reference[max(self.reference)]

    def error(self, order: int) -> float:
        """See the class."""
        apart = abs(self.affine[order] - self.best)
        return apart if self.absolute else apart / abs(self.best)

    @property
    def spread(self) -> float:
        """Error of the reference with the most links: a third of the last change, because it is of second order in
        1/n.
        """
        fewer, most = sorted(self.reference)[-2:]
        apart = abs(self.reference[fewer] - self.reference[most]) / 3.0
        return apart if self.absolute else apart / abs(self.best)


@dataclass(frozen=True)
class Ladder:
    """All rungs of one model, and the driven motion for pictures: the reference, then the reduced model by order.

    third_opinion: first frequency in air [Hz] by PyElastica, if it is installed and can represent the arm.
    """

    rungs: tuple[Rung, ...]
    reference: Twin
    affine: dict[int, Twin]
    amplitude: float
    frequency: float
    third_opinion: float | None = None

    def _repr_html_(self) -> str:
        """The relative error of each order, or the absolute one with its unit, for each quantity."""
        orders = sorted(self.affine)
        rows = [
            (
                rung.name,
                *(f"{rung.error(o):.2g} {rung.unit}" if rung.absolute else f"{rung.error(o):.2%}" for o in orders),
            )
            for rung in self.rungs
        ]
        return html_table(("quantity", *(f"error of order {order}" for order in orders)), rows)


def in_air(model: Model, gravity: Gravity) -> Model:
    """The arm out of its water."""
    return replace(model, fluid=AIR, gravity=gravity)


def theory_frequencies(model: Model) -> tuple[float, float] | None:
    """Two natural frequencies in air [Hz] by Euler-Bernoulli's theory, for sections with a known solution."""
    specimen, elasticity = model.specimen, model.parameters.get("elasticity", {})
    modulus = elasticity["E"].value if "E" in elasticity else 0.0
    if specimen.tip_mass > 0.0 or modulus <= 0.0 or any(elasticity[k].value for k in ("k0", "k1") if k in elasticity):
        return None
    section = specimen.section
    taper = section.tip_radius / section.base_radius if isinstance(section, Cone) else 1.0
    known = next((roots for ratio, roots in CONES.items() if abs(ratio - taper) < 1e-6), None)
    if known is None:
        return None
    inertia, area = float(section.second_moment(0.0)), float(section.area(0.0))
    rate = np.sqrt(modulus * inertia / (specimen.density * area * specimen.length**4)) / (2.0 * np.pi)
    return float(known[0] * rate), float(known[1] * rate)


def affine_frequencies(model: Model, order: int) -> np.ndarray:
    """Natural frequencies (order,) [Hz] of the arm at rest, by the reduced model."""
    from affine_model.arm import arm_of, parameter_vector
    from affine_model.modes import modes

    return modes(arm_of(replace(model, order=order)), parameter_vector(model)).frequency


def affine_tip(model: Model, order: int) -> np.ndarray:
    """Place of the reduced model's tip at rest (2,) [m]."""
    from affine_model.arm import arm_of, parameter_vector
    from affine_model.curvature import midline
    from affine_model.statics import equilibrium

    arm = arm_of(replace(model, order=order))
    q = equilibrium(arm, parameter_vector(model), 0.0)
    return midline(q, arm.root_turn(q), model.specimen.length, np.array([1.0]))[0]


def reference_tip(model: Model, links: int) -> np.ndarray:
    """Place of the reference's tip at rest (2,) [m]."""
    from mujoco_ref.midline import chain_midline_points
    from mujoco_ref.simulate import make_stepper
    from mujoco_ref.statics import chain_equilibrium

    stepper = make_stepper(model, links=links)
    angles = stepper.chain.tangent_angles(chain_equilibrium(stepper, 0.0).q[None])
    return chain_midline_points(angles, np.zeros((1, 2)), model.specimen.length, np.array([1.0]))[0, 0]


def run_ladder(model: Model, amplitude: float, frequency: float | None = None) -> Ladder:
    """All rungs of one model; driven at `amplitude` [rad] and `frequency` [Hz], by default at .6 of the first mode."""
    from mujoco_ref.modes import natural_frequencies
    from mujoco_ref.simulate import make_stepper
    from tentacle.waveform import Ramped, Rest, Sine

    rungs = []
    dry = in_air(model, Gravity(0.0, 0.0))
    theory = theory_frequencies(model)
    modes = {n: natural_frequencies(make_stepper(dry, links=n), count=2) for n in LADDER_LINKS}
    reduced = {order: affine_frequencies(dry, order) for order in LADDER_ORDERS}
    for i, name in enumerate(("first", "second")):
        rungs.append(
            Rung(
                f"{name} frequency in air",
                "Hz",
                None if theory is None else theory[i],
                {n: float(found[i]) for n, found in modes.items()},
                {order: float(found[i]) for order, found in reduced.items()},
            )
        )
    still = replace(model, gravity=Gravity(0.0, 0.0))
    wet = {n: float(natural_frequencies(make_stepper(still, links=n), count=1)[0]) for n in LADDER_LINKS}
    rungs.append(
        Rung(
            "first frequency, declared fluid",
            "Hz",
            None,
            wet,
            {o: float(affine_frequencies(still, o)[0]) for o in LADDER_ORDERS},
        )
    )
    level = in_air(model, Gravity(np.pi / 2))
    rungs.append(
        Rung(
            "drop under its own weight, held level in air",
            "mm",
            None,
            {n: 1e3 * float(reference_tip(level, n)[0]) for n in LADDER_LINKS},
            {order: 1e3 * float(affine_tip(level, order)[0]) for order in LADDER_ORDERS},
        )
    )
    first = wet[max(LADDER_LINKS)]
    driven = 0.6 * first if frequency is None else frequency
    start = np.array([0.6, -0.3])
    rungs.append(_motion_rung("release from a bend: midline", model, Rest(), 4.0 / first, start))
    duration = 8.0 / driven
    wave = Ramped(Sine(amplitude, driven), 2.0 / driven)
    fps = min(200.0, max(25.0, 24.0 * driven))
    references = {n: reference_twin(model, wave, duration, fps, n) for n in LADDER_LINKS}
    twins = {order: affine_twin(model, order, wave, duration, fps) for order in LADDER_ORDERS}
    best, window = references[max(LADDER_LINKS)], 2.0 / driven
    rungs.append(
        Rung(
            "driven motion: midline",
            "mm",
            None,
            {n: shape_error(twin, best, window)[0] for n, twin in references.items()},
            {order: shape_error(twin, best, window)[0] for order, twin in twins.items()},
            absolute=True,
        )
    )
    if model.fluid.density > 0.0:
        rungs.append(
            Rung(
                "mean thrust of it",
                "mN",
                None,
                {n: 1e3 * twin.mean_load(window) for n, twin in references.items()},
                {order: 1e3 * twin.mean_load(window) for order, twin in twins.items()},
            )
        )
    return Ladder(tuple(rungs), best, twins, amplitude, driven, third_opinion(model, rungs[0].best))


def third_opinion(model: Model, guess: float) -> float | None:
    """First frequency in air [Hz] by PyElastica; None if it is not installed, if the arm is not a cone of one material,
    or if the fit of the frequency does not converge.
    """
    from mujoco_ref.third_opinion import first_frequency, is_installed

    elasticity = model.parameters.get("elasticity", {})
    plain = isinstance(model.specimen.section, Cone) and model.specimen.tip_mass == 0.0 and set(elasticity) == {"E"}
    if not plain or not is_installed():
        return None
    try:
        return first_frequency(model.specimen, elasticity["E"].value, guess)
    except ArithmeticError:
        return None


def _motion_rung(name: str, model: Model, wave, duration: float, start: np.ndarray) -> Rung:
    """Distance [mm] of the whole motion from the reference with the most links."""
    fps = min(400.0, 200.0 / duration)
    references = {n: reference_twin(model, wave, duration, fps, n, start) for n in LADDER_LINKS}
    best = references[max(LADDER_LINKS)]
    return Rung(
        name,
        "mm",
        None,
        {n: shape_error(twin, best, duration)[0] for n, twin in references.items()},
        {o: shape_error(affine_twin(model, o, wave, duration, fps, start), best, duration)[0] for o in LADDER_ORDERS},
        absolute=True,
    )

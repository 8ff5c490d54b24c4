"""Where the small motions are linearised. The fitted parameters will not do: a large missing force moves them far.

The equation of the small motions d is exact with the true stiffness K alone. With another, K_0, one more force acts:

    M d'' + D_0 d' + K_0 d = a B + (dF/dp) dp - Q - (K - K_0) d,        d as small as the noise

Where K_0 is too soft, the answer to that force is K / K_0 times the noise. Where K_0 is too stiff, it stays below the
noise, and the answer to a law is only K / K_0 times smaller. So the search begins stiff: at STIFFER times the stiffness
whose elastic force is as large as inertia and weight in the motion that was seen. The change dp beside the best law
then moves the parameters, and the search is repeated there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from affine_model.arm import Arm, neutral_parameters, parameter_index, parameter_rows
from affine_model.curvature import Array
from discovery.laws.grammar import Form, Scale, forms
from discovery.laws.inputs import LawInputs
from discovery.laws.inside import inner_forms, inner_place
from discovery.laws.search import FittedLaw, Sought, search_laws
from inference.fit import Fit
from inference.missing_force import SeenMotion, lacking, seen_motions
from inference.small_motions import law_scales, small_motions
from inference.trajectory import Problem

STIFFER = 4.0  # 1.2 to 3.2 times the true stiffness in nine development recordings, .3 where a tether holds the arm
FARTHEST = 8.0  # times: of one move of a parameter
ROUNDS, CLOSE = 4, 0.1  # a move of less than this share of every parameter is the last
INNER_ROUNDS, BESIDE = 2, 6  # rounds, and other forms, of the search for a law that acts inside the arm
EXPLAINED = 0.03  # share of the missing force's answer: where the best law leaves less, no law inside the arm is sought
EVERY_FORM = ("",)  # every name begins so
MODULUS, LOSS = ("elasticity", "E"), ("damping", "eta")


@dataclass(frozen=True)
class Searched:
    """The model at its last parameters, the motions there, the answers of laws about them, and the laws, best first."""

    point: tuple[Problem, Fit]
    motions: tuple[SeenMotion, ...]
    sought: Sought
    laws: tuple[FittedLaw, ...]


def sought_at(point: tuple[Problem, Fit]) -> tuple[tuple[SeenMotion, ...], Sought]:
    """The motions of the recordings that a law may act in, and the answers of laws about them."""
    problem, fitted = point
    shown = [(place, motion) for place, motion in enumerate(seen_motions(problem, fitted)) if motion is not None]
    inputs = tuple(
        LawInputs(arm, small_motions(problem, fitted, place, motion), stiffness_along(arm, fitted.parameters))
        for arm, (place, motion) in zip(arms_of(problem, fitted), shown, strict=True)
    )
    return tuple(motion for _, motion in shown), Sought(inputs)


def settled_search(
    base: tuple[Problem, Fit], motions: tuple[SeenMotion, ...], named: tuple[str, ...] = EVERY_FORM
) -> Searched | None:
    """The search among the forms whose names begin so, repeated from the stiff start until the best law leaves the
    parameters where they are; None where the small motions run away at the start.

    A softer point shows a law larger and a stiffer one cleaner. So a move is taken back only if the best law then has
    less evidence and also leaves a larger share, or if the small motions run away there. Where the best law
    leaves some of the missing force, and that force acts at one inner place, laws that act there are sought too.
    """
    found = _settled(stiff_point(base, motions), lambda s: tuple(f for f in forms(s) if f.law.name.startswith(named)))
    if found is None or found.laws[0].unexplained < EXPLAINED or named != EVERY_FORM:
        return found
    place = inner_place(arms_of(*found.point), found.motions)
    if place is None:
        return found
    beside = tuple(one.form for one in found.laws[:BESIDE])
    return _settled(found.point, lambda scale: (*inner_forms(scale, place), *beside), INNER_ROUNDS) or found


def _settled(
    point: tuple[Problem, Fit], among: Callable[[Scale], tuple[Form, ...]], rounds: int = ROUNDS
) -> Searched | None:
    """The search among these forms, repeated from this point."""
    last = None
    for _ in range(rounds):
        seen, sought = sought_at(point)
        if sought.ran_away:
            return last
        found = search_laws(sought, among(sought.scale))
        if last is not None and _worse(found[0], last.laws[0]):
            return last
        last = Searched(point, seen, sought, found)
        change = sought.change(found[0])
        if np.abs(change).max(initial=0.0) < CLOSE:
            return last
        point = _moved(point, change)
    return last


def _worse(law: FittedLaw, before: FittedLaw) -> bool:
    return law.evidence < before.evidence and law.unexplained > before.unexplained


def stiff_point(base: tuple[Problem, Fit], motions: tuple[SeenMotion, ...]) -> tuple[Problem, Fit]:
    """The model where the search begins: the modulus from the motion, the laws' other free parameters nominal."""
    nominal = {(row.effect, row.parameter.name): row.parameter.nominal for row in parameter_rows()}
    changed = {name: nominal[name] for name in base[0].free if name in nominal}
    if MODULUS not in changed:
        return base
    modulus = STIFFER * _balanced_modulus(base, motions)
    if LOSS in changed:
        changed[LOSS] *= modulus / nominal[MODULUS]
    return with_parameters(base, {**changed, MODULUS: modulus})


def arms_of(problem: Problem, fitted: Fit) -> list[Arm]:
    """The arm of every recording that a law may act in."""
    known = problem.known(fitted.parameters)[0]
    return [e.arm(known.arm) for e in known.experiments if not e.complete]


def stiffness_along(arm: Arm, parameters: Array) -> Array:
    """k(s) (N,) [N m/rad] at the nodes."""
    E, k0, k1 = (parameters[parameter_index("elasticity", name)] for name in ("E", "k0", "k1"))
    node = arm.node_quantities
    return E * node["second_moment"] / arm.specimen.length + k0 + k1 * node["s"]


def _balanced_modulus(base: tuple[Problem, Fit], motions: tuple[SeenMotion, ...]) -> float:
    """The modulus [Pa] at which the elastic force on the first coordinate varies as much as inertia and weight, rms."""
    rigid = neutral_parameters()
    elastic = rigid.copy()
    elastic[parameter_index(*MODULUS)] = 1.0
    squares = np.zeros(2)
    for arm, motion in zip(arms_of(*base), motions, strict=True):
        own = (motion.u, motion.rate, motion.acceleration)
        without, unit = (lacking(arm, parameters, own, motion.instant)[:, 0] for parameters in (rigid, elastic))
        squares += without.size * np.array([np.var(without), np.var(unit - without)])
    return float(np.sqrt(squares[0] / max(squares[1], 1e-300)))


def _moved(point: tuple[Problem, Fit], change: Array) -> tuple[Problem, Fit]:
    """The model moved by a change (P,) of the laws' free parameters, in their scales."""
    problem, fitted = point
    rows = {row.index: ((row.effect, row.parameter.name), row.parameter.bounds) for row in parameter_rows()}
    changed = {}
    for (place, scale), step in zip(law_scales(problem), change, strict=True):
        before, (name, (low, high)) = float(fitted.parameters[place]), rows[place]
        if before > 0.0:
            low, high = max(low, before / FARTHEST), min(high, before * FARTHEST)
        changed[name] = float(np.clip(before + scale * step, low, high))
    return with_parameters(point, changed)


def with_parameters(point: tuple[Problem, Fit], changed: dict[tuple[str, str], float]) -> tuple[Problem, Fit]:
    """The model with other values of these parameters, not fitted again."""
    problem, fitted = point
    parameters = fitted.parameters.copy()
    for name, value in changed.items():
        parameters[parameter_index(*name)] = value
    return replace(problem, parameters=parameters), replace(fitted, parameters=parameters)

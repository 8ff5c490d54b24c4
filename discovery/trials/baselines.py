"""Other methods on the same recordings: the paper's regression (eq. 18-19) and its weak form, asked for a column."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from affine_model.arm import arm_of, neutral_parameters, parameter_index
from affine_model.curvature import Array, legendre_to_monomial
from affine_model.effect import Effect
from affine_model.effects import absent_effects
from affine_model.identify.linear_fit import LinearFit
from affine_model.identify.observation import ShapeObservation
from affine_model.identify.regression import regression
from affine_model.identify.weak_form import weak_form
from discovery.compare import restricted
from discovery.prepare import prepare
from tentacle.model import Model
from tentacle.recording import Recording

ORDER = 2  # the paper's
WIDTH = 0.3  # s: a weak form's bump, about half the shortest period of the trials' motions
OVERLAP = 4
NATS_A_PARAMETER = 7.6  # as in discovery.search: about 20 candidates at p = .01
BASE = (("elasticity", "E"), ("damping", "eta"), ("drag", "C_perp"))

Method = Callable[[tuple[tuple[str, str], ...], Array], LinearFit]


@dataclass(frozen=True)
class Columns:
    """A recording as regression wants it: t (T,) [s], the paper's q (T, 2) [rad], base (3, T)."""

    t: Array
    q: Array
    base: Array


def columns_of(recording: Recording) -> Columns:
    """The paper's coordinates of a recording's shapes; frames that were not seen are left out.

    Raises InputError where it holds too little, TypeError where it shows markers only.
    """
    experiment = prepare(recording, hold_out=False).experiment
    observation = experiment.observation
    if not isinstance(observation, ShapeObservation):
        raise TypeError("the paper's regression needs whole shapes")
    q = restricted(observation, observation.coefficients, ORDER) @ legendre_to_monomial(ORDER).T
    seen = np.isfinite(q).all(axis=1)
    t = observation.t[seen]
    return Columns(t, q[seen], np.asarray(experiment.base(t)))


def _regressed(effect: Effect) -> bool:
    """Whether the effect is a column of eq. 18: those of the servo and the camera are not."""
    return bool(effect.strengths) and effect.base is None and effect.measurement is None


def _named(method: Method, independent: float) -> tuple[str, ...]:
    """The effect whose column explains most beyond its price; none where none pays."""
    parameters = neutral_parameters()
    parameters[parameter_index("elasticity", "E")] = 2e5
    base = method(BASE, parameters)

    def evidence(fitted: LinearFit, count: int) -> float:
        rows = independent * fitted.residual.size
        return -0.5 * rows * float(np.log(np.mean(fitted.residual**2))) - NATS_A_PARAMETER * count

    best, named = evidence(base, 0), ()
    for effect in filter(_regressed, absent_effects()):
        free = tuple((effect.name, strength.name) for strength in effect.strengths)
        with np.errstate(all="ignore"):
            found = evidence(method((*BASE, *free), parameters), len(free))
        if np.isfinite(found) and found > best:
            best, named = found, (effect.name,)
    return named


def baselines(recording: Recording) -> dict[str, tuple[str, ...]]:
    """Method -> the one effect it names, or nothing."""
    d = recording.declaration
    arm = arm_of(Model(d.specimen, d.fluid, d.gravity, ORDER))
    data = columns_of(recording)

    def strong(free: tuple[tuple[str, str], ...], parameters: Array) -> LinearFit:
        return regression(arm, parameters, free, data.t, data.q, data.base)

    def weak(free: tuple[tuple[str, str], ...], parameters: Array) -> LinearFit:
        return weak_form(arm, parameters, free, data.t, data.q, data.base, width=WIDTH, overlap=OVERLAP)

    # Rows of a weak form: OVERLAP bumps cover every instant, so that many rows count as one.
    return {"regression": _named(strong, 1.0), "weak_form": _named(weak, 1.0 / OVERLAP)}

"""Other methods on the same recordings: the best additional column in the paper's regression (eq. 18-19) and in its
weak form, and PySINDy's sparse regression over the same columns (if it is installed).
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

from affine_model.arm import arm_of, neutral_parameters, parameter_index
from affine_model.curvature import Array, legendre_to_monomial
from affine_model.effect import Effect
from affine_model.effects import absent_effects
from inference.compare import restricted
from inference.linear_fit import ParameterName, linear_columns
from inference.measured_motion import MeasuredCourse, measured_motion
from inference.prepare import prepare
from inference.regression import motion_residual
from inference.weak_form import Bumps, weak_system
from tentacle.model import Model
from tentacle.recording import Recording

BASELINE_ORDER = 2  # the paper's
BUMP_WIDTH = 0.3  # s: a weak form's bump, about half the shortest period of the trials' motions
OVERLAP = 4
DERIVATIVE_WINDOW = 7  # samples of a derivative in measured_motion
NATS_A_PARAMETER = 7.6  # noise alone gains this much with one parameter in 1 of 10000 cases
THRESHOLDS = np.geomspace(1e-3, 0.3, 8)  # of a column of norm 1, the target being of norm 1
BASE_PARAMETERS = (("elasticity", "E"), ("damping", "eta"), ("drag", "C_perp"))


@dataclass(frozen=True)
class RegressionData:
    """A recording's data for the regression: t (T,) [s], the paper's q (T, 2) [rad], base (3, T)."""

    t: Array
    q: Array
    base: Array


def columns_of(recording: Recording) -> RegressionData:
    """The paper's coordinates of a recording's shapes; frames that were not seen are left out.

    Raises InputError where it holds too little, TypeError where it shows markers only.
    """
    experiment = prepare(recording, hold_out=False).experiment
    observation = experiment.observation.shapes
    if observation is None:
        raise TypeError("the paper's regression needs whole shapes")
    q = restricted(observation, observation.coefficients, BASELINE_ORDER) @ legendre_to_monomial(BASELINE_ORDER).T
    seen = np.isfinite(q).all(axis=1)
    t = observation.t[seen]
    return RegressionData(t, q[seen], np.asarray(experiment.base(t)))


def _regressed(effect: Effect) -> bool:
    """Whether the effect is a column of eq. 18: those of the servo and the camera are not."""
    return bool(effect.strengths) and effect.base is None and effect.sight is None


@dataclass(frozen=True)
class System:
    """target (N,) = columns (N, F) times the parameters of these names; independent: share of rows that count."""

    target: Array
    columns: Array
    names: tuple[ParameterName, ...]
    independent: float

    def evidence(self, left: Array, parameters: int) -> float:
        """Log-likelihood [nats] of the residual (N,), minus a penalty for the parameters."""
        rows = self.independent * left.size
        return -0.5 * rows * float(np.log(np.mean(left**2))) - NATS_A_PARAMETER * parameters


def _system(residual: Callable[[Array], Array], independent: float) -> System:
    """The columns of the base and of every effect that has one, without columns that are zero in these data."""
    effects = [effect for effect in absent_effects() if _regressed(effect)]
    names = (*BASE_PARAMETERS, *((effect.name, strength.name) for effect in effects for strength in effect.strengths))
    given = neutral_parameters()
    given[parameter_index("elasticity", "E")] = 2e5
    with np.errstate(all="ignore"):
        at_given, columns = linear_columns(residual, given, names)
    size = np.linalg.norm(columns, axis=0)
    live = [k for k in range(len(names)) if np.isfinite(size[k]) and size[k] > 1e-12 * np.nanmax(size)]
    return System(-at_given, columns[:, live] / size[live], tuple(names[k] for k in live), independent)


def _best_column(system: System) -> tuple[str, ...]:
    """The effect whose columns raise the penalised likelihood most, beside the base's; none if none raises it."""
    best, named = -np.inf, ()
    for effect in ("", *dict.fromkeys(name for name, _ in system.names)):
        chosen = [k for k, name in enumerate(system.names) if name in BASE_PARAMETERS or name[0] == effect]
        solution = np.linalg.lstsq(system.columns[:, chosen], system.target, rcond=None)[0]
        found = system.evidence(system.target - system.columns[:, chosen] @ solution, len(chosen))
        if found > best:
            best, named = found, (effect,) if len(chosen) > len(BASE_PARAMETERS) else ()
    return named


def _sparse(system: System) -> tuple[str, ...]:
    """The effect that PySINDy's sparse regression over all columns (Brunton 2016) leaves with the largest share.

    The threshold is that of the best evidence.
    """
    import pysindy

    size = float(np.linalg.norm(system.target))
    best, named = -np.inf, ()
    for threshold in THRESHOLDS:
        optimizer = pysindy.STLSQ(threshold=threshold, alpha=1e-8)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it warns if a threshold removes every column
            optimizer.fit(system.columns, system.target[:, None] / size)
        share = np.ravel(optimizer.coef_) * size
        found = system.evidence(system.target - system.columns @ share, int(np.count_nonzero(share)))
        if found > best:
            others = [
                (abs(s), name[0])
                for s, name in zip(share, system.names, strict=True)
                if name not in BASE_PARAMETERS and s
            ]
            best, named = found, (max(others)[1],) if others else ()
    return named


def baselines(recording: Recording) -> dict[str, tuple[str, ...]]:
    """Method -> the one effect that it names, or nothing; without "pysindy" if that is not installed."""
    d = recording.declaration
    arm = arm_of(Model(d.specimen, d.fluid, d.gravity, BASELINE_ORDER))
    data = columns_of(recording)
    motion = measured_motion(arm, data.t, data.q, data.base)
    inside = slice(DERIVATIVE_WINDOW // 2, data.t.size - DERIVATIVE_WINDOW // 2)
    strong = _system(lambda vector: motion_residual(arm, vector, motion)[inside].ravel(), 1.0)
    # Rows of a weak form: OVERLAP bumps cover every instant, so that many rows count as one.
    weak = _system(
        weak_system(arm, MeasuredCourse(data.t, data.q, data.base), Bumps(BUMP_WIDTH, OVERLAP)), 1.0 / OVERLAP
    )
    sparse = {"pysindy": _sparse(weak)} if find_spec("pysindy") else {}
    return {"regression": _best_column(strong), "weak_form": _best_column(weak), **sparse}

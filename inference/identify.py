"""Identification of a declared model from recordings: the trajectory fit, and the paper's regression beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from affine_model.arm import Arm
from affine_model.curvature import Array
from inference.base_fit import Setting, fit_base, needed_order
from inference.bootstrap import bootstrap
from inference.compare import reduced_shape, run_comparison, run_errors
from inference.declared_arm import names_of
from inference.declared_words import declared_words
from inference.estimates import estimates, joint_posterior
from inference.fit import Fit, fit
from inference.identifiability import Identifiability, identifiability
from inference.initial_state import initial_nuisances
from inference.judged_fit import JudgedFit, judged_fit, variance_inflation
from inference.measured_motion import MeasuredCourse
from inference.observation import POSE
from inference.one_arm import one_arm, own_geometry_words, same_arm
from inference.prepare import Prepared, prepare
from inference.regression import regression
from inference.trajectory import Problem
from tentacle.diagnosis import ErrorMeasure, RunComparison
from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.notebook import html_paragraph
from tentacle.recording import Recording

CLOCK_DOUBT = 4.0  # standard errors: a larger offset of the clock is reported
ILL = 0.99  # correlation of two estimates above which the data cannot separate them
UNSETTLED = "The fits of the bootstrap did not converge: their intervals may be too narrow or too wide."


@dataclass(frozen=True)
class Identification:
    """An identified model and how well it is known.

    regression: the paper's values by eq. 18-19 (effect.parameter -> value), empty if q was not measured or there is no
    motor log. errors: on the judged frames. correlation (F, F): of the estimates, in the order of free. at_bound:
    parameters that ended on a bound. identifiability: what the fitted recordings determine. bootstrap: 95 % intervals
    by resampling (effect.parameter -> low, high), empty unless asked for. words: remarks. adequate: the residual of the
    fitted recordings looks like noise in its size, its correlation and its drift.
    """

    model: Model
    regression: dict[str, float]
    errors: ErrorMeasure
    held_out: bool
    free: tuple[str, ...]
    correlation: Array
    at_bound: tuple[str, ...]
    identifiability: Identifiability
    bootstrap: dict[str, tuple[float, float]]
    runs: tuple[RunComparison, ...]
    words: tuple[str, ...]
    adequate: bool

    @property
    def headline(self) -> str:
        """Order and error in one sentence."""
        where = "recordings that were not fitted" if self.held_out else "the recordings that were fitted"
        return f"{self.model.order} curvature coordinates; error {self.errors.midline_mm:.2f} mm on {where}."

    def _repr_html_(self) -> str:
        """The headline, the parameters with their intervals, and the remarks, for notebooks."""
        return html_paragraph(self.headline) + self.model._repr_html_() + "".join(map(html_paragraph, self.words))


def identify(
    recordings: Sequence[Recording],
    check: Sequence[Recording] = (),
    *,
    order: int | None = None,
    replicates: int = 0,
    seed: int = 0,
    device: str | None = None,
) -> Identification:
    """Fit the base effects to the recordings; check: recordings that only judge (the paper: chirp to fit, sine to
    check).

    order: number of curvature coordinates, else as many as the data need. replicates: of the bootstrap, 0 for none;
    seed: of its draws. device: CUDA device that simulates (None: the CPU). Raises InputError on unusable recordings.
    """
    if not recordings:
        raise InputError("no recording", expected="at least one")
    same_arm([*recordings, *check])
    given = (*recordings, *check)
    declaration, together = one_arm([prepare(recording, hold_out=False, device=device) for recording in given])
    prepared, judges = together[: len(recordings)], together[len(recordings) :]
    setting = Setting(declaration, tuple(p.experiment for p in prepared), order or 2)
    if order is None:
        setting = replace(setting, order=needed_order(setting, complete=True))
    problem, fitted = fit_base(setting, setting.order)
    judged = judged_fit(problem, fitted)
    prepared = [replace(p, experiment=e) for p, e in zip(prepared, problem.experiments, strict=True)]
    shown, final = (judges, _initial_states(setting, problem, judges)) if judges else (prepared, (problem, fitted))
    runs = [run_comparison(p, place, final, final, False) for place, p in enumerate(shown)]
    spread = np.sqrt(np.maximum(np.diag(fitted.covariance), 1e-300))
    correlation = fitted.covariance / np.outer(spread, spread)
    known = identifiability(problem, fitted)
    drawn = bootstrap(problem, fitted, replicates=replicates, seed=seed) if replicates else None
    arm = problem.known(fitted.parameters)[0].arm
    inflation = variance_inflation(judged)
    table, joint = estimates(problem, fitted, inflation), joint_posterior(problem, fitted, inflation)
    return Identification(
        model=Model(arm.specimen, arm.fluid, arm.gravity, setting.order, table, joint),
        regression=_paper_regression(replace(arm, order=2), problem, fitted, prepared),
        errors=run_errors(runs, shown, augmented=False),
        held_out=bool(judges),
        free=tuple(".".join(name) for name in fitted.free),
        correlation=correlation,
        at_bound=tuple(".".join(name) for name in fitted.at_bound),
        identifiability=known,
        bootstrap={}
        if drawn is None
        else {
            ".".join(name): (float(low), float(high))
            for name, low, high in zip(drawn.free, drawn.low, drawn.high, strict=True)
        },
        runs=tuple(run for run, _, _ in runs),
        words=(
            *_remarks(judged, correlation),
            *own_geometry_words(prepared),
            *_told(problem, known),
            *([UNSETTLED] if drawn is not None and not drawn.result.converged else []),
            *declared_words(problem, fitted, inflation),
        ),
        adequate=judged.train.passed,
    )


def _initial_states(setting: Setting, problem: Problem, judges: list[Prepared]) -> tuple[Problem, Fit]:
    """The fitted model on recordings that only judge: their initial states alone are fitted."""
    experiments = tuple(p.experiment for p in judges)
    alone = replace(problem, experiments=experiments, free=())
    return alone, fit(alone, tuple(initial_nuisances(e, setting.order) for e in experiments))


def _paper_regression(arm: Arm, problem: Problem, fitted: Fit, prepared: list[Prepared]) -> dict[str, float]:
    """The regression of eq. 18-19 with numerical derivatives, on the first recording that has q and a moving base."""
    for p in prepared:
        observation = p.experiment.observation.shapes
        if observation is None or p.experiment.release is not None or p.experiment.travel:
            continue
        q, _ = reduced_shape(observation, observation.coefficients, np.ones(1))
        seen = np.isfinite(q).all(axis=1)
        base = p.experiment.base(observation.t[seen])
        laws = tuple(name for name in problem.free if name not in names_of(problem.declared))
        parameters = problem.known(fitted.parameters)[1]
        found = regression(arm, parameters, laws, MeasuredCourse(observation.t[seen], q[seen], base))
        return {".".join(name): float(value) for name, value in zip(found.free, found.values, strict=True)}
    return {}


def _told(problem: Problem, known: Identifiability) -> list[str]:
    """Sentences about what the recordings do not determine."""
    words = [f"Condition of the parameters' information: {known.condition:.3g}."]
    for experiment, dead in zip(problem.experiments, known.dead, strict=True):
        shapes, pictured = experiment.observation.shapes is not None, experiment.picture_gain.size
        # Silence is right for the pose, which the camera alone moves, and for curvatures beyond the model's order.
        last = min(POSE + problem.arm.order, pictured)
        curvatures = [f"z{k - POSE + 1}" for k in dead if shapes and POSE <= k < last]
        markers = [f"marker {k // 2 + 1} {'xy'[k % 2]}" for k in dead if not shapes and k < pictured]
        sensors = [experiment.observation.sensors[k - pictured].label for k in dead if k >= pictured]
        if silent := curvatures + markers + sensors:
            words.append(f"{experiment.name}: {', '.join(silent)} say nothing about any parameter.")
    offset, sigma = known.clock
    if abs(offset) > CLOCK_DOUBT * sigma:
        words.append(f"The motor's clock seems off by {1e3 * offset:.2g} ms +- {1e3 * sigma:.1g} ms (diagnose it).")
    return words


def _remarks(judged: JudgedFit, correlation: Array) -> tuple[str, ...]:
    words = [] if judged.fitted.result.converged else [judged.fitted.result.message]
    names = [".".join(name) for name in judged.fitted.free]
    for i, j in zip(*np.triu_indices(len(names), 1), strict=True):
        if abs(correlation[i, j]) > ILL:
            words.append(
                f"{names[i]} and {names[j]} cannot be separated by these data (correlation {correlation[i, j]:.4f})."
            )
    words += [f"{'.'.join(name)} ended on a bound." for name in judged.fitted.at_bound]
    words += [
        f"{gate.name}: {gate.words}; the model is not complete." for gate in judged.train.gates if not gate.passed
    ]
    return tuple(words)

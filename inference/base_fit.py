"""The fit of the declared model: number of coordinates, starts, base parameters, noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from affine_model.arm import Arm, arm_of, declared_parameters, parameter_index
from affine_model.curvature import Array
from affine_model.declared_laws import declared_laws, law_starts
from affine_model.effect import Effect
from affine_model.shear import most_compliance
from inference.declared_arm import SHEAR, names_of
from inference.experiment import Experiment
from inference.fit import Fit, fit, linearised_fit, unfitted
from inference.initial_state import initial_nuisances
from inference.more_coordinates import with_coordinates
from inference.multistart import fit_multistart
from inference.noise_floor import noise_deviation
from inference.observation import POSE, ShapeObservation
from inference.prepare import MOST_COORDINATES, RELEASE, recalibrated
from inference.sufficient_step import sufficient_step
from inference.trajectory import RAN_AWAY, ParameterName, Problem
from tentacle.declared import Uncertain
from tentacle.model import Model
from tentacle.recording import Declaration
from tentacle.specimen import Fluid, densest

FIRST_STEP = 1.0 / 150.0  # s: a fit begins with this step; inference.sufficient_step finds the last one
SAME_NOISE = 0.03  # a noise that changes by less needs no new fit
# A curvature coordinate counts as seen where it adds this share to the noise's variance, or more
VISIBLE_COORDINATE_SHARE = 0.05
MOST_FOR_MARKERS = 4  # coordinates
REFINED_WITH_LAWS = 16  # starts that are refined, of those that one batch screens
FOLLOWED = 0.2  # noise sigmas to which a run with fewer coordinates must follow one with MOST_FOR_MARKERS


@dataclass(frozen=True)
class Setting:
    """What a fit starts from: the arm's declaration, its experiments, the order of curvature."""

    declaration: Declaration
    experiments: tuple[Experiment, ...]
    order: int
    step: float = FIRST_STEP

    def arm(self, order: int | None = None) -> Arm:
        """The arm with that many coordinates."""
        d = self.declaration
        return arm_of(Model(d.specimen, d.fluid, d.gravity, order or self.order))

    def sees_shapes(self) -> bool:
        """Whether any recording shows whole shapes; single markers do not show how many coordinates there are."""
        return any(experiment.observation.shapes is not None for experiment in self.experiments)

    @property
    def fluid(self) -> Fluid:
        """The densest fluid of the recordings: what acts in it has parameters, in whichever recording it acts."""
        return densest([self.declaration.fluid, *(e.arm(self.arm()).fluid for e in self.experiments)])

    @property
    def declared(self) -> tuple[Uncertain, ...]:
        """The uncertain numbers that a fit moves; a release's instant is a nuisance of its recording."""
        return tuple(number for number in self.declaration.uncertain if number.field != RELEASE)

    def base_free(self) -> tuple[ParameterName, ...]:
        """The base parameters that can be seen in this fluid."""
        free: list[ParameterName]
        if self.declaration.specimen.stiffness == "section":
            free = [("elasticity", "E"), ("damping", "eta")]
        else:
            free = [("elasticity", "k0"), ("elasticity", "k1"), ("damping", "d0"), ("damping", "d1")]
        if self.fluid.density > 0.0:
            free.append(("drag", "C_perp"))
            if self.fluid.added_mass == "fit":
                free.append(("added_mass", "C_a"))
        own = [(law.name, parameter.name) for law in self.laws for parameter in law.parameters]
        return (*free, *own, *names_of(self.declared))

    @property
    def laws(self) -> tuple[Effect, ...]:
        """The laws of its own that the arm's declaration names and that act in the fluid."""
        return declared_laws(self.declaration.specimen, self.fluid)

    def problem(self, order: int, parameters: Array) -> Problem:
        """The fit of the base effects and of the uncertain declaration, from a parameter vector (R + D,)."""
        declared = tuple(self._possible(number, order) for number in self.declared)
        return Problem(self.arm(order), self.experiments, self.base_free(), parameters, self.step, declared=declared)

    def _possible(self, number: Uncertain, order: int) -> Uncertain:
        """The number within what an arm of so many coordinates, and one that a search adds, can have."""
        if number.field != SHEAR:
            return number
        return replace(number, high=min(number.high, most_compliance(self.declaration.specimen, order + 1)))

    def start(self) -> Array:
        """The parameter vector (R + D,) of the declared model, with the uncertain numbers at their means."""
        begun = declared_parameters(self.declaration.specimen, self.fluid)
        for law in self.laws:
            for parameter in law.strengths:
                begun[parameter_index(law.name, parameter.name)] = parameter.nominal
        return np.concatenate([begun, [number.value for number in self.declared]])


def needed_order(setting: Setting, *, complete: bool = False) -> int:
    """How many curvature coordinates the data need.

    Shapes show this number themselves. For markers it comes from the convergence of the model. complete: the
    declaration is assumed to be complete, so that its residual counts as noise.
    """
    if not setting.sees_shapes():
        return _order_by_convergence(setting, complete)
    return max(_visible_order(e.observation.shapes) for e in setting.experiments if e.observation.shapes is not None)


def most_coordinates(problem: Problem) -> int:
    """How many curvature coordinates every recording's shapes hold (markers hold any number)."""
    shown = [e.observation.order for e in problem.experiments if e.observation.shapes is not None]
    return min(shown, default=MOST_COORDINATES)


def fitted_order(seen: int, most: int) -> int:
    """How many coordinates are fitted if `seen` are seen: the next even number, but at most `most`.

    Each number needs a compiled kernel. One coordinate too many costs only two more initial values.
    """
    return min(seen + seen % 2, most)


def _visible_order(observation: ShapeObservation) -> int:
    """The highest coordinate that is seen, found from the top down, without any dynamics.

    The last row of the whitening root belongs to the highest coordinate alone. If that coordinate is zero, its whitened
    value is pure noise, and the differences between frames show how large that noise is.
    """
    seen = observation.seen
    for order in range(observation.order, 2, -1):
        # Where the higher coordinates are zero, this row of the whitened data is R_kk z_k plus unit noise.
        value = np.einsum("tl,tl->t", observation.root[seen, POSE + order - 1], observation.coefficients[seen])
        noise = max(float(noise_deviation(value)), 0.5)
        surplus = float(np.mean(value**2)) / noise**2 - 1.0
        if surplus > VISIBLE_COORDINATE_SHARE + 6.0 * np.sqrt(2.0 / seen.sum()):
            return order
    return 2


def _order_by_convergence(setting: Setting, complete: bool) -> int:
    """The smallest order that can follow a run of the same model with more coordinates, as the markers see it.

    The fit to the data themselves says less: a missing effect can make up for a missing coordinate.
    """
    problem, fitted = fit_base(setting, 2)
    enough = FOLLOWED * max(1.0, _residual_rms(problem.experiments, fitted)) if complete else FOLLOWED
    began = replace(problem, parameters=fitted.parameters)
    finest, nuisances = with_coordinates(began, fitted.nuisances, MOST_FOR_MARKERS)
    run = unfitted(finest, nuisances)
    experiments = tuple(
        replace(experiment, observation=experiment.observation.subtract_residual(experiment.noise_gain * rows))
        for experiment, rows in zip(problem.experiments, run.residuals, strict=True)
    )
    for order in range(2, MOST_FOR_MARKERS):
        starts = tuple(initial_nuisances(experiment, order) for experiment in experiments)
        followed = fit(
            replace(problem, arm=setting.arm(order), experiments=experiments, parameters=run.parameters), starts
        )
        if _residual_rms(experiments, followed) < enough:
            return order
    return MOST_FOR_MARKERS


def _residual_rms(experiments: tuple[Experiment, ...], fitted: Fit) -> float:
    """rms of the residuals on the used frames [noise sigmas]."""
    rows = [rows[e.used].ravel() for e, rows in zip(experiments, fitted.residuals, strict=True)]
    return float(np.sqrt(np.mean(np.concatenate(rows) ** 2)))


def _starts(setting: Setting) -> Array:
    """Starts of the base parameters, (F, S): stiffness, damping and drag over the range of silicones, each with every
    start of the declared laws. Several laws take their starts side by side.
    """
    specimen = setting.declaration.specimen
    fluid, carried = setting.fluid, specimen.section.added_mass
    wet = fluid.density > 0.0
    second_moment = float(specimen.section.second_moment(0.0)) / specimen.length
    tip_moment = float(specimen.section.second_moment(1.0)) / specimen.length
    each = [law_starts(law) for law in setting.laws]
    count = max(map(len, each), default=1)
    laws = [[value for starts in each for value in starts[k % len(starts)]] for k in range(count)]
    columns = []
    for E in (3e4, 6e4, 1.2e5, 2e5, 3.2e5, 5e5, 9e5, 2e6):
        for relaxation in (0.003, 0.02):
            for drag in (0.6, 1.5) if wet else (None,):
                eta = E * relaxation
                if specimen.stiffness == "section":
                    column = [E, eta]
                else:
                    # The affine law that has the section's value at the base and a twentieth, or more, at the tip.
                    tip = max(tip_moment, 0.05 * second_moment) - second_moment
                    column = [E * second_moment, E * tip, eta * second_moment, eta * tip]
                stated = [number.value for number in setting.declared]
                water = [] if drag is None else [drag, *([carried] if fluid.added_mass == "fit" else [])]
                columns += [[*column, *water, *values, *stated] for values in laws]
    return np.array(columns).T


def _from_many_starts(setting: Setting, problem: Problem, nuisances: tuple[Array, ...]) -> Fit:
    """The best fit from all starts. A law that yields has many valleys: more of its starts are refined, with the
    uncertain numbers at their means, which are freed afterwards.
    """
    starts, count = _starts(setting), len(problem.free) - len(problem.declared)
    if not setting.laws:
        return fit_multistart(problem, nuisances, starts)
    known = replace(problem, free=problem.free[:count])
    found = fit_multistart(known, nuisances, starts[:count], keep=REFINED_WITH_LAWS)
    if not problem.declared:
        return found
    return fit(replace(problem, parameters=found.parameters), found.nuisances)


def fit_base(setting: Setting, order: int, *, warm: Fit | None = None) -> tuple[Problem, Fit]:
    """Fit the base effects alone at that order, from many starts or from a fit at another order."""
    nuisances = tuple(initial_nuisances(experiment, order) for experiment in setting.experiments)
    problem = setting.problem(order, setting.start())
    if warm is None:
        return refit_noise_and_step(problem, _from_many_starts(setting, problem, nuisances))
    problem = replace(problem, parameters=warm.parameters)
    return refit_noise_and_step(problem, fit(problem, nuisances))


def rough_base_fit(setting: Setting, order: int, *, warm: Fit | None = None) -> tuple[Problem, Fit]:
    """Fit the base effects at that order by least squares, with the noise that the frames show and the setting's step.

    A fit under the full likelihood begins here.
    """
    nuisances = tuple(initial_nuisances(experiment, order) for experiment in setting.experiments)
    problem = setting.problem(order, setting.start() if warm is None else warm.parameters)
    if warm is None:
        fitted = _from_many_starts(setting, problem, nuisances)
    else:
        fitted = fit(problem, nuisances, tolerance=1e-3, most=20)
    experiments = tuple(
        recalibrated(experiment, residuals)
        for experiment, residuals in zip(problem.experiments, fitted.residuals, strict=True)
    )
    return replace(problem, experiments=experiments, parameters=fitted.parameters), fitted


def fit_baseline_alone(setting: Setting, order: int, *, warm: Fit) -> tuple[Problem, Fit]:
    """Fit the base effects by least squares to the complete recordings alone, to an end.

    The other recordings get initial states from their first frames. Their missing effects therefore do not bias the
    base parameters.
    """
    complete = tuple(e for e in setting.experiments if e.complete)
    others = tuple(e for e in setting.experiments if not e.complete)
    alone = tuple(replace(e, varies=()) for e in complete)
    known, rough = rough_base_fit(replace(setting, experiments=alone), order, warm=warm)
    fitted = fit(known, rough.nuisances)
    shown = [initial_nuisances(experiment, order) for experiment in others]
    own = [np.concatenate([n, np.zeros(len(e.varies))]) for n, e in zip(fitted.nuisances, complete, strict=True)]
    recalibrated = tuple(replace(e, noise_gain=k.noise_gain) for e, k in zip(complete, known.experiments, strict=True))
    problem = replace(setting.problem(order, fitted.parameters), experiments=(*others, *recalibrated))
    return problem, linearised_fit(problem, np.concatenate([fitted.values, *shown, *own]), 0)


def refit_noise_and_step(problem: Problem, fitted: Fit) -> tuple[Problem, Fit]:
    """Refit with the noise that the residuals show and with a sufficient step; at most twice.

    The given objects are returned if neither noise nor step changes.
    """
    for _ in range(2):
        experiments = tuple(
            recalibrated(experiment, residuals)
            for experiment, residuals in zip(problem.experiments, fitted.residuals, strict=True)
        )
        step = sufficient_step(problem, fitted)
        changes = [
            float(np.max(np.abs(new.noise_gain / old.noise_gain - 1.0)))
            for new, old in zip(experiments, problem.experiments, strict=True)
        ]
        if max(changes) < SAME_NOISE and step == problem.step:
            break
        changed = replace(problem, experiments=experiments, parameters=fitted.parameters, step=step)
        again = fit(changed, fitted.nuisances)
        if np.max(np.abs(again.used_residuals)) >= RAN_AWAY:  # the fit before is better than none
            break
        problem, fitted = changed, again
        problem = replace(problem, parameters=fitted.parameters)
    return problem, fitted

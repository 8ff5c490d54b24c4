"""From a model to a gait: best sine, search, polish, limits made sure for any length of time, and a promise computed
finely.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from affine_model.curvature import Array
from affine_model.simulate import Rail
from affine_model.swim.gaits import gait_of, gait_tables
from affine_model.swim.limits import Box, search_box
from affine_model.swim.objectives import IDLE_POWER, Objective, scores
from affine_model.swim.polish import polish
from affine_model.swim.search import Generation, search
from affine_model.swim.thrust_map import best_sine
from affine_model.swim.trial import PAPER_RAIL, Trial, run, within_limits
from tentacle.errors import InputError
from tentacle.gait import Gait

_SURE_SECONDS, _SURE_STEP = 300.0, 2e-3  # a gait of three frequencies beats: its largest angle may come late


@dataclass(frozen=True)
class Promise:
    """What the model says of one gait, at its estimates, long and fine: means over many periods.

    thrust [N] forward with the base clamped; speed [m/s] forward on the rail; power [W] and peak torque [N m] there;
    transport [J/m] = (power + IDLE_POWER) / speed, infinite where it does not swim forward.
    """

    thrust: float
    speed: float
    power: float
    torque: float
    transport: float


@dataclass(frozen=True)
class Swimming:
    """The result: the gait and the best sine beside it, what each promises, and how the search went.

    gain: the objective's value over the sine's, on the fine trial. evaluations (G,) and best (G,): the search's course;
    value, sine_value and best in the objective's unit. peaks (3,): largest |theta|, |theta'|, |theta''| of the gait in
    300 s.
    """

    objective: str
    method: str
    seed: int
    gait: Gait
    sine: Gait
    promise: Promise
    sine_promise: Promise
    value: float
    sine_value: float
    evaluations: Array
    best: Array
    peaks: Array

    @property
    def gain(self) -> float:
        """The objective's value over that of the best sine."""
        return self.value / self.sine_value


def promise(trial: Trial, alpha: Array, rail: Rail = PAPER_RAIL) -> Promise:
    """What the clamped trial's model says of a gait (9,), clamped and on the rail."""
    fine = replace(trial, parameters=trial.parameters[:, :1]).refined()
    clamped, swum = run(fine, alpha[:, None]), run(fine.on_rail(rail), alpha[:, None])
    thrust, speed, power, torque = (float(part[0, 0]) for part in (clamped.thrust, swum.speed, swum.power, swum.torque))
    return Promise(thrust, speed, power, torque, (power + IDLE_POWER) / speed if speed > 0.0 else np.inf)


def sure_of_limits(trial: Trial, alpha: Array) -> Array:
    """The gait (9,) with amplitudes scaled so that it keeps the servo's limits over 300 s, not only over the trial."""
    return within_limits(alpha[:, None], trial.limits, _SURE_SECONDS, _SURE_STEP)[:, 0]


def periodic(alpha: Array, faint: float = 0.05) -> Array:
    """The gait (9,) with faint terms silenced and the others at the strongest one's frequency.

    A faint term beside a strong one only makes a beat whose good half a short trial may have seen.
    """
    tied, strength = np.array(alpha), np.abs(alpha[:3])
    tied[:3] = np.where(strength < faint * np.max(strength), 0.0, alpha[:3])
    tied[3:6] = alpha[3 + int(np.argmax(strength))]
    return tied


def for_objective(trial: Trial, objective: Objective, rail: Rail = PAPER_RAIL) -> Trial:
    """The clamped trial as it is, or on the rail, as the objective needs it."""
    return trial.on_rail(rail) if objective.on_rail else trial


def optimise(
    trial: Trial,
    objective: Objective,
    *,
    method: str = "cmaes",
    evaluations: int = 5000,
    seed: int = 0,
    rail: Rail = PAPER_RAIL,
    box: Box | None = None,
    noted: Iterable[Array] = (),
    watch: Callable[[Generation], None] | None = None,
) -> Swimming:
    """Find the best gait of eq. 20 for the objective, within the servo's limits. The trial is clamped (trial_of); rail
    serves the objectives that swim, and the promises.

    watch is called after every generation. noted: scores of an interrupted run's generations (see search). Raises
    InputError where nothing swims forward at all.
    """
    box = box or search_box(trial.limits)
    ready = for_objective(trial, objective, rail)
    sine, _ = best_sine(ready, objective)
    course: list[Generation] = []
    for generation in search(ready, objective, box, method, evaluations=evaluations, seed=seed, noted=noted):
        course.append(generation)
        if watch is not None:
            watch(generation)
    unit, _ = polish(ready, objective, box, course[-1].best_unit)
    found = box.alpha(unit[:, None])[:, 0]
    # The search's own best counts only where the long, fine trial agrees; a sine is a gait of eq. 20 too.
    candidates = np.stack([sure_of_limits(ready, alpha) for alpha in (sine, found, periodic(found))], axis=1)
    fine = ready.refined()
    values = scores(objective, fine, run(fine, candidates))
    winner = candidates[:, int(np.argmax(values))]
    value, sine_value = float(np.max(values)), float(values[0])
    if not value > 0.0:
        raise InputError("no gait within the servo's limits swims forward", field="limits", expected="wider limits")
    bandwidth = trial.limits.bandwidth
    return Swimming(
        objective=objective.name,
        method=method,
        seed=seed,
        gait=gait_of(winner, bandwidth),
        sine=gait_of(candidates[:, 0], bandwidth),
        promise=promise(trial, winner, rail),
        sine_promise=promise(trial, candidates[:, 0], rail),
        value=value,
        sine_value=sine_value,
        evaluations=np.array([generation.evaluations for generation in course]),
        best=np.array([generation.best_score for generation in course]),
        peaks=_peaks(winner, trial),
    )


def _peaks(alpha: Array, trial: Trial) -> Array:
    """Largest |theta|, |theta'|, |theta''| (3,) over the time that limits are made sure for."""
    _, peaks = gait_tables(alpha[:, None], round(_SURE_SECONDS / _SURE_STEP), _SURE_STEP, trial.limits.bandwidth)
    return peaks[:, 0]

"""From a model to a gait: best sine, best single wave, search, climbs, a check of the limits over a long time, and a
prediction with a finer step.

More evaluations never give a worse result: the final choice after N evaluations is among a subset of the gaits of a
longer search. Climbs start when the search exceeds all earlier climbs, and after fixed numbers of gaits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from affine_model.curvature import Array
from affine_model.simulate import Rail
from affine_model.swim.gaits import gait_of, gait_tables
from affine_model.swim.limits import Box, search_box
from affine_model.swim.objectives import IDLE_POWER, Objective, gait_scores
from affine_model.swim.polish import polish
from affine_model.swim.search import USUAL_SEARCH, Generation, SearchPlan, search
from affine_model.swim.thrust_map import best_sine
from affine_model.swim.trial import PAPER_RAIL, GaitTrial, run, swum_freely, within_limits
from affine_model.swim.waves import best_wave
from tentacle.errors import InputError
from tentacle.gait import Gait
from tentacle.notebook import html_paragraph, html_table
from tentacle.solver_result import RESULTS

_SURE_SECONDS, _SURE_STEP = 300.0, 2e-3  # a gait of three frequencies beats: its largest angle may come late
_RISE = 0.01  # relative rise of the search's best before the next climb
_MILESTONE = 1250  # evaluations after which a climb starts in any case, and after 4 times as many
ORIGINS = ("best sine", "single wave", "search")  # in the order of judgement: one gait, two, and all others


@dataclass(frozen=True)
class Promise:
    """The model's prediction for one gait at its estimates, with a fine step: means over many periods.

    thrust [N] forward with the base clamped; speed [m/s] forward on the rail; power [W] and peak torque [N m] there;
    transport [J/m] = (power + IDLE_POWER) / speed, infinite where it does not swim forward. If asked for, of a free
    hull: mean speed along its mean heading [m/s], yaw drift [rad/s] and power [W].
    """

    thrust: float
    speed: float
    power: float
    torque: float
    transport: float
    free_speed: float | None = None
    yaw_drift: float | None = None
    free_power: float | None = None


@dataclass(frozen=True)
class Swimming:
    """The result: the gait and the best sine, the prediction for each, and the course of the search.

    origin: start of the climb to this gait (ORIGINS). gain: the objective's value over the sine's, on the fine trial.
    evaluations (G,) and best (G,): the search's course; value, sine_value and best in the objective's unit. peaks (3,):
    largest |theta|, |theta'|, |theta''| of the gait in 300 s. polished: how the climb with the exact gradient
    ended (None: not asked for).
    """

    objective: str
    method: str
    seed: int
    origin: str
    gait: Gait
    sine: Gait
    promise: Promise
    sine_promise: Promise
    value: float
    sine_value: float
    evaluations: Array
    best: Array
    peaks: Array
    polished: RESULTS | None = None

    @property
    def gain(self) -> float:
        """The objective's value over that of the best sine."""
        return self.value / self.sine_value

    def _repr_html_(self) -> str:
        """The gait beside the best sine, for notebooks."""
        title = f"{self.gain:.2f} times the {self.objective} of the best sine within the servo's limits"
        rows = [
            (name, f"{1e3 * p.thrust:.2f}", f"{100.0 * p.speed:.2f}", f"{1e3 * p.power:.1f}", f"{1e3 * p.torque:.1f}")
            for name, p in (("optimised gait", self.promise), ("best sine", self.sine_promise))
        ]
        header = ("motion", "thrust [mN]", "speed [cm/s]", "power [mW]", "peak torque [mN m]")
        return html_paragraph(title) + html_table(header, rows)


def promises(trial: GaitTrial, alpha: Array, rail: Rail = PAPER_RAIL, free: bool = False) -> list[Promise]:
    """What the clamped trial's model says of gaits (9, B), clamped and on the rail; free: afloat too."""
    fine = replace(trial, parameters=trial.parameters[:, :1]).refined()
    clamped, swum = run(fine, alpha), run(fine.on_rail(rail), alpha)
    found = []
    for numbers in zip(clamped.thrust[:, 0], swum.speed[:, 0], swum.power[:, 0], swum.torque[:, 0], strict=True):
        thrust, speed, power, torque = map(float, numbers)
        transport = (power + IDLE_POWER) / speed if speed > 0.0 else np.inf
        found.append(Promise(thrust, speed, power, torque, transport))
    if not free:
        return found
    afloat = replace(trial, parameters=trial.parameters[:, :1]).afloat().refined()
    outcome, drifts = run(afloat, alpha), swum_freely(afloat, alpha)[1]
    numbers = zip(found, outcome.speed[:, 0].tolist(), drifts.tolist(), outcome.power[:, 0].tolist(), strict=True)
    return [replace(p, free_speed=v, yaw_drift=drift, free_power=power) for p, v, drift, power in numbers]


def sure_of_limits(trial: GaitTrial, alpha: Array) -> Array:
    """Gaits (9, B), amplitudes scaled so that they keep the servo's limits over 300 s, not only over the trial."""
    return within_limits(alpha, trial.limits, _SURE_SECONDS, _SURE_STEP)


def largest(trial: GaitTrial, alpha: Array) -> Array:
    """Largest |theta|, |theta'|, |theta''| (3,) of a gait (9,) over 300 s."""
    _, peaks = gait_tables(alpha[:, None], round(_SURE_SECONDS / _SURE_STEP), _SURE_STEP, trial.limits.bandwidth)
    return peaks[:, 0]


def periodic(alpha: Array, faint: float = 0.05) -> Array:
    """The gait (9,) with faint terms silenced and the others at the strongest one's frequency.

    A faint term beside a strong one makes a beat, of which a short trial may see only the better half.
    """
    tied, strength = np.array(alpha), np.abs(alpha[:3])
    tied[:3] = np.where(strength < faint * np.max(strength), 0.0, alpha[:3])
    tied[3:6] = alpha[3 + int(np.argmax(strength))]
    return tied


def climb(trial: GaitTrial, objective: Objective, box: Box, unit: Array) -> tuple[Array, float]:
    """The top above a point (9,) of the unit cube, and the same gait made periodic, both sure of their limits (9, 2);
    the better one's score.
    """
    tied = box.unit(periodic(box.alpha(unit[:, None])[:, 0])[:, None])[:, 0]
    starts = np.stack([unit, tied], axis=1)
    start = starts[:, int(np.argmax(gait_scores(objective, trial, run(trial, box.alpha(starts)))))]
    reached = polish(trial, objective, box, start).point  # the search climbs again from where this one stopped
    gait = box.alpha(reached[:, None])[:, 0]
    both = sure_of_limits(trial, np.stack([gait, periodic(gait)], axis=1))
    return both, float(np.max(gait_scores(objective, trial, run(trial, both))))


def for_objective(trial: GaitTrial, objective: Objective, rail: Rail = PAPER_RAIL) -> GaitTrial:
    """The clamped trial as it is, on the rail, or afloat, as the objective needs it."""
    if objective.free:
        return trial.afloat()
    return trial.on_rail(rail) if objective.on_rail else trial


def optimise_gait(
    trial: GaitTrial,
    objective: Objective,
    plan: SearchPlan = USUAL_SEARCH,
    *,
    rail: Rail = PAPER_RAIL,
    box: Box | None = None,
    watch: Callable[[Generation], None] | None = None,
) -> Swimming:
    """Find the best gait of eq. 20 for the objective, within the servo's limits. The trial is clamped (trial_of); rail
    serves the objectives on it, and the promises; trial.hull is the free one.

    A gait that is polished is judged with the others. watch is called after every generation. Raises InputError where
    nothing swims forward at all.
    """
    if plan.polish and objective.free:
        raise InputError("there is no exact gradient afloat", field="polish", expected="another objective")
    box = box or search_box(trial.limits)
    ready = for_objective(trial, objective, rail)
    sine, _ = best_sine(ready, objective)
    wave, _ = best_wave(ready, objective)
    top, highest = climb(ready, objective, box, box.unit(wave[:, None])[:, 0])
    judged = [sure_of_limits(ready, sine[:, None]), top]  # a sine is a gait of eq. 20 too
    climbed_from, milestone, course = highest, _MILESTONE, list[Generation]()
    for generation in search(ready, objective, box, plan):
        course.append(generation)
        # Two thresholds: a short trial may overrate a beat, and its climb then ends lower.
        due = generation.evaluations >= milestone
        if due or generation.best_score > max(highest, climbed_from + _RISE * abs(climbed_from)):
            milestone *= 4 if due else 1
            top, reached = climb(ready, objective, box, generation.best_unit)
            climbed_from, highest = max(climbed_from, generation.best_score), max(highest, reached)
            judged.append(top)
        if watch is not None:
            watch(generation)
    candidates, fine = np.concatenate(judged, axis=1), ready.refined()
    values = gait_scores(objective, fine, run(fine, candidates))
    leader = int(np.argmax(values))
    origin = ORIGINS[min((leader + 1) // 2, 2)]
    polished = None
    if plan.polish:
        from affine_model.swim.exact_gradient import exact_gradient

        polished = polish(ready, objective, box, box.unit(candidates[:, [leader]])[:, 0], slope=exact_gradient)
        candidates = np.concatenate([candidates, sure_of_limits(ready, box.alpha(polished.point[:, None]))], axis=1)
        values = np.append(values, gait_scores(objective, fine, run(fine, candidates[:, -1:])))
        leader = int(np.argmax(values))
    winner, value, sine_value = candidates[:, leader], float(values[leader]), float(values[0])
    if not value > 0.0:
        raise InputError("no gait within the servo's limits swims forward", field="limits", expected="wider limits")
    promised, sine_promised = promises(trial, candidates[:, [leader, 0]], rail, objective.free)
    bandwidth = trial.limits.bandwidth
    return Swimming(
        objective=objective.name,
        method=plan.method,
        seed=plan.seed,
        origin=origin,
        gait=gait_of(winner, bandwidth),
        sine=gait_of(candidates[:, 0], bandwidth),
        promise=promised,
        sine_promise=sine_promised,
        value=value,
        sine_value=sine_value,
        polished=None if polished is None else polished.result,
        evaluations=np.array([generation.evaluations for generation in course]),
        best=np.array([generation.best_score for generation in course]),
        peaks=largest(trial, winner),
    )

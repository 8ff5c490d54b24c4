"""What is maximised: mean thrust (eq. 21), mean speed on the rail, distance per energy (inverse cost of transport),
mean speed of a free hull.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array
from affine_model.swim.trial import GaitOutcome, GaitTrial

# Power [W] of servo and board at rest. Without it the slowest gait would always be the cheapest, because the power
# against drag falls with the cube of the speed.
IDLE_POWER = 0.1
_WORSE_THAN_ANY = -1e6
# Scores are compared to nine digits. A gait and its mirror image, or two gaits that the servo's limits make one, differ
# by rounding alone: without this a device's last bits would choose between them.
_BITS = 30


@dataclass(frozen=True)
class Objective:
    """A quantity (B, K) of an outcome to maximise; unit and words for the reader; on_rail: it needs the rail; free: it
    needs a free hull.
    """

    name: str
    unit: str
    words: str
    on_rail: bool
    quantity: Callable[[GaitOutcome], Array]
    free: bool = False


def cost_of_transport(outcome: GaitOutcome) -> Array:
    """Energy per distance (power + idle power) / speed (B, K) [J/m]; infinite where the arm does not swim forward."""
    with np.errstate(divide="ignore"):
        return np.where(outcome.speed > 0.0, (outcome.power + IDLE_POWER) / np.abs(outcome.speed), np.inf)


OBJECTIVES = {
    objective.name: objective
    for objective in (
        Objective("thrust", "N", "mean forward thrust, base clamped (eq. 21)", False, lambda o: o.thrust),
        Objective("speed", "m/s", "mean forward speed on the rail", True, lambda o: o.speed),
        Objective(
            "transport", "m/J", "distance per energy on the rail", True, lambda o: o.speed / (o.power + IDLE_POWER)
        ),
        Objective("free", "m/s", "mean speed of the free hull along its mean heading", False, lambda o: o.speed, True),
    )
}


def weighted(exponent: float) -> Objective:
    """Speed over power^exponent: 0 is the fastest gait, larger exponents trace the front of speed against power."""
    words = f"speed over power^{exponent:g} on the rail"
    return Objective(
        "weighted", "m/s/W^x", words, True, lambda o: o.speed / np.maximum(o.power + IDLE_POWER, 1e-9) ** exponent
    )


def worst_quarter_mean(values: Array) -> Array:
    """Mean over the worst quarter of the samples (B, K) -> (B,); with one sample, that sample."""
    worst = np.sort(values, axis=1)[:, : max(1, values.shape[1] // 4)]
    return worst.mean(axis=1)


def to_nine_digits(values: Array) -> Array:
    """The values rounded to 2^-30 of their power of two."""
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(np.ldexp(mantissa, _BITS)), exponent - _BITS)


def exact_scores(objective: Objective, trial: GaitTrial, outcome: GaitOutcome) -> Array:
    """(B,) to maximise. A gait that needs more torque than the servo has ranks below every feasible one."""
    value = worst_quarter_mean(objective.quantity(outcome))
    excess = np.max(outcome.torque, axis=1) / trial.limits.torque - 1.0
    value = np.where(excess > 0.0, -1e3 * (1.0 + excess), value)
    return np.where(outcome.diverged.any(axis=1) | ~np.isfinite(value), _WORSE_THAN_ANY, value)


def gait_scores(objective: Objective, trial: GaitTrial, outcome: GaitOutcome) -> Array:
    """exact_scores (B,) to nine digits, by which gaits are compared."""
    return to_nine_digits(exact_scores(objective, trial, outcome))

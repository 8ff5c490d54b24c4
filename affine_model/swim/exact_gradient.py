"""The score of a gait and its exact gradient, through the operator that runs the trials (tentacle::swim).

    d score / d gene = sum over rows r and samples k of  d score / d outcome_rk * d outcome_rk / d gene

The second factor is the discrete adjoint of the computed steps (affine_model.torch_adjoint). The first is a complex
step, Im f(x + i e) / e, which rounds nothing away (Squire & Trapp 1998).
"""

from __future__ import annotations

import numpy as np
import torch

from affine_model.advance import Pace
from affine_model.curvature import Array
from affine_model.device import CPU
from affine_model.swim.limits import Box
from affine_model.swim.objectives import Objective, exact_scores
from affine_model.swim.torch_evaluate import population, swum
from affine_model.swim.trial import GaitOutcome, GaitTrial, outcome_of

_STEP = 1e-30  # of the complex step
_THRUST, _TORQUE = 0, 3  # rows of an outcome; thrust, speed and power come first


def _weights(objective: Objective, trial: GaitTrial, outcome: GaitOutcome, rows: Array) -> Array:
    """d score / d row (6, 1, K) of one gait's outcome."""
    weights, torque = np.zeros_like(rows), outcome.torque[0]
    if np.max(torque) > trial.limits.torque:
        weights[_TORQUE, 0, np.argmax(torque)] = -1e3 / trial.limits.torque
        return weights
    values = objective.quantity(outcome)[0]
    worst = np.argsort(values, kind="stable")[: max(1, len(values) // 4)]
    for row, name in enumerate(("thrust", "speed", "power"), start=_THRUST):
        parts = {part: getattr(outcome, part) for part in ("thrust", "speed", "power")}
        parts[name] = parts[name] + 1j * _STEP
        moved = GaitOutcome(outcome.alpha, **parts, torque=outcome.torque, diverged=outcome.diverged)
        weights[row, 0, worst] = np.imag(objective.quantity(moved)[0, worst]) / _STEP / len(worst)
    return weights


def exact_gradient(trial: GaitTrial, objective: Objective, box: Box, unit: Array) -> tuple[float, Array]:
    """Score of a point (9,) of the unit cube and its gradient (9,). Where the limits or the peak torque change their
    instant, it is that of one side. A gait that diverges has none: zeros.
    """
    alpha, pace = box.alpha(unit[:, None]), Pace(trial.step, 2, trial.settled)
    genes = population(alpha.T, trial.device or CPU).requires_grad_(True)
    own = trial.arm, trial.drive, genes, torch.from_numpy(trial.parameters)
    rows = swum(*own, trial.limits.bounds, (pace, trial.steps))
    outcome = outcome_of(alpha, rows.detach().cpu().numpy())
    score = float(exact_scores(objective, trial, outcome)[0])
    if outcome.diverged.any():
        return score, np.zeros_like(unit)
    weights = torch.from_numpy(_weights(objective, trial, outcome, rows.detach().cpu().numpy())).to(rows)
    (slopes,) = torch.autograd.grad(rows, genes, weights)
    return score, slopes[0].cpu().numpy() * (np.array(box.upper) - np.array(box.lower))

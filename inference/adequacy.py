"""Adequacy gates: chi-square, Ljung-Box and drift. A fitted model is called complete if it passes all three."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2 as chi_square

from affine_model.curvature import Array
from inference.experiment import Experiment
from inference.fit import Fit
from inference.observation import TRACKER_ERROR
from inference.trajectory import Problem
from inference.whitened_fit import tangent_basis
from tentacle.diagnosis import Gate

SIGNIFICANCE = 1e-4  # of each gate under "nothing is missing": three gates a fit, false alarms well under 1 %
# Noise sigmas: structure below this rms is not called missing physics (the models' own numerics reach it)
MATERIAL = 0.12
LAGS = 20


@dataclass(frozen=True)
class Adequacy:
    """The gates of one fit on one set of frames. structure: rms of the residual beyond noise, in noise sigmas."""

    gates: tuple[Gate, ...]
    structure: float

    @property
    def passed(self) -> bool:
        """Whether every gate was passed."""
        return all(gate.passed for gate in self.gates)


def _fitted_rows(experiment: Experiment, residuals: Array) -> Array:
    """Whitened residuals (T', K) of the fitted frames, without unseen frames."""
    chosen = residuals[experiment.used]
    return chosen[np.any(chosen != 0.0, axis=1)]


def _live(rows: Array) -> Array:
    """The channels that carry information. A video's track, for example, has none on the clamp's shift."""
    return rows[:, np.any(rows != 0.0, axis=0)]


def _tracked(experiment: Experiment) -> bool:
    return experiment.observation.tracked


def ljung_box(rows: Array, lags: int = LAGS) -> tuple[float, int]:
    """Sum over channels of Q = N (N + 2) sum_k rho_k^2 / (N - k), and its degrees of freedom."""
    count = rows.shape[0]
    lags = min(lags, count // 4)
    centred = rows - rows.mean(axis=0)
    power = np.sum(centred**2, axis=0)
    total = 0.0
    for lag in range(1, lags + 1):
        rho = np.sum(centred[lag:] * centred[:-lag], axis=0) / np.maximum(power, 1e-300)
        total += float(np.sum(rho**2)) * count * (count + 2) / (count - lag)
    return total, lags * rows.shape[1]


def adequacy(problem: Problem, fitted: Fit) -> Adequacy:
    """The gates on the frames that were fitted."""
    experiments = problem.experiments
    allowed = (TRACKER_ERROR if any(_tracked(e) for e in experiments) else MATERIAL) ** 2
    both = zip(experiments, fitted.residuals, strict=True)
    parts = [part for part in (_live(_fitted_rows(e, residuals)) for e, residuals in both) if part.size]
    if not parts:
        return Adequacy((), 0.0)
    squares = sum(float(np.sum(part**2)) for part in parts)
    count = sum(part.size for part in parts) - len(fitted.values)
    ratio = squares / max(count, 1)
    structure = float(np.sqrt(max(ratio - 1.0, 0.0)))
    threshold = float(chi_square.isf(SIGNIFICANCE, count)) / count + allowed
    gates = [
        Gate("chi-square", ratio, threshold, ratio <= threshold, f"mean square residual {ratio:.3f} noise variances"),
    ]
    statistic, freedom = 0.0, 0
    for part in parts:
        value, degrees = ljung_box(part)
        statistic, freedom = statistic + value, freedom + degrees
    if freedom:
        limit = float(chi_square.isf(SIGNIFICANCE, freedom))
        # Structure of that rms shifts every rho by its square at most.
        limit += sum(part.size for part in parts) * LAGS * allowed**2
        gates.append(
            Gate("Ljung-Box", statistic, limit, statistic <= limit, f"residuals correlated over {LAGS} frames")
        )
    gates.append(_drift(problem, fitted, allowed))
    return Adequacy(tuple(gates), structure)


def _drift(problem: Problem, fitted: Fit, allowed: float) -> Gate:
    """Whether parameters that drift in time would explain more.

    The columns are the sensitivities times time, without what a refit of the model itself can absorb.
    """
    times, order = [], problem.arm.order
    for experiment, residuals, nuisances in zip(problem.experiments, fitted.residuals, fitted.nuisances, strict=True):
        t = experiment.observation.t[experiment.used]
        centred = (t - t.mean()) / max(np.ptp(t), 1e-9)
        times.append(np.repeat(centred, residuals.shape[1]))
        times.append(np.zeros(experiment.prior_residuals(order, 1.0, nuisances[:, None]).shape[0]))
    weight = np.concatenate(times)
    weight = np.concatenate([weight, np.zeros(fitted.used_residuals.size - weight.size)])
    columns = fitted.jacobian[:, : len(fitted.values)] * weight[:, None]
    basis = tangent_basis(fitted.jacobian)
    columns = columns - basis @ (basis.T @ columns)
    left, singular, _ = np.linalg.svd(
        columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300), full_matrices=False
    )
    left = left[:, singular > 1e-6 * max(singular[0], 1e-300)]
    gain = 0.5 * float(np.sum((left.T @ fitted.used_residuals) ** 2))
    limit = 0.5 * float(chi_square.isf(SIGNIFICANCE, left.shape[1])) + 0.5 * fitted.count * allowed
    return Gate("drift", gain, limit, gain <= limit, "gain in nats if the base parameters drifted")

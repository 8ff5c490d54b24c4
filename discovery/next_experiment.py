"""The next experiment: the base motion within the servo's limits that best separates rival models."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Protocol

import numpy as np

from affine_model.curvature import Array
from discovery.side_by_side import side_by_side
from inference.deferred_correction import coarser
from inference.experiment import Experiment, predict
from inference.fit import Fit
from inference.trajectory import RAN_AWAY, Problem
from inference.whitened_fit import tangent_basis
from tentacle.diagnosis import NEXT_SECONDS
from tentacle.io.waveform_file import waveform_table
from tentacle.servo_limits import ServoLimits
from tentacle.waveform import Chirp, Multisine, Rest, Sine, Waveform

DURATION = NEXT_SECONDS
SEPARATES = 5.0  # nats, from which a base motion is said to separate two models, and is proposed
FRAMES = 30.0  # 1/s at which a proposal is judged


class FittedHypothesis(Protocol):
    """A fitted model with some absent effects, of either loop."""

    @property
    def effects(self) -> tuple[str, ...]:
        """The absent effects that it adds."""
        ...

    @property
    def problem(self) -> Problem:
        """What was fitted."""
        ...

    @property
    def fitted(self) -> Fit:
        """How it ended."""
        ...


@dataclass(frozen=True)
class Proposal:
    """A base motion, the sets of effects that it is to separate, the chosen one first, and the nats that separate that
    one from the nearest other.
    """

    waveform: Waveform
    sets: tuple[tuple[str, ...], ...]
    nats: float

    @property
    def asked(self) -> dict[str, Any] | None:
        """The base motion as a table, to be run; None where it would separate too little to be worth it."""
        return waveform_table(self.waveform) if self.nats >= SEPARATES else None


def candidate_motions(limits: ServoLimits, seed: int) -> list[Waveform]:
    """Base motions within the limits: sines over the band, chirps up and down, multisines with random phases."""
    random = np.random.default_rng(seed)
    found: list[Waveform] = []
    for frequency in (0.2, 0.5, 0.8, 1.2, 1.7, 2.3, 3.0):
        largest = _amplitude(limits, np.array([frequency]))
        found += [Sine(share * largest, frequency) for share in (0.3, 1.0)]
    for start, stop in ((0.1, 1.5), (0.3, 3.0), (2.5, 0.2)):
        found.append(Chirp(_amplitude(limits, np.array([max(start, stop)])), start, stop, DURATION))
    for _ in range(6):
        frequencies = np.sort(random.uniform(0.15, 3.0, 4))
        phases = random.uniform(0.0, 2 * np.pi, 4)
        each = _amplitude(limits, frequencies)
        found.append(Multisine((each,) * 4, tuple(frequencies.tolist()), tuple(phases.tolist())))
    return found


def _amplitude(limits: ServoLimits, frequencies: Array) -> float:
    """The largest amplitude [rad] of each of these sines [Hz] together, whatever their phases."""
    omega = 2 * np.pi * frequencies
    ratios = limits.angle / omega.size, limits.speed / omega.sum(), limits.acceleration / (omega**2).sum()
    return float(0.999 * min(ratios))


def _virtual(experiment: Experiment, waveform: Waveform) -> Experiment:
    """A future run with this camera and noise, another base motion and a start from rest."""
    t = np.arange(0.0, DURATION, 1.0 / FRAMES)
    return replace(
        experiment.seeing(experiment.observation.later(t, waveform(t)[0])), name="proposal", base=waveform, t0=0.0,
        duration=DURATION, release=None,
        remembers=False, varies=(), lacks=frozenset(), travel=None, used=np.ones(t.size, dtype=bool),
    )  # fmt: skip


def has_servo(experiment: Experiment) -> bool:
    """Whether a servo turned the base, so that another motion can be commanded."""
    return experiment.release is None and not isinstance(experiment.base, Rest)


def propose_experiment(
    chosen: FittedHypothesis, rivals: tuple[FittedHypothesis, ...], limits: ServoLimits, seed: int
) -> Proposal | None:
    """The base motion with the largest gap [nats] between the chosen model and the nearest rival.

    One of the two is taken as true, and the other refits all its parameters and initial states to first order: the way
    round that shows more counts, because a model that contains the other one follows its runs exactly (Atkinson and
    Fedorov 1975). None if there is no rival, or if no servo turned the base.
    """
    source = chosen.problem.experiments[0]
    if not rivals or not has_servo(source):
        return None
    motions = candidate_motions(limits, seed)
    proposals = side_by_side([partial(_separated, chosen, rivals, waveform) for waveform in motions])
    return max(proposals, key=lambda one: one.nats, default=None)


def _separated(chosen: FittedHypothesis, rivals: tuple[FittedHypothesis, ...], waveform: Waveform) -> Proposal:
    """The base motion with what it separates."""
    future = _virtual(chosen.problem.experiments[0], waveform)
    measured = _measured(chosen, future)
    gap = min(max(_gap(rival, measured), _gap(chosen, _measured(rival, future))) for rival in rivals)
    return Proposal(waveform, tuple(h.effects for h in (chosen, *rivals)), gap)


def _measured(true: FittedHypothesis, experiment: Experiment) -> Experiment:
    """The future run as it is seen if this model is true, without noise."""
    problem, parameters = true.problem.known(true.fitted.parameters)
    step, rest = coarser(problem) * problem.step, _rest(experiment, problem.arm.order)
    shown = predict(problem.arm, experiment, parameters[:, None], rest[:, None], step)
    seen = experiment.observation
    return replace(experiment, observation=seen.subtract_residual(seen.predict(shown)[:, :, 0]))


def _rest(experiment: Experiment, order: int) -> Array:
    """The nuisances of a run that starts from rest."""
    return np.zeros(len(experiment.nuisance_names(order)))


def _gap(refitted: FittedHypothesis, measured: Experiment) -> float:
    """The nats of the difference that a model cannot absorb, to first order; 0 if its run leaves all bounds."""
    step = coarser(refitted.problem) * refitted.problem.step
    problem: Problem = replace(
        refitted.problem, experiments=(measured,), parameters=refitted.fitted.parameters, step=step, filters=()
    )
    start = np.concatenate([problem.parameters[problem.rows()], _rest(measured, problem.arm.order)])
    residuals, slope = problem.slope(start)
    if np.abs(residuals).max() >= RAN_AWAY:
        return 0.0
    basis = tangent_basis(slope)
    rest = residuals - basis @ (basis.T @ residuals)
    return 0.5 * float(rest @ rest)

"""One recording prepared for fitting: base motion, time window, observation, and the unknowns of this run alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from affine_model.acceleration_beside import gravity_of
from affine_model.arm import Arm, parameter_index, parameter_rows
from affine_model.base_signal import Steps, base_table
from affine_model.camera import sight_of
from affine_model.curvature import Array
from affine_model.dynamics import Instant
from affine_model.effects import catalogue
from affine_model.on_device import simulate_on
from affine_model.simulate import Batch, Start, Timing
from inference.appearance import Appearance
from inference.arm_at import arm_at
from inference.interpolate import at_times
from inference.observation import Observation
from inference.run_motion import motion_at
from tentacle.waveform import Waveform

SHIFT_PRIOR = 0.003  # arm lengths: how far the clamp may lie from where the camera's declaration puts it
SHIFT_LIMIT = 0.01  # arm lengths
ZERO_PRIOR, ZERO_LIMIT = 3.0, 10.0  # of the largest reading: how far a sensor's zero may lie off
SHAPE_LIMIT = 6.0  # rad: an arm that is curled up once around
# Relative spread of an arm's parameters between recordings: two of a silicone beam differ by .6 % in E; losses, in
# silicone and in water, change with temperature by some per cent.
PARAMETER_SPREAD = {"elasticity": 0.01, "damping": 0.05, "drag": 0.03}
SPREAD_REACH = 3.0  # spreads, however strongly the data pull: else a payload would be taken for a softer arm
RATE_PRIOR = 30.0  # rad/s: initial rates of curvature, where the observation shows none
STATE_REACH = 3.0  # times the spread seen in the recording: of an initial shape or rate
HIGHER_PRIOR = 0.3  # rad: initial curvature that the observation cannot see
MEMORY_PRIOR = 0.5  # rad: memory of a Maxwell branch at the start, from the motion before the recording


@dataclass(frozen=True)
class Experiment:
    """A recording as the fit sees it.

    base: the recorded base motion. t0, duration [s]: the simulated window. release [s]: the arm is held still until
    then (None: it moves from the start). used (T,) bool: frames that the fit may use; the others judge it. noise_gain:
    factor on the observation's stated standard deviation, found from the data. remembers: the
    model has a Maxwell branch, whose initial state is unknown too (an arm held still until its release has none).
    shapes_seen (K,) [rad], rates_seen (K,) [rad/s]: spread of the Legendre coordinates and of their rates in the
    recording (inference.motion_spread; empty: not known). base_known_from [s]: the base motion is recorded from then
    on (None: from t0). complete: the declaration is complete, so that no absent
    effect acts in this recording. varies: parameters (effect, name) that differ slightly between recordings.
    travel: of a base that travels, x, y, rates, accelerations (6, ...) over the pictures' clock (None: it stands).
    differs: fields of its declaration, with their values, in which it is not the first recording of the arm. lacks:
    effects of the model that do not act in this recording. declared: effects that its declaration holds; they act in
    a complete recording too. coarsening: T by which a decision will coarsen the likelihood, as far as it is known
    before the search; how much an arm varies between recordings, and what is declared, does not depend on the form of
    laws, so that it is not coarsened: its variance is T times smaller here. device: CUDA device that simulates it, as
    torch names it (None: the CPU).
    """

    name: str
    observation: Observation
    base: Waveform
    t0: float
    duration: float
    release: float | None
    used: np.ndarray
    noise_gain: Array
    release_sigma: float = 0.01
    remembers: bool = False
    shapes_seen: Array = field(default_factory=lambda: np.zeros(0))
    rates_seen: Array = field(default_factory=lambda: np.zeros(0))
    base_known_from: float | None = None
    complete: bool = False
    varies: tuple[tuple[str, str], ...] = ()
    differs: tuple[tuple[str, float], ...] = ()
    travel: Callable[[Array], Array] | None = None
    lacks: frozenset[str] = frozenset()
    declared: frozenset[str] = frozenset()
    coarsening: float = 1.0
    device: str | None = None

    def arm(self, first: Arm) -> Arm:
        """The arm as it is in this recording; first: as the first recording declares it."""
        return arm_at(first, self.differs)

    @property
    def begins_with_memory(self) -> bool:
        """Whether the memory at the start is among the nuisances."""
        return self.remembers and self.release is None

    @property
    def sees_shift(self) -> bool:
        """Whether the shift of the clamp is among the nuisances. The frame of a marker system needs no shift."""
        return self.observation.shapes is not None

    @property
    def picture_gain(self) -> Array:
        """noise_gain of what the pictures show, without that of sensors."""
        return self.noise_gain[: self.noise_gain.size - len(self.observation.sensors)]

    def seeing(self, observation: Observation) -> Experiment:
        """The experiment with another observation of the same pictures; without sensors where that has none."""
        return replace(self, observation=observation, noise_gain=self.noise_gain[: observation.channels])

    def instant(self, t: Array) -> Instant:
        """Times (...) [s] with the base's travel then, as the equations of motion take them: (..., 1) and (..., 6)."""
        travel = None if self.travel is None else np.moveaxis(self.travel(t), 0, -1)
        return Instant(t[..., None], travel=travel)

    def nuisance_names(self, order: int) -> list[str]:
        """Unknowns of this run alone: initial shape and rates in Legendre coordinates (or, released, the instant),
        memory, shift of the clamp, zeros of sensors.
        """
        initial = [f"z{j + 1}(0)" for j in range(order)]
        moving = [f"z{j + 1}'(0)" for j in range(order)] if self.release is None else ["release"]
        memory = [f"memory{j + 1}(0)" for j in range(order)] if self.begins_with_memory else []
        shift = ["shift_x", "shift_y"] if self.sees_shift else []
        zeros = [f"zero of {sensor.label}" for sensor in self.observation.sensors]
        return [*initial, *moving, *memory, *shift, *zeros, *(f"log {name}" for _, name in self.varies)]

    def nuisance_scales(self, order: int, length: float) -> Array:
        """Typical sizes of the nuisances, the scale of the fit's steps."""
        moving = [1.0] * order if self.release is None else [0.01]
        memory = [0.1] * order if self.begins_with_memory else []
        shift, zeros = [SHIFT_PRIOR * length] * 2 * self.sees_shift, self.observation.zero_size.tolist()
        return np.array([0.1] * order + moving + memory + shift + zeros + self.spreads().tolist())

    def nuisance_limits(self, order: int, length: float) -> Array:
        """Bounds (M,) on the size of each nuisance."""
        moving = list(self.rate_limits(order)) if self.release is None else [5.0 * self.release_sigma]
        memory = [SHAPE_LIMIT] * order if self.begins_with_memory else []
        return np.array(
            [SHAPE_LIMIT] * order
            + moving
            + memory
            + [SHIFT_LIMIT * length] * 2 * self.sees_shift
            + (ZERO_LIMIT * self.observation.zero_size).tolist()
            + [SPREAD_REACH * PARAMETER_SPREAD[effect] for effect, _ in self.varies]
        )

    def prior_residuals(self, order: int, length: float, nuisances: Array) -> Array:
        """The priors of the nuisances (M, B), as whitened residuals."""
        zeros = self.zeros(order, nuisances) / (ZERO_PRIOR * self.observation.zero_size)[:, None]
        shift = self.parts(order, nuisances)[3][: 2 * self.sees_shift] / (SHIFT_PRIOR * length)
        offsets = np.concatenate([shift, zeros])
        higher = nuisances[self.observation.order : order] / HIGHER_PRIOR
        varied = self.deviations(nuisances) / self.spreads()[:, None]
        if self.release is None:
            rates, seen = nuisances[order : 2 * order], self.shapes_seen[:order]
            shape = nuisances[: seen.size] / (STATE_REACH * seen)[:, None]
            memory = self.memory(order, nuisances)
            remembered = offsets[:0] if memory is None else memory / MEMORY_PRIOR
            return np.concatenate(
                [shape, rates / self.rate_limits(order)[:, None], offsets, higher, remembered, varied]
            )
        return np.concatenate([nuisances[order : order + 1] / self.release_sigma, offsets, higher, varied])

    def rate_limits(self, order: int) -> Array:
        """Largest initial rates (order,) [rad/s] of the Legendre coordinates."""
        seen = self.rates_seen[:order]
        rest = seen[-1] if seen.size else RATE_PRIOR / STATE_REACH
        return STATE_REACH * np.concatenate([seen, np.full(order - seen.size, rest)])

    def parts(self, order: int, nuisances: Array) -> tuple[Array, Array, Array, Array]:
        """Initial shape, rates (or, released, the instant), memory, and offsets: the clamp's shift and the sensors'
        zeros. Memory and offsets may be empty.
        """
        moving = order + (order if self.release is None else 1)
        memory = moving + order * self.begins_with_memory
        return (
            nuisances[:order],
            nuisances[order:moving],
            nuisances[moving:memory],
            nuisances[memory : memory + 2 * self.sees_shift + len(self.observation.sensors)],
        )

    def shift(self, order: int, nuisances: Array) -> Array:
        """Shift of the clamp (2, B) [m] in the pictures; zero where it is known not to shift."""
        found = self.parts(order, nuisances)[3][: 2 * self.sees_shift]
        return found if self.sees_shift else np.zeros((2, *nuisances.shape[1:]))

    def without_zeros(self, nuisances: Array) -> Array:
        """The nuisances of the same run without sensors."""
        end = len(nuisances) - len(self.varies)
        return np.concatenate([nuisances[: end - len(self.observation.sensors)], nuisances[end:]])

    def zeros(self, order: int, nuisances: Array) -> Array:
        """Zeros (G, B) of the sensors."""
        return self.parts(order, nuisances)[3][2 * self.sees_shift :]

    def deviations(self, nuisances: Array) -> Array:
        """Logarithms (D, B) of this recording's share of each parameter that varies."""
        return nuisances[len(nuisances) - len(self.varies) :]

    def spreads(self) -> Array:
        """Standard deviations (D,) of the logarithms of what varies."""
        return np.array([PARAMETER_SPREAD[effect] for effect, _ in self.varies]) / np.sqrt(self.coarsening)

    def acting(self, parameters: Array) -> Array:
        """The parameters (R, B) without the effects that do not act in this recording."""
        if not self.complete and not self.lacks:
            return parameters
        parameters = parameters.copy()
        for row in parameter_rows():
            known = row.effect in self.declared or catalogue()[row.effect].family == "base"
            if row.effect in self.lacks or (self.complete and not known):
                parameters[row.index] = row.parameter.neutral
        return parameters

    def own(self, parameters: Array, nuisances: Array) -> Array:
        """The parameters (R, B) as they are in this recording."""
        parameters = self.acting(parameters)
        if not self.varies:
            return parameters
        parameters = parameters.copy()
        for name, deviation in zip(self.varies, self.deviations(nuisances), strict=True):
            parameters[parameter_index(*name)] *= np.exp(deviation)
        return parameters

    def memory(self, order: int, nuisances: Array) -> Array | None:
        """The initial memory (n, B) among the nuisances (M, B)."""
        return nuisances[2 * order : 3 * order] if self.begins_with_memory else None


@dataclass(frozen=True)
class Prediction(Appearance):
    """What instruments see of simulated individuals, with their batch."""

    batch: Batch = field(kw_only=True)


def predict(arm: Arm, experiment: Experiment, parameters: Array, nuisances: Array, step: float) -> Prediction:
    """The shapes of B simulated individuals, parameters (R, B) and nuisances (M, B), at the observed instants.

    InputError where the experiment's device needs NVIDIA Warp and it is not installed.
    """
    arm, n = experiment.arm(arm), arm.order
    parameters = experiment.own(parameters, nuisances)
    sight = sight_of(parameters)
    steps = int(np.ceil(experiment.duration / step)) + 1
    steps += steps % 2
    start = experiment.t0 if experiment.release is None else experiment.release
    base = base_table(experiment.base, Steps(start, step, steps), parameters, known_from=experiment.base_known_from)
    middles = Steps(start, step, steps).middles[:, None]
    base = _with_travel(base, experiment, sight.seen_times(middles))
    q, memory = arm.to_monomial @ nuisances[:n], experiment.memory(n, nuisances)
    rates = arm.to_monomial @ nuisances[n : 2 * n] if experiment.release is None else np.zeros_like(q)
    memory = None if memory is None else arm.to_monomial @ memory
    begin = Start(q=q, q_rate=rates, memory=memory, t0=start)
    batch = simulate_on(experiment.device, arm, parameters, base, Timing(step, 2), begin)
    times = sight.shown_times(experiment.observation.t[:, None])
    if experiment.release is not None:
        times = times - nuisances[n]
    if np.all(times == times[:, :1]):
        times = times[:, :1]
    q = at_times(batch.t, batch.q, batch.q_rate, times)
    theta = at_times(batch.t, batch.theta[:, None], batch.theta_rate[:, None], times)[:, 0] + arm.root_turn(q, 1)
    shift = experiment.shift(n, nuisances) + arm.specimen.length * np.array(sight.shift)
    motion = None
    if any(sensor.moves for sensor in experiment.observation.sensors):
        pull = _pull(experiment, gravity_of(arm, parameters), sight.seen_times(times))
        motion = motion_at(arm, batch, times, pull)
    none, zeros = np.zeros(batch.q.shape[2]), experiment.zeros(n, nuisances)
    return Prediction(q, theta, sight.roll + none, sight.excess + none, shift, zeros, motion, arm.askew, batch=batch)


def _pull(experiment: Experiment, gravity: Array, times: Array) -> Array:
    """Gravity (2, B) minus the acceleration of the base at times (T, B) or (T, 1) [s] of the pictures: (T, 2, B)."""
    if experiment.travel is None:
        return gravity[None]
    return gravity - np.moveaxis(experiment.travel(times)[4:6], 0, 1)


def _with_travel(base: Array, experiment: Experiment, times: Array) -> Array:
    """A base table (3, S, B) with the rows (6, S, B) of the base's travel; times (S, B) on the pictures' clock."""
    if experiment.travel is None:
        return base
    path = experiment.travel(times[:, :1] if np.all(times == times[:, :1]) else times)
    lanes = max(base.shape[2], path.shape[2])
    both = [np.broadcast_to(rows, (*rows.shape[:2], lanes)) for rows in (base, path)]
    return np.concatenate(both)


def whitened_residuals(experiment: Experiment, seen: Appearance) -> Array:
    """Measured minus predicted, whitened (T, K, B), over all frames."""
    return experiment.observation.predict(seen) / experiment.noise_gain[:, None]

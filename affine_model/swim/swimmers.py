"""Arms that swim step by step under commands: B individuals in one call of the compiled kernel.

A command u in [-1, 1] is an angle u A that the servo goes to. The servo is the filter (critically damped)

    theta'' = omega^2 (u A - theta) - 2 omega theta',   then, with a servo_lag tau,   tau theta_b' = theta - theta_b

with omega as large as keeps every command within the servo's limits: |theta'| <= 2 A omega/e and
|theta''| <= (2 + 4 e^-2) A omega^2 hold for any sequence of commands (the L1 norms of the filter's responses).

SIGN and GRAVITY as in affine_model.swim.trial: forward is -y, and the rail is level.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from affine_model.advance import Drive, Pace, Rail, State, advance, at_rest
from affine_model.arm import Arm, arm_of, parameter_index, parameter_vector, refuse_soft_sections
from affine_model.curvature import Array
from affine_model.swim.limits import HOBBY_SERVO
from affine_model.swim.trial import PAPER_RAIL
from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.servo_limits import ServoLimits

Flags = NDArray[np.bool_]

ITERATIONS = 2  # Newton corrections a step: an individual that was just reset has no prediction
LARGEST_OBSERVATION = 1e3  # bounds of the observation; an arm beyond them counts as lost
CAREFUL_STEPS = 2  # the kernel's first steps make more corrections; here the individuals differ in age, so none does


@dataclass(frozen=True)
class Tick:
    """The result of one command, (B,) each: forward [m], power [W] of the servo, lost: the arm left all bounds."""

    forward: Array
    power: Array
    lost: Flags


def servo_speed(limits: ServoLimits) -> float:
    """omega [rad/s] of the filter that keeps the limits whatever the commands are."""
    by_speed = limits.speed * np.e / (2.0 * limits.angle)
    by_acceleration = np.sqrt(limits.acceleration / ((2.0 + 4.0 * np.exp(-2.0)) * limits.angle))
    return float(min(by_speed, by_acceleration))


class Swimmers:
    """B arms on rails, each at its own time. Mutable: `command` moves them on, `reset` puts some back to rest."""

    def __init__(
        self,
        model: Model,
        count: int,
        *,
        rail: Rail = PAPER_RAIL,
        servo: ServoLimits = HOBBY_SERVO,
        interval: float = 0.05,
        substeps: int = 8,
    ) -> None:
        """interval [s] between commands, in that many steps of the kernel. InputError where the model cannot swim."""
        if model.fluid.density == 0.0:
            raise InputError("there is no water to swim in", field="fluid.density_kg_m3", expected="a positive number")
        if count < 1:
            raise InputError(f"{count} is too few", field="num_envs", expected="1 or more")
        arm = arm_of(model)
        self.arm: Arm = replace(arm, gravity=replace(arm.gravity, magnitude=0.0))
        row = parameter_vector(model)
        refuse_soft_sections(self.arm, row)
        if row[parameter_index("backlash", "play")] > 0.0:
            raise InputError("has no part in swimming here", field="backlash", expected="a model without it")
        self.count, self.interval, self.substeps = count, interval, substeps
        self.limits = servo
        self.parameters = np.repeat(row[:, None], count, axis=1)
        self._drive = Drive(rail=rail)
        step = interval / substeps
        self._pace = Pace(step, substeps, 0, ITERATIONS, CAREFUL_STEPS, True)
        lag = float(row[parameter_index("servo_lag", "tau")])
        self.filter = ServoFilter(servo_speed(servo), lag, step)
        self.servo_state = np.zeros((self.filter.size, count))
        self.times = np.zeros(count)
        self.state: State = at_rest(self.arm, count)
        self.target = np.zeros(count)

    def reset(self, which: Flags, angle: Array) -> None:
        """Put the individuals `which` (B,) bool at rest, straight, at base angles (their number,) [rad]."""
        for array in (self.state.u, self.state.u_rate, self.state.past, self.state.store):
            array[..., which] = 0.0
        self.servo_state[:, which] = 0.0
        self.servo_state[0, which] = angle
        if self.filter.size == 3:
            self.servo_state[2, which] = angle
        self.state.u[self.arm.order, which] = angle
        self.target[which], self.times[which] = angle, 0.0

    def command(self, share: Array) -> Tick:
        """Go to share (B,) in [-1, 1] of the largest angle for one interval."""
        self.target = np.clip(share, -1.0, 1.0) * self.limits.angle
        base, self.servo_state = self.filter.follow(self.servo_state, self.target, self.substeps)
        rail = self.arm.order + 1
        before = self.state.u[rail].copy()
        course = advance(self.arm, self._drive, self.parameters, base, (self.times, self.state), self._pace)
        self.state = State(*(np.ascontiguousarray(a[-1]) for a in (course.u, course.u_rate, course.past, course.store)))
        self.times = self.times + self.interval
        lost = course.summary[4] >= 0.0
        forward = np.where(lost, 0.0, before - self.state.u[rail])
        return Tick(forward, np.where(lost, 0.0, course.summary[2]), lost)

    def observed(self) -> Array:
        """The observation of a controller (B, 2 n + 4), scaled to about 1: angle, rate and target of the servo over
        their limits, curvatures [rad], their rates [10 rad/s], forward speed [0.1 m/s].
        """
        n, limits = self.arm.order, self.limits
        to_paper = self.arm.to_monomial
        servo = [self.servo_state[0] / limits.angle, self.servo_state[1] / limits.speed, self.target / limits.angle]
        q, rate = to_paper @ self.state.u[:n], to_paper @ self.state.u_rate[:n]
        seen = np.stack([*servo, *q, *(0.1 * rate), -10.0 * self.state.u_rate[n + 1]], axis=1)
        return np.clip(seen, -LARGEST_OBSERVATION, LARGEST_OBSERVATION)


class ServoFilter:
    """The servo as a linear system under a constant target, exact at the middles and ends of steps."""

    def __init__(self, omega: float, lag: float, step: float) -> None:
        """State: angle, rate, and, behind a lag [s], the clamp's own angle."""
        self.size, self._omega, self._lag = (3 if lag > 0.0 else 2), omega, lag
        a = np.zeros((self.size + 1, self.size + 1))  # the last column: the target
        a[0, 1] = 1.0
        a[1, :2], a[1, -1] = [-(omega**2), -2.0 * omega], omega**2
        if lag > 0.0:
            a[2, 0], a[2, 2] = 1.0 / lag, -1.0 / lag
        self._half, self._whole = expm(0.5 * step * a)[:-1], expm(step * a)[:-1]

    def follow(self, state: Array, target: Array, steps: int) -> tuple[Array, Array]:
        """The clamp's angle, rate and acceleration (3, S, B) at the steps' middles, and the state at the end."""
        base = np.empty((3, steps, target.size))
        for k in range(steps):
            given = np.concatenate([state, target[None]])
            base[:, k] = self._motion(self._half @ given, target)
            state = self._whole @ given
        return base, state

    def _motion(self, state: Array, target: Array) -> Array:
        angle, rate = state[0], state[1]
        if self._lag <= 0.0:
            return np.stack([angle, rate, self._omega**2 * (target - angle) - 2.0 * self._omega * rate])
        lagged_rate = (angle - state[2]) / self._lag
        return np.stack([state[2], lagged_rate, (rate - lagged_rate) / self._lag])

"""Moments of the material at the hinges: elastic, viscous, a Maxwell branch, and dry friction (compiled).

Each law gives its moment at the middle of a step and its slope there, so that the step can be implicit in it. Dry
friction is a spring that yields (an elastoplastic bristle): independent of the rate, with hysteresis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mujoco_ref.chain import Chain
from mujoco_ref.influence import HINGE, Fields, Parameters, Record, value
from mujoco_ref.step_arguments import Equation, Midpoint, Now
from tentacle.compiled import njit
from tentacle.signals import Array

# Columns of a hinge's memory: the bristle's stretch, the Maxwell branch's dashpot [rad].
BRISTLE, DASHPOT = range(2)
SOFT_SPOT_WIDTH = 0.08  # standard deviation along s of its compliance (catalogue)
PRESLIDING = 0.25  # of c_f, where no slip is given: the bristle must be stiff against the arm, yet resolved


def soft_spot(parameters: Parameters, s: Array) -> Array:
    """Factor on k(s): a Gaussian compliance around s0 is added to the arm's own."""
    depth, place = value(parameters, "soft_spot", "depth"), value(parameters, "soft_spot", "s0", 0.3)
    return (1.0 - depth) / (1.0 - depth + depth * np.exp(-0.5 * ((s - place) / SOFT_SPOT_WIDTH) ** 2))


def hinge_records(chain: Chain, parameters: Parameters) -> Record:
    """The hinges' laws (n,); the chain's stiffness already has its soft spot.

    Friction and the Maxwell branch scale with the local stiffness k: friction moment k c_f, branch g k (catalogue).
    """
    made = np.zeros(chain.links, HINGE)
    made["stiffness"], made["damping"] = chain.stiffness, chain.damping
    uneven = 1.0 + value(parameters, "intrinsic_curvature", "slope") * (chain.hinge_s - 0.5)
    made["rest"] = value(parameters, "intrinsic_curvature", "c0") * uneven / chain.sharpness
    made["cubic"] = value(parameters, "cubic_stiffness", "beta") * chain.sharpness**2
    c_f = value(parameters, "dry_friction", "c_f")
    sliding = value(parameters, "dry_friction", "sliding")
    made["yield_moment"] = chain.stiffness / chain.sharpness * c_f * (1.0 - sliding)
    made["sliding_moment"] = chain.stiffness / chain.sharpness * c_f * sliding
    made["sliding_rate"] = value(parameters, "dry_friction", "rate", 0.5) / chain.sharpness
    slip = value(parameters, "dry_friction", "slip", PRESLIDING * c_f)  # curvature at which it gives way
    made["yield_angle"] = max(slip, 1e-9) / chain.sharpness
    made["maxwell"] = value(parameters, "viscoelasticity", "g") * chain.stiffness
    made["relaxation"] = value(parameters, "viscoelasticity", "tau", 0.3)
    made["bent_loss"] = value(parameters, "amplitude_damping", "b") * chain.sharpness**2
    return made


@dataclass(frozen=True)
class Drift:
    """Relative change of the stiffness, rate [1/s] at first; it settles at a rate [1/s] (0: never)."""

    rate: float = 0.0
    settling: float = 0.0

    def factor(self, t: float) -> float:
        """Stiffness at t [s] over that at t = 0."""
        if self.settling == 0.0:
            return 1.0 + self.rate * t
        return 1.0 - self.rate * float(np.expm1(-self.settling * t)) / self.settling


@njit(cache=True)
def relaxed(stretch: Any, rate: Any, duration: float, tau: float) -> Any:
    """A Maxwell branch's spring after `duration` [s] at a steady rate: exactly stretch' = rate - stretch / tau."""
    lost = -np.expm1(-duration / tau)
    return (1.0 - lost) * stretch + tau * lost * rate


@njit(cache=True)
def bristle(stretch: float, limit: float) -> tuple[float, float]:
    """A spring's stretch cut at its limit, and 1 where it sticks, 0 where it slides."""
    if stretch > limit:
        return limit, 0.0
    if stretch < -limit:
        return -limit, 0.0
    return stretch, 1.0


@njit(cache=True)
def hinge_moments(course: Midpoint, hinges: Fields, memory: Array, now: Now, equation: Equation) -> None:
    """Add the moments at the middle of a step to force (n + 3,) and half_step damping + step^2/4 slope to matrix.

    memory (n, 2) at the step's start. Angles count from those at rest.
    """
    start, middle, rate = course.start, course.middle, course.rate
    force, matrix = equation.force, equation.matrix
    half, softening = 0.5 * now.step, now.softening
    for j in range(hinges.shape[0]):
        hinge = hinges[j]
        i = j + 3
        angle = middle[i] - hinge.rest
        stiffness = softening * hinge.stiffness
        moment = stiffness * (angle + hinge.cubic * angle**3)
        slope = stiffness * (1.0 + 3.0 * hinge.cubic * angle**2)
        damping = hinge.damping + stiffness * hinge.bent_loss * angle**2
        if hinge.maxwell != 0.0:
            turned = (middle[i] - start[i]) / half
            stretch = relaxed(start[i] - memory[j, DASHPOT], turned, half, hinge.relaxation)
            moment += softening * hinge.maxwell * stretch
            slope += softening * hinge.maxwell * relaxed(0.0, 1.0 / half, half, hinge.relaxation)
        if hinge.yield_moment != 0.0:
            stretch, sticks = bristle(memory[j, BRISTLE] + middle[i] - start[i], hinge.yield_angle)
            moment += softening * hinge.yield_moment * stretch / hinge.yield_angle
            slope += softening * sticks * hinge.yield_moment / hinge.yield_angle
        slope += 2.0 * stiffness * hinge.bent_loss * angle * rate[i]
        force[i] -= moment + damping * rate[i]
        if hinge.sliding_moment != 0.0:
            grip = np.tanh(rate[i] / hinge.sliding_rate)
            force[i] -= softening * hinge.sliding_moment * grip
            damping += softening * hinge.sliding_moment * (1.0 - grip * grip) / hinge.sliding_rate
        matrix[i, i] += half * damping + half * half * slope


@njit(cache=True)
def remember(start: Array, end: Array, hinges: Fields, memory: Array, step: float) -> None:
    """Carry the hinges' memory (n, 2) over a step from start to end (n + 3,)."""
    for j in range(hinges.shape[0]):
        hinge = hinges[j]
        if hinge.maxwell != 0.0:
            turned = (end[j + 3] - start[j + 3]) / step
            stretch = relaxed(start[j + 3] - memory[j, DASHPOT], turned, step, hinge.relaxation)
            memory[j, DASHPOT] = end[j + 3] - stretch
        if hinge.yield_moment != 0.0:
            stretch, _ = bristle(memory[j, BRISTLE] + end[j + 3] - start[j + 3], hinge.yield_angle)
            memory[j, BRISTLE] = stretch

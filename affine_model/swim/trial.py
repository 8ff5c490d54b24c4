"""A swimming trial: a batch of gaits, run by the compiled kernel, and the thrust, speed and power of each.

SIGN, stated here once: the arm hangs from its base towards +y, and swims base first. So thrust and speed are called
forward where they point along -y, away from the tip; every forward quantity in this package is the negative of a y
component.

GRAVITY on the rail: the rail is level and the arm swings in the horizontal plane, so gravity has no part in that plane
(a vertical rail would have to carry the weight). With the base clamped gravity is as the model declares it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from affine_model.advance import Drive, Pace, Rail
from affine_model.arm import Arm, arm_of, parameter_vector, refuse_soft_sections
from affine_model.curvature import Array
from affine_model.swim.evaluate import evaluate
from affine_model.swim.gaits import gait_tables
from affine_model.swim.limits import GaitLimits
from tentacle.errors import InputError
from tentacle.model import Model

# The carriage of the swimming set-up (paper Fig. 7c). The paper states no friction; with these numbers a 21 cm arm of
# Dragon Skin 10 at pi/6 and 3 rad/s swims at the 0.52 cm/s of its Table II. Ratios of speeds depend on them far less
# than speeds.
PAPER_RAIL = Rail(mass=0.25, viscous=0.35)


@dataclass(frozen=True)
class GaitTrial:
    """How gaits are tried.

    arm, parameters (R, K): K samples of the model's parameters, every gait is run on each. settle [s] is left out of
    the means, window [s] is averaged over. rail: see on_rail; None clamps the base. step [s]: set by accuracy alone.
    device: where torch runs the batches ("cpu", "cuda:0"); None calls the compiled kernel on numpy arrays.
    """

    arm: Arm
    parameters: Array
    limits: GaitLimits = field(default_factory=GaitLimits)
    rail: Rail | None = None
    settle: float = 2.0
    window: float = 6.0
    step: float = 1.0 / 120.0
    device: str | None = None

    @property
    def settled(self) -> int:
        """Steps that are left out of the means, even."""
        return 2 * round(0.5 * self.settle / self.step)

    @property
    def steps(self) -> int:
        """Steps of one run, even."""
        return 2 * round(0.5 * (self.settle + self.window) / self.step)

    def on_rail(self, rail: Rail) -> GaitTrial:
        """The same trial with the base sliding on a level rail."""
        arm = replace(self.arm, gravity=replace(self.arm.gravity, magnitude=0.0))
        return replace(self, arm=arm, rail=rail)

    def refined(self, seconds: float = 12.0) -> GaitTrial:
        """The same trial, more accurate and slower: more nodes, a third of the step, a window of `seconds`."""
        arm = replace(self.arm, nodes=max(8, self.arm.nodes + 2))
        return replace(self, arm=arm, step=self.step / 3.0, window=seconds, settle=max(self.settle, 3.0))


@dataclass(frozen=True)
class GaitOutcome:
    """What B gaits achieve on K parameter samples, means over the window.

    alpha (9, B): the gaits as run, amplitudes already scaled to the servo's limits. thrust (B, K) [N] and speed (B, K)
    [m/s] forward (speed is zero without a rail), power (B, K) [W] that the servo gives to the arm, torque (B, K) [N m]
    its peak; diverged (B, K) bool.
    """

    alpha: Array
    thrust: Array
    speed: Array
    power: Array
    torque: Array
    diverged: Array


def trial_of(model: Model, limits: GaitLimits | None = None, rail: Rail | None = None, nodes: int = 6) -> GaitTrial:
    """The trial of a model at its estimates, augmented models as they are; InputError on unusable stiffness."""
    arm, parameters = replace(arm_of(model), nodes=max(nodes, model.order + 3)), parameter_vector(model)
    refuse_soft_sections(arm, parameters)
    if model.fluid.density == 0.0:
        raise InputError("there is no water to swim in", field="fluid.density_kg_m3", expected="a positive number")
    trial = GaitTrial(arm, parameters[:, None], limits or GaitLimits())
    return trial if rail is None else trial.on_rail(rail)


def within_limits(alpha: Array, limits: GaitLimits, seconds: float, step: float) -> Array:
    """Gaits (9, B), amplitudes scaled down where angle, speed or acceleration leave the limits in that time."""
    _, peaks = gait_tables(alpha, round(seconds / step) + 1, step, limits.bandwidth)
    scaled = np.array(alpha, dtype=float)
    scaled[:3] *= limits.bounds.scale(peaks)
    return scaled


def run(trial: GaitTrial, alpha: Array) -> GaitOutcome:
    """Try gaits alpha (9, B), scaled to the servo's limits first."""
    alpha = np.atleast_2d(np.asarray(alpha, dtype=float).T).T
    genes = np.ascontiguousarray(alpha.T)
    own = trial.arm, Drive(rail=trial.rail)
    bounds, timing = trial.limits.bounds, (Pace(trial.step, 2, trial.settled), trial.steps)
    if trial.device is None:
        found = evaluate(*own, genes, trial.parameters, bounds, timing)
    else:
        import torch

        from affine_model.swim.torch_evaluate import population, swum

        given = population(genes, trial.device), torch.from_numpy(trial.parameters)
        found = swum(*own, *given, bounds, timing).cpu().numpy()
    return outcome_of(alpha, found)


def outcome_of(alpha: Array, rows: Array) -> GaitOutcome:
    """The outcome of gaits (9, B) from the rows (6, B, K) of affine_model.swim.evaluate."""
    thrust, speed, power, torque, lost, scale = rows
    scaled = np.array(alpha)
    scaled[:3] *= scale[:, 0]
    sound = lost < 0.0
    return GaitOutcome(
        alpha=scaled,
        thrust=np.where(sound, thrust, np.nan),
        speed=speed,
        power=np.where(sound, power, np.nan),
        torque=torque,
        diverged=~sound,
    )

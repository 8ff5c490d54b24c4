"""A swimming trial: a batch of gaits, run by the compiled kernel, and the thrust, speed and power of each.

SIGN, stated here once: the arm hangs from its base towards +y, and swims base first. So thrust and speed are called
forward where they point along -y, away from the tip; every forward quantity in this package is the negative of a y
component.

GRAVITY on the rail and afloat: the arm swings in the horizontal plane, so gravity has no part in that plane (a vertical
rail would have to carry the weight). With the base clamped gravity is as the model declares it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from affine_model.advance import Drive, Pace, Rail, advance
from affine_model.arm import Arm, arm_of, parameter_index, parameter_vector, refuse_soft_sections
from affine_model.curvature import Array
from affine_model.free_body import Hull
from affine_model.swim.evaluate import evaluate
from affine_model.swim.free import HullCourse, hull_course, launched, yaw_drift
from affine_model.swim.gaits import gait_tables
from affine_model.swim.limits import GaitLimits
from tentacle.errors import InputError
from tentacle.model import Model

# The carriage of the swimming set-up (paper Fig. 7c). The paper states no friction; with these numbers a 21 cm arm of
# Dragon Skin 10 at pi/6 and 3 rad/s swims at the 0.52 cm/s of its Table II. Ratios of speeds depend on them far less
# than speeds.
PAPER_RAIL = Rail(mass=0.25, viscous=0.35)
# A sealed servo with its battery, of the carriage's mass and the water's density: a box 10 cm long, 5 cm wide and high
# (mass and inertia with a fifth more for the water that it carries). Its drag is that of its faces, with coefficients
# of 0.8 along, 1.2 across and about the axis (Hoerner 1965, ch. 3: blunt boxes), in water.
FREE_SETTLE = 8.0  # s: a 21 cm arm that swims 8 cm/s is then within 1 % of its speed, one of 1 cm/s half-way to it
SERVO_HULL = Hull(mass=0.3, yaw_inertia=3.1e-4, drag_across=3.0, drag_along=1.0, yaw_drag=9.4e-5)


@dataclass(frozen=True)
class GaitTrial:
    """How gaits are tried.

    arm, parameters (R, K): K samples of the model's parameters, every gait is run on each. settle [s] is left out of
    the means, window [s] is averaged over. rail: see on_rail; None clamps the base. hull: as declared for free
    swimming; free: it floats, see afloat. step [s]: set by accuracy alone.
    device: where torch runs the batches ("cpu", "cuda:0"); None calls the compiled kernel on numpy arrays.
    """

    arm: Arm
    parameters: Array
    limits: GaitLimits = field(default_factory=GaitLimits)
    rail: Rail | None = None
    hull: Hull = SERVO_HULL
    free: bool = False
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

    def afloat(self) -> GaitTrial:
        """The same trial with the hull free in x, y and yaw in a level plane; it takes longer to get up to speed.

        InputError where a law depends on the place of a wall, or the device is a GPU.
        """
        if np.any(self.parameters[parameter_index("wall", "B")] != 0.0):
            raise InputError("a free hull swims through it", field="wall", expected="a model without it")
        if (self.device or "cpu").startswith("cuda"):
            raise InputError("a free hull swims on the CPU alone", field="device", expected="cpu")
        arm = replace(self.arm, gravity=replace(self.arm.gravity, magnitude=0.0))
        return replace(self, arm=arm, rail=None, free=True, device=None, settle=max(self.settle, FREE_SETTLE))

    @property
    def drive(self) -> Drive:
        """What the base is."""
        return Drive(hull=self.hull) if self.free else Drive(rail=self.rail)

    def refined(self, seconds: float = 12.0) -> GaitTrial:
        """The same trial, more accurate and slower: more nodes, a third of the step, a window of `seconds`."""
        arm, settle = replace(self.arm, nodes=max(8, self.arm.nodes + 2)), max(self.settle, 3.0)
        settle = 2.0 * settle if self.free else settle
        return replace(self, arm=arm, step=self.step / 3.0, window=seconds, settle=settle)


@dataclass(frozen=True)
class GaitOutcome:
    """What B gaits achieve on K parameter samples, means over the window.

    alpha (9, B): the gaits as run, amplitudes already scaled to the servo's limits. thrust (B, K) [N] and speed (B, K)
    [m/s] forward (speed is zero with the base clamped; afloat, thrust is along the first heading), power (B, K) [W]
    that the servo gives to the arm, torque (B, K) [N m] its peak; diverged (B, K) bool.
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
    own = trial.arm, trial.drive
    bounds, timing = trial.limits.bounds, (Pace(trial.step, 2, trial.settled), trial.steps)
    if trial.device is None:
        found = evaluate(*own, genes, trial.parameters, bounds, timing)
    else:
        import torch

        from affine_model.swim.torch_evaluate import population, swum

        given = population(genes, trial.device), torch.from_numpy(trial.parameters)
        found = swum(*own, *given, bounds, timing).cpu().numpy()
    return outcome_of(alpha, found)


def swum_freely(trial: GaitTrial, alpha: Array) -> tuple[HullCourse, Array]:
    """The hull's course under gaits (9, B) that keep the servo's limits, from rest, at every second step, by the first
    sample of the parameters; and the yaw drift (B,) [rad/s] over the window.
    """
    pace, arm, drive, count = Pace(trial.step, 2), trial.arm, trial.drive, alpha.shape[1]
    base, _ = gait_tables(alpha, trial.steps, trial.step, trial.limits.bandwidth, 0.5 * trial.step)
    kept, _ = gait_tables(alpha, trial.steps // 2 + 1, 2.0 * trial.step, trial.limits.bandwidth)
    start = np.zeros(count), launched(arm, drive, kept[:, 0])
    course = advance(arm, drive, np.repeat(trial.parameters[:, :1], count, axis=1), base, start, pace)
    whole, seconds = hull_course(arm, course.u, kept[0]), (trial.steps - trial.settled) * trial.step
    return whole, yaw_drift(whole.after(trial.settled // 2), seconds)


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

"""One call of the compiled kernel on raw arrays.

It takes a state, and returns the course of the motion and the state at its end. Both simulate (numpy) and
torch_operator (torch) call it. The state of B individuals is four arrays: u and u_rate (D, B), the curvatures in
Legendre coordinates, the base angle [rad] and the rail [m], D = n + 2, and of a free hull also its x [m], D = n + 3;
past (2 D + 1, B), the mean accelerations of the last two
steps, from which the next is predicted, and the integral of the servo's error; store (S, N, B), the memory [rad] of
every effect that has one, at every node.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array
from affine_model.dynamics import remembering
from affine_model.effects import catalogue
from affine_model.free_body import Hull
from affine_model.kernel import advance_blocks
from tentacle.errors import InputError

CONSTANTS = (
    "length", "density", "fluid_density", "payload", "gravity", "payload_reach", "payload_drop", "payload_density",
    "gravity_angle",
)  # fmt: skip


@dataclass(frozen=True)
class Servo:
    """PID servo: stiffness [N m/rad], integral [N m/(rad s)], damping [N m s/rad], torque_limit [N m],
    rotor_inertia [kg m^2].
    """

    stiffness: float
    damping: float
    torque_limit: float
    integral: float = 0.0
    rotor_inertia: float = 1e-5


@dataclass(frozen=True)
class Rail:
    """The base slides along y: carriage mass [kg], viscous friction [N s/m], dry friction [N],
    smoothed at slip_speed [m/s].
    """

    mass: float
    viscous: float = 0.0
    dry: float = 0.0
    slip_speed: float = 1e-3


@dataclass(frozen=True)
class Drive:
    """What moves the base: a servo (None: it turns as prescribed), a rail (None: it is clamped), or a free hull
    against which it turns as prescribed, alone.
    """

    servo: Servo | None = None
    rail: Rail | None = None
    hull: Hull | None = None

    def __post_init__(self) -> None:
        if self.hull is not None and (self.servo is not None or self.rail is not None):
            raise InputError("a free hull has neither rail nor torque servo", field="drive", expected="a hull alone")

    def coordinates(self, order: int) -> int:
        """D: curvatures, base angle, y, and of a free hull x."""
        return order + 2 + (self.hull is not None)

    def rows(self) -> tuple[Array, Array]:
        """The kernel's numbers of the servo (5,) and of the rail (4,) or hull (8,); neutral where there is none."""
        servo, rail = self.servo, self.rail
        angle = [0.0] * 5
        if servo is not None:
            angle = [servo.stiffness, servo.integral, servo.damping, servo.torque_limit, servo.rotor_inertia]
        if self.hull is not None:
            return np.array(angle), self.hull.row
        slide = [0.0, 0.0, 0.0, 1.0] if rail is None else [rail.mass, rail.viscous, rail.dry, rail.slip_speed]
        return np.array(angle), np.array(slide)


PRESCRIBED = Drive()


@dataclass(frozen=True)
class Pace:
    """How a batch is stepped: step [s]; stride: every stride-th state is kept, 0 keeps none; average_from: the first
    step of the means; iterations: Newton corrections a step; age: number of steps before this call (the first two steps
    have no prediction, so they make three more corrections); complete: past and store are kept too; every_effect: on a
    CUDA device one kernel has all effects of the catalogue, the absent ones at strength zero (else: one a set of acting
    effects; the compiled kernel on the CPU has them all).
    """

    step: float
    stride: int = 1
    average_from: int = 0
    iterations: int = 1
    age: int = 0
    complete: bool = False
    every_effect: bool = False


@dataclass(frozen=True)
class State:
    """u, u_rate, past, store as above."""

    u: Array
    u_rate: Array
    past: Array
    store: Array


@dataclass(frozen=True)
class Course:
    """K intervals of `stride` steps. u, u_rate (K + 1, D, B), the first as given; force (max(K, 1), 4, B): means of
    fluid force x and y [N], of the load along y [N] and of the torque [N m]; past (K, 2 D + 1, B) and store
    (K, S, N, B) at the intervals' ends, empty unless asked for.

    summary (2 D + 5, B): means from average_from on of fluid force x and y, power and positive power [W]; the time of
    divergence, -1 where there was none; u and u_rate at the end.
    """

    u: Array
    u_rate: Array
    force: Array
    past: Array
    store: Array
    summary: Array


def at_rest(arm: Arm, count: int, drive: Drive = PRESCRIBED) -> State:
    """B straight arms without motion or memory."""
    size, slots = drive.coordinates(arm.order), remembering(tuple(catalogue().values()))
    still = np.zeros((size, count))
    return State(still, still.copy(), np.zeros((2 * size + 1, count)), np.zeros((len(slots), arm.node_count, count)))


def shapes(arm: Arm, drive: Drive, count: int, steps: int, pace: Pace) -> Course:
    """A Course of empty arrays, for `advance` to write into."""
    size, slots = drive.coordinates(arm.order), len(remembering(tuple(catalogue().values())))
    kept = steps // pace.stride if pace.stride else 0
    whole = kept if pace.complete else 0
    return Course(
        np.zeros((kept + 1, size, count)),
        np.zeros((kept + 1, size, count)),
        np.zeros((max(kept, 1), 4, count)),
        np.zeros((whole, 2 * size + 1, count)),
        np.zeros((whole, slots, arm.node_count, count)),
        np.zeros((2 * size + 5, count)),
    )


def advance(arm: Arm, drive: Drive, parameters: Array, base: Array, start: tuple[Array, State], pace: Pace) -> Course:
    """Step B individuals through the rows of base (3, S, B or 1), from their times (B,) [s] and states.

    parameters (R, B). All arrays are float64 and in C order, and are read where they lie.
    """
    times, state = start
    n, count, steps, free = arm.order, parameters.shape[1], base.shape[1], drive.hull is not None
    course = shapes(arm, drive, count, steps, pace)
    acting = {effect.name for effect in active_effects(parameters)}
    active = np.array([name in acting for name in catalogue()])
    known = arm_arrays(arm, drive)
    constants = np.array([known[k] for k in CONSTANTS])
    section = (known[k] for k in ("s", "area", "second_moment", "width", "perimeter"))
    rules = (known[k] for k in ("W", "Lw", "w", "bending", "A", "A_end", "C", "WA", "wA"))
    advance_blocks(
        arm.node_count, n, count, parameters, active, constants, *section, *rules, base, known["servo"], known["rail"],
        drive.servo is not None or free, drive.rail is not None or free, pace.step, steps, pace.age,
        times, state.u, state.u_rate, state.past, state.store, pace.iterations, pace.stride, pace.average_from,
        course.u, course.u_rate, course.force, course.past, course.store, course.summary,
        free=free,
    )  # fmt: skip
    return course


@lru_cache(maxsize=64)
def arm_arrays(arm: Arm, drive: Drive) -> dict[str, Any]:
    """The numbers of arm and drive, under the names that the kernels' text uses."""
    angle, curvature, end = _columns(arm)
    at_nodes, at_tip = _levers(arm)
    length, rule = arm.specimen.length, arm.rule
    servo, rail = drive.rows()
    return {
        **arm.node_quantities, **{k: float(v) for k, v in arm.arm_quantities.items()},
        "gravity_angle": float(arm.gravity.angle), "W": rule.integration, "Lw": length * rule.weights,
        "w": rule.weights, "bending": arm.bending_weights, "A": angle, "A_end": end, "C": curvature,
        "WA": at_nodes, "wA": at_tip, "servo": servo, "rail": rail,
    }  # fmt: skip


def _columns(arm: Arm) -> tuple[Array, Array, Array]:
    """d phi / du and dc / du at the nodes (N, n + 2), d phi / du at s = 1 (n + 2,)."""
    n = arm.order
    nodes = arm.node_count
    angle, curvature, end = np.zeros((nodes, n + 2)), np.zeros((nodes, n + 2)), np.zeros(n + 2)
    end[:n], end[n] = arm.sections_at([1.0])[0], 1.0
    angle[:, :n], angle[:, n], curvature[:, :n] = arm.angle_basis, 1.0, arm.curvature_basis
    return angle, curvature, end


def _levers(arm: Arm) -> tuple[Array, Array]:
    """What a unit of each coordinate's angle moves, over L: -W A at every node (n + 1, N, N), and -w A, the tip."""
    angle = _columns(arm)[0][:, : arm.order + 1]
    at_nodes = -arm.rule.integration[None] * angle.T[:, None, :]
    return np.ascontiguousarray(at_nodes), np.ascontiguousarray(-arm.rule.weights * angle.T)

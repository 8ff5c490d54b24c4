"""Simulate the reference: a model's arm, moved at its base, in its fluid.

Signs: `thrust` is the y component of the water's force on the arm (eq. 17), so a positive thrust pulls the arm
away from the clamp, along +y of the base frame; an arm that swims forward, base first, has a negative one. `load_cell`
is the force of the arm on its mount along the same +y (thrust, weight and inertia together), less its reading at rest.
On average over a period of steady motion the two agree.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from mujoco_ref.chain import Flexure, Hung, build_chain, flexural, hinge_positions
from mujoco_ref.chain_state import ChainState
from mujoco_ref.hinges import Drift, hinge_records, soft_spot
from mujoco_ref.influence import Parameters, refuse_unknown, tip_record, value, water_record
from mujoco_ref.midline import chain_midline_points
from mujoco_ref.motor import motor_signal
from mujoco_ref.mount import MountHull, MountRail, MountServo, base_record
from mujoco_ref.statics import chain_equilibrium
from mujoco_ref.step import Stepper
from mujoco_ref.step_arguments import Laws
from mujoco_ref.written_laws import WrittenLaws, acting_laws
from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.signals import Array, Midline
from tentacle.specimen import Gravity, declared_effects
from tentacle.waveform import Waveform

DEFAULT_LINKS = 20
LONGEST_STEP = 4e-3  # [s]; halving it moves the tip of a usual arm by 1 micrometre (tests/mujoco_ref/test_step.py)
MOST_HALVINGS = 3  # of the step, for an arm whose motion is too fast for it
LARGEST_HINGE_ANGLE = np.pi  # [rad]; hinges of real arms bend by a fraction of a turn
# Silicones reach from 10 kPa to some MPa; beyond these bounds the unit is wrong (Pa, not MPa).
SOFTEST, STIFFEST = 1e3, 1e9


@dataclass(frozen=True)
class Clock:
    """Steps and frames: step [s], substeps a frame, first step that is a frame, frames (F,) and half steps (2 S + 1,)
    [s]."""

    step: float
    substeps: int
    first: int
    frames: Array
    half_steps: Array

    @staticmethod
    def of(duration: float, fps: float, lead_in: float, longest_step: float) -> Clock:
        """Frames from 0 to duration, steps no longer than longest_step, the lead-in before them."""
        substeps = int(np.ceil(1.0 / (fps * longest_step) - 1e-9))
        count = int(np.floor(duration * fps + 1e-9)) + 1
        step = 1.0 / (fps * substeps)
        first = int(np.ceil(lead_in * fps - 1e-9)) * substeps
        half_steps = 0.5 * step * np.arange(-2 * first, 2 * count * substeps + 1, dtype=float)
        return Clock(step, substeps, first, step * substeps * np.arange(count, dtype=float), half_steps)


@dataclass(frozen=True)
class Simulation:
    """The reference's motion and forces at the frames.

    t (F,) [s]; command, theta (F,) [rad] the motor's angle and the clamp's; angles (F, n + 1) tangent angle at s = k/n
    [rad];
    mount (F, 2) [m] where the clamp is; midline in the base frame (sigma zero); thrust, load_cell (F,) [N], see above;
    force_x (F,) [N] the arm's force on the mount along x; torque (F,) [N m] the motor's on the arm.
    """

    t: Array
    command: Array
    theta: Array
    angles: Array
    mount: Array
    midline: Midline
    thrust: Array
    load_cell: Array
    force_x: Array
    torque: Array


@dataclass(frozen=True)
class Initial:
    """The shape of eq. 1 that a run starts from, q (K,) [rad] (None: the equilibrium), moving at q_rate (K,) [rad/s]
    (None: at rest), held until release_t [s] (None: free at once).
    """

    q: Array | None = None
    q_rate: Array | None = None
    release_t: float | None = None


@dataclass(frozen=True)
class Setup:
    """The set-up of a run. links: hinges of the chain. The base is prescribed or turned by a servo; it is fixed, on a
    rail along y, a hull that floats (from rest), or travels: x, y [m], rates and accelerations (6, ...) over time [s].
    s (P,): where the midline is sampled (None: 41 points). lead_in [s]: the arm moves for that long before the first
    frame, the motion swelling from nothing. longest_step [s].
    """

    links: int = DEFAULT_LINKS
    servo: MountServo | None = None
    rail: MountRail | MountHull | None = None
    s: Array | None = None
    lead_in: float = 0.0
    longest_step: float = LONGEST_STEP
    initial: Initial = field(default_factory=Initial)
    travel: Callable[[Array], Array] | None = None


USUAL_SETUP = Setup()


def plain_parameters(model: Model) -> dict[str, dict[str, float]]:
    """A model's parameters as plain numbers, which override those of its declaration."""
    own = {effect: {name: e.value for name, e in values.items()} for effect, values in model.parameters.items()}
    return merged(declared_effects(model.specimen, model.fluid), own)


def merged(parameters: Parameters, extra: Parameters) -> dict[str, dict[str, float]]:
    """Two sets of parameters; where both have one, extra's counts."""
    effects = [*parameters, *(effect for effect in extra if effect not in parameters)]
    return {effect: {**parameters.get(effect, {}), **extra.get(effect, {})} for effect in effects}


def _refuse_wrong_units(parameters: Parameters) -> None:
    modulus = value(parameters, "elasticity", "E")
    if modulus != 0.0 and not SOFTEST <= modulus <= STIFFEST:
        expected = f"Pa, between {SOFTEST:g} and {STIFFEST:g} (0.2 MPa is 2e5)"
        raise InputError(f"{modulus:g} is no silicone's", field="elasticity.E", expected=expected)


def make_stepper(
    model: Model,
    hidden: Parameters | None = None,
    *,
    links: int = DEFAULT_LINKS,
    servo: MountServo | None = None,
    rail: MountRail | MountHull | None = None,
) -> Stepper:
    """The chain of a model, with the model's own effects and the hidden ones.

    InputError where an effect or parameter is unknown, k(s) <= 0 somewhere, links < 2, or a unit is plainly wrong.
    """
    parameters = merged(plain_parameters(model), hidden or {})
    refuse_unknown(parameters)
    _refuse_wrong_units(parameters)
    declared = model.specimen
    density = declared.density + value(parameters, "buoyancy", "density_error")
    specimen = replace(
        declared,
        density=density,
        tip_mass_reach=declared.tip_mass_reach + value(parameters, "payload_place", "along"),
        tip_mass_drop=declared.tip_mass_drop + value(parameters, "payload_place", "aside"),
    )
    angle = model.gravity.angle + value(parameters, "gravity_tilt", "tilt")
    gravity = Gravity(angle, model.gravity.magnitude)
    s = hinge_positions(specimen, links)
    k0, k1 = value(parameters, "elasticity", "k0"), value(parameters, "elasticity", "k1")
    stiffness = flexural(specimen, s, value(parameters, "elasticity", "E"), k0, k1) * soft_spot(parameters, s)
    d0, d1 = value(parameters, "damping", "d0"), value(parameters, "damping", "d1")
    damping = flexural(specimen, s, value(parameters, "damping", "eta"), d0, d1)
    reach = specimen.length * value(parameters, "tip_mass", "reach")
    drop = specimen.length * value(parameters, "tip_mass", "drop")
    hung = Hung(value(parameters, "tip_mass", "mass"), reach, drop, density=specimen.tip_mass_density)
    base, mount = base_record(parameters, servo, rail, specimen.mass + specimen.tip_mass + hung.mass)
    chain = build_chain(specimen, Flexure(stiffness, damping, links), model.fluid, gravity, hung, mount)
    pull = (gravity.magnitude * np.sin(gravity.angle), gravity.magnitude * np.cos(gravity.angle))
    water = water_record(parameters, model.fluid.density, specimen.length, pull)
    tip = tip_record(parameters, specimen.length)
    drift = Drift(value(parameters, "stiffness_drift", "rate"), value(parameters, "stiffness_drift", "settling"))
    acting = acting_laws(parameters)
    written = WrittenLaws(acting, chain, water, gravity.magnitude) if acting else None
    return Stepper(chain, Laws(hinge_records(chain, parameters), water, tip, base), drift, written)


def state_of_shape(stepper: Stepper, q: Array, theta: float = 0.0, q_rate: Array | None = None) -> ChainState:
    """In the shape c(s) = q1 + q2 s + ... (eq. 1), q (K,) [rad], changing at q_rate (K,) [rad/s] (default: at rest)."""
    state = ChainState.at_rest(stepper.chain.links, theta)
    curvature = np.polynomial.polynomial.polyval(stepper.chain.hinge_s, np.asarray(q, dtype=float))
    state.q[3:] = curvature / stepper.chain.sharpness
    state.hinge_memory[:, 1] = state.q[3:]
    if q_rate is not None:
        change = np.polynomial.polynomial.polyval(stepper.chain.hinge_s, np.asarray(q_rate, dtype=float))
        state.v[3:] = change / stepper.chain.sharpness
    return state


def simulate(
    model: Model,
    waveform: Waveform,
    duration: float,
    fps: float,
    *,
    hidden: Mapping[str, Mapping[str, float]] | None = None,
    setup: Setup = USUAL_SETUP,
) -> Simulation:
    """Simulate `duration` [s] of a model's arm whose motor follows the waveform, with `fps` frames a second.

    Deterministic: nothing here is random. hidden: effects (name -> parameter -> value) that act beside the model's own.
    InputError for an unusable duration, fps or model.
    """
    for name, number in (("duration", duration), ("fps", fps), ("longest_step", setup.longest_step)):
        if not (np.isfinite(number) and number > 0.0):
            raise InputError(f"{number!r} is not usable", field=name, expected="a positive number")
    stepper = make_stepper(model, hidden, links=setup.links, servo=setup.servo, rail=setup.rail)
    sampled = np.linspace(0.0, 1.0, 41) if setup.s is None else np.asarray(setup.s, dtype=float)
    servo = merged(plain_parameters(model), hidden or {})
    for halvings in range(MOST_HALVINGS + 1):
        clock = Clock.of(duration, fps, setup.lead_in, setup.longest_step / 2**halvings)
        motor = motor_signal(waveform, clock.half_steps, servo, setup.lead_in).T  # (2 steps + 1, 3)
        if setup.travel is not None:
            motor = np.ascontiguousarray(np.concatenate([motor, setup.travel(clock.half_steps).T], axis=1))
        if setup.initial.q is None:
            state = chain_equilibrium(stepper, motor[0, 0])
            tare = rest_reading(stepper, chain_equilibrium(stepper, float(waveform(0.0)[0])))
        else:
            state = state_of_shape(stepper, setup.initial.q, motor[0, 0], setup.initial.q_rate)
            tare = rest_reading(stepper, state)
        state.t = float(clock.half_steps[0])
        if setup.travel is not None:
            state.q[:2], state.v[:2] = motor[0, 3:5], motor[0, 5:7]
        if stepper.held[2]:
            state.v[2] = motor[0, 1]
        q, readings = _march(stepper, state, motor, clock, setup.initial.release_t)
        if np.max(np.abs(q[:, 3:])) < LARGEST_HINGE_ANGLE:
            break
    else:
        raise InputError(
            "the simulation went out of bounds", field="model", expected="a motion that the arm can follow"
        )
    angles = stepper.chain.tangent_angles(q)
    points = chain_midline_points(angles, q[:, :2], stepper.chain.specimen.length, sampled)
    command = motor_signal(waveform, clock.half_steps, {}, setup.lead_in)[0]
    return Simulation(
        t=clock.frames,
        command=command[2 * clock.first :: 2 * clock.substeps][: clock.frames.size].copy(),
        theta=q[:, 2].copy(),
        angles=angles,
        mount=q[:, :2].copy(),
        midline=Midline(clock.frames, sampled, points, np.zeros(points.shape[:2])),
        thrust=readings[:, 1].copy(),
        load_cell=-readings[:, 3] - tare[1],
        force_x=-readings[:, 2] - tare[0],
        torque=readings[:, 4].copy(),
    )


def rest_reading(stepper: Stepper, state: ChainState) -> Array:
    """The load cell's reading at rest: the arm's force on the mount (2,) [N]."""
    return stepper.residual(state)[:2].copy()


def _march(
    stepper: Stepper, state: ChainState, motor: Array, clock: Clock, release_t: float | None
) -> tuple[Array, Array]:
    """Step through: positions (F, n + 3) at the frames, and readings (F, 5), the mean of the two steps beside each.

    Stops early, leaving infinite positions, where the chain leaves all bounds.
    """
    count = clock.frames.size
    q, readings = np.full((count, stepper.chain.links + 3), np.inf), np.zeros((count, 5))
    before = np.zeros(5)
    corrections = 4  # the first step has no acceleration to start from
    for i in range(clock.first + (count - 1) * clock.substeps + 1):
        frame, between = divmod(i - clock.first, clock.substeps)
        at_frame = frame >= 0 and between == 0
        if at_frame:
            if not np.max(np.abs(state.q[3:])) < LARGEST_HINGE_ANGLE:  # NaN too
                break
            q[frame] = state.q
        moving = release_t is None or state.t >= release_t - 0.5 * clock.step
        if moving:
            stepper.step(state, motor[2 * i : 2 * i + 3], clock.step, corrections)
            corrections = stepper.corrections
        else:
            state.t += clock.step
        if at_frame and moving:
            readings[frame] = stepper.reading if corrections == 4 or i == 0 else 0.5 * (before + stepper.reading)
        before = stepper.reading.copy()
    return q, readings

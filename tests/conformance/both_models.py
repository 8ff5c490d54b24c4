"""The two models in one state: the reduced one's coordinates, and the chain bent the same way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.arm import Arm, active_effects, neutral_parameters, parameter_index
from affine_model.curvature import curvature_basis
from affine_model.dynamics import Instant, balance, remembering
from affine_model.effects import catalogue
from mujoco_ref.chain_state import ChainState
from mujoco_ref.simulate import make_stepper
from mujoco_ref.step import Stepper
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Fluid, Gravity, Specimen

ORDER, NODES = 4, 64  # enough nodes for a soft spot, and for an arm that a wall cuts
ARM = Specimen(Cone(0.0125, 0.004), 0.14, 1070.0, tip_mass=1e-3, tip_mass_reach=0.004, tip_mass_drop=0.002)
BASE = {"elasticity": {"E": 2e5}, "damping": {"eta": 1.5e3}, "drag": {"C_perp": 1.1}}
BEND = np.array([0.8, 0.5, 0.3, 0.2])  # rad, typical sizes of the random states


@dataclass(frozen=True)
class Motion:
    """A state: Legendre coordinates z and rates, base angle and rate [rad], remembered curvature c_m(s), time [s]."""

    z: np.ndarray
    z_rate: np.ndarray
    theta: float
    theta_rate: float
    memory: np.ndarray
    t: float

    @staticmethod
    def drawn(seed: int, still: bool = False) -> Motion:
        random = np.random.default_rng(seed)
        z, rate, memory = random.normal(size=(3, ORDER)) * BEND
        theta, theta_rate = random.normal(size=2) * [0.4, 2.0]
        moves = 0.0 if still else 1.0
        return Motion(z, 5.0 * moves * rate, theta, moves * theta_rate, 0.1 * moves * memory, 0.3)


def model_with(effects: dict[str, dict[str, float]], fluid: Fluid = WATER, gravity: Gravity | None = None) -> Model:
    """The base effects and these, as a model."""
    parameters = {**BASE, **effects}
    exact = {name: {key: Estimate.exact(v) for key, v in values.items()} for name, values in parameters.items()}
    return Model(ARM, fluid, gravity or Gravity(0.3), ORDER, exact)


def nominal(names: tuple[str, ...]) -> dict[str, dict[str, float]]:
    """These effects at their nominal parameters."""
    return {name: {p.name: p.nominal for p in catalogue()[name].parameters} for name in names}


def reduced(model: Model, motion: Motion) -> tuple[np.ndarray, np.ndarray, Arm, np.ndarray, np.ndarray]:
    """(M, F) of the reduced model (n + 2 coordinates), its arm, parameters, and state u."""
    arm = Arm(model.specimen, model.fluid, model.gravity, ORDER, NODES)
    p = neutral_parameters()
    for effect, values in model.parameters.items():
        for name, estimate in values.items():
            p[parameter_index(effect, name)] = estimate.value
    u = np.concatenate([motion.z, [motion.theta, 0.0]])
    v = np.concatenate([motion.z_rate, [motion.theta_rate, 0.0]])
    effects = active_effects(p)
    memory = np.array([remembered(effect, p, arm.curvature_basis @ motion.memory) for effect in remembering(effects)])
    found = balance(arm, effects, p, u, v, Instant(motion.t, memory if memory.size else None))
    return found.mass_matrix, found.force, arm, p, u


def remembered(effect, p, curvature):
    """What an effect can remember: friction no more than its yield."""
    if effect.yield_curvature is None:
        return curvature
    limit = p[parameter_index(effect.name, "slip")]
    return np.clip(curvature, -0.9 * limit, 0.9 * limit)


def bent(model: Model, motion: Motion, links: int) -> tuple[np.ndarray, np.ndarray, Stepper]:
    """(M, F) of the chain in that state, projected on the reduced model's coordinates by virtual work."""
    stepper = make_stepper(model, links=links)
    s = stepper.chain.hinge_s
    columns = curvature_basis(ORDER, s) / stepper.chain.sharpness[:, None]
    state = ChainState.at_rest(stepper.chain.links, motion.theta)
    state.q[3:], state.v[2], state.v[3:] = columns @ motion.z, motion.theta_rate, columns @ motion.z_rate
    state.t = motion.t
    held = columns @ motion.memory
    limit = 0.9 * stepper.laws.hinges["yield_angle"]
    state.hinge_memory[:, 0] = np.clip(held, -limit, limit)
    state.hinge_memory[:, 1] = state.q[3:] - held
    if stepper.written is not None:
        state.law_memory = np.repeat((stepper.chain.sharpness * held)[None], len(stepper.written.acting), axis=0)
    matrix, force = stepper.balance(state)
    onto = np.zeros((stepper.chain.links + 3, ORDER + 2))
    onto[3:, :ORDER], onto[2, ORDER], onto[1, ORDER + 1] = columns, 1.0, 1.0
    return onto.T @ matrix @ onto, onto.T @ force, stepper


def answers(mass: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, float]:
    """Accelerations of the curvatures with the base held [rad/s^2], and the force along y that holds it [N]."""
    n = ORDER
    acceleration = np.linalg.solve(mass[:n, :n], force[:n])
    return acceleration, float(mass[-1, :n] @ acceleration - force[-1])

"""Small motions about a shape at rest: natural frequencies of the chain, in air and in water."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from mujoco_ref.chain_state import ChainState
from mujoco_ref.statics import chain_equilibrium
from mujoco_ref.step import Stepper
from tentacle.signals import Array

_PERTURBATION = 1e-6  # [rad]


def mass_matrix(stepper: Stepper, state: ChainState) -> Array:
    """MuJoCo's mass matrix plus the added mass (n + 3, n + 3) in this state."""
    return stepper.balance(state)[0]


def stiffness_matrix(stepper: Stepper, state: ChainState) -> Array:
    """Change of the static moments at the hinges with the hinge angles (n, n) [N m/rad], weight included."""
    links = stepper.chain.links
    matrix = np.empty((links, links))
    for j in range(links):
        sides = []
        for sign in (1.0, -1.0):
            moved = ChainState(state.q.copy(), state.v, state.a, state.hinge_memory, state.base_memory, state.t)
            moved.q[3 + j] += sign * _PERTURBATION
            sides.append(stepper.residual(moved)[3:])
        matrix[:, j] = -(sides[0] - sides[1]) / (2.0 * _PERTURBATION)
    return 0.5 * (matrix + matrix.T)


def natural_frequencies(stepper: Stepper, theta: float = 0.0, count: int = 3) -> Array:
    """The lowest undamped natural frequencies (count,) [Hz] of the clamped chain about its shape at rest."""
    state = chain_equilibrium(stepper, theta)
    squares = eigh(stiffness_matrix(stepper, state), mass_matrix(stepper, state)[3:, 3:], eigvals_only=True)
    return np.sqrt(np.maximum(squares[:count], 0.0)) / (2.0 * np.pi)

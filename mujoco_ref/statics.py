"""Static shape of the chain under its weight, its buoyancy, a current and forces at its tip."""

from __future__ import annotations

import numpy as np

from mujoco_ref.chain_state import ChainState
from mujoco_ref.step import Stepper
from tentacle.errors import InputError

_PERTURBATION = 1e-6  # [rad], balances truncation and rounding of the difference quotient
_BIGGEST_CHANGE = 0.5  # [rad] the hinges may turn together in one iteration: Newton's method is then safe for elastica


def chain_equilibrium(stepper: Stepper, theta: float, tolerance: float = 1e-10, iterations: int = 200) -> ChainState:
    """The state at rest with the base at theta [rad], by Newton's method from the straight arm. If there are several
    such states, it is one near the straight arm.

    tolerance: largest hinge moment left unbalanced over the largest that acts. InputError where none is found.
    """
    links = stepper.chain.links
    state = ChainState.at_rest(links, theta)
    scale = float(np.max(stepper.chain.stiffness)) * 1e-3
    for _ in range(iterations):
        residual = stepper.residual(state)[3:]
        scale = max(scale, float(np.max(np.abs(residual))))
        if np.max(np.abs(residual)) <= tolerance * scale:
            state.hinge_memory[:, 1] = state.q[3:]  # a Maxwell branch has relaxed
            return state
        slope = np.empty((links, links))
        for j in range(links):
            state.q[3 + j] += _PERTURBATION
            slope[:, j] = (stepper.residual(state)[3:] - residual) / _PERTURBATION
            state.q[3 + j] -= _PERTURBATION
        change = np.linalg.solve(slope, -residual)
        state.q[3:] += change * min(1.0, _BIGGEST_CHANGE / max(float(np.sum(np.abs(change))), 1e-300))
    raise InputError(
        "the arm finds no shape at rest", field="elasticity", expected="a stiffness that can carry the arm"
    )

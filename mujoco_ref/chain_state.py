"""The state of a chain."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mujoco_ref.step_arguments import Moving
from tentacle.signals import Array


@dataclass
class ChainState:
    """The state of a chain: positions, rates and last accelerations (n + 3,), and the memories of hinges, base and
    written laws (laws, n; empty if none has a memory). Mutable.
    """

    q: Array
    v: Array
    a: Array
    hinge_memory: Array
    base_memory: Array
    t: float = 0.0
    law_memory: Array = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def moving(self) -> Moving:
        """The arrays, for the compiled functions, which write them."""
        return Moving(self.q, self.v, self.a, self.hinge_memory, self.base_memory)

    @staticmethod
    def at_rest(links: int, theta: float = 0.0) -> ChainState:
        """Straight, at rest, turned by theta [rad]."""
        zeros = np.zeros(links + 3)
        q = zeros.copy()
        q[2] = theta
        return ChainState(q, zeros.copy(), zeros.copy(), np.zeros((links, 2)), np.zeros(4))

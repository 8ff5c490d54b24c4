"""One step of the compiled kernel, beside the accelerations of the readable assembly at its middle."""

import numpy as np

from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array
from affine_model.dynamics import balance
from affine_model.simulate import Start, Timing, simulate

STEP = 1e-4  # s


def accelerations_of_both(arm: Arm, p: Array) -> tuple[Array, Array]:
    """q'' (3,) of an arm with three coordinates by the kernel and by balance(), in one state of a driven base.

    The step of the midpoint rule is iterated until it is exact. p (R,).
    """
    q, q_rate, base = np.array([0.7, -0.5, 0.4]), np.array([3.0, -2.0, 5.0]), np.array([0.2, 3.0, -40.0])
    run = simulate(
        arm, p[:, None], base[:, None, None], Timing(STEP, iterations=8), start=Start(q[:, None], q_rate[:, None])
    )
    change = (run.q_rate[1, :, 0] - run.q_rate[0, :, 0]) / STEP
    middle = np.stack([q + 0.5 * STEP * q_rate + 0.25 * STEP**2 * change, q_rate + 0.5 * STEP * change])
    z = arm.from_monomial @ middle.T
    made = balance(arm, active_effects(p), p, np.append(z[:, 0], [base[0], 0.0]), np.append(z[:, 1], [base[1], 0.0]))
    held = made.force[:3] - made.mass_matrix[:3, 3] * base[2]
    return change, arm.to_monomial @ np.linalg.solve(made.mass_matrix[:3, :3], held)

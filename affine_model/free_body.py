"""Free swimming in the plane: the arm's base is a rigid hull that moves in x, y and yaw.

The servo sits in the hull and turns the arm against it by a given delta(t). Generalised coordinates: curvatures z, the
clamp's angle theta in the tank, and the clamp's place x, y in the tank. The hull's yaw is psi = theta - delta(t): theta
is free, and delta is a constraint that depends on time. The Lagrangian is that of eq. 5-9, in which every section has
its velocity in the tank, plus that of the hull, whose centre of mass lies on the servo's axis:

    L = T_arm(z, theta, x, y; rates) - V(z) + m (x'^2 + y'^2) / 2 + J (theta' - delta')^2 / 2
    d/dt dL/dz' - dL/dz = Q_z,   d/dt dT_arm/dtheta' - dT_arm/dtheta + J (theta'' - delta'') = Q_theta - N
    d/dt dT_arm/dx' + m x'' = Q_x - R_x,   d/dt dT_arm/dy' + m y'' = Q_y - R_y

Q is the water's force on the arm. The hull's drag is R, along its own axes, n = (cos psi, sin psi) across and
t = (-sin psi, cos psi) along; w is the hull's velocity relative to the water; N is the drag against yaw:

    R_n = (viscous_n + drag_n |w_n|) w_n,   R_t = (viscous_t + drag_t |w_t|) w_t
    N = (yaw_viscous + yaw_drag |psi'|) psi'

The servo's torque on the arm is the force of the constraint, tau = -(J psi'' + N); it does the work tau delta'. Without
water and drag, x, y and theta occur in L by their rates alone, or through a turn of the whole: momentum and angular
momentum are conserved. With J and the hull's drag across without bound, the hull is the carriage of a rail along y.

Not in it: the hull's wake on the arm, and water that the hull carries unequally along and across (a Munk moment).
"""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np

from affine_model.curvature import Array
from tentacle.errors import InputError


@dataclass(frozen=True)
class Hull:
    """mass [kg] and yaw_inertia [kg m^2] about the servo's axis, each with the water that the hull carries; of its drag
    across and along: viscous [N s/m] and quadratic [N s^2/m^2]; against yaw: [N m s] and [N m s^2].

    Raises InputError where mass or inertia is not positive, or a drag is negative.
    """

    mass: float
    yaw_inertia: float
    viscous_across: float = 0.0
    viscous_along: float = 0.0
    drag_across: float = 0.0
    drag_along: float = 0.0
    yaw_viscous: float = 0.0
    yaw_drag: float = 0.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            inertial = name in ("mass", "yaw_inertia")
            if not (np.isfinite(value) and value >= 0.0) or (inertial and value == 0.0):
                expected = "a positive number" if inertial else "0 or more"
                raise InputError(f"{value!r} is not usable", field=f"hull.{name}", expected=expected)

    @property
    def row(self) -> Array:
        """The kernel's numbers (8,), in the order of the fields."""
        return np.array(astuple(self), dtype=np.float64)

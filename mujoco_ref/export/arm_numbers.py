"""An identified arm as numbers along its length, for a program with a continuous rod: the file arm.json.

The numbers are those of the reference's chain at TABLE places, so that every effect that changes a hinge (a soft spot,
the affine law, curvature at rest) is in them. A hinge of stiffness K at spacing h is a rod of bending stiffness K h.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mujoco_ref.simulate import make_stepper
from mujoco_ref.water import SPHERE
from tentacle.model import Model
from tentacle.signals import Array
from tentacle.specimen import Cone

TABLE = 200  # places along the arm; straight lines between them give r^4 of a cone to 1e-4
WATER = ("density", "C_perp", "C_t", "C_a", "tangential", "convective", "c_n",
         "U_x", "U_y", "U_cos", "U_sin", "V_cos", "V_sin", "slosh_f")  # fmt: skip


def arm_numbers(model: Model) -> dict[str, Any]:
    """The content of arm.json, SI units; InputError where the reference refuses the model.

    s (TABLE,) is the place over the length. bending_stiffness [N m^2], bending_damping [N m^2 s], rest_curvature [1/m],
    cubic [m^2] (moment = stiffness kappa (1 + cubic kappa^2)), bent_loss [m^2 s] (damping += stiffness bent_loss
    kappa^2); width [m], perimeter [m], area [m^2], second_moment [m^4]. bodies: at the tip, each with its mass [kg],
    volume [m^3], reach [m] along the tangent and drop [m] along the normal.
    """
    stepper = make_stepper(model, links=TABLE)
    chain, water, hinges = stepper.chain, stepper.laws.water[0], stepper.laws.hinges
    specimen = chain.specimen
    section, spacing = specimen.section, specimen.length / TABLE
    s = chain.hinge_s
    along: dict[str, Array] = {
        "s": s,
        "bending_stiffness": hinges["stiffness"] * spacing,
        "bending_damping": hinges["damping"] * spacing,
        "rest_curvature": hinges["rest"] / spacing,
        "cubic": hinges["cubic"] * spacing**2,
        "bent_loss": hinges["bent_loss"] * spacing**2,
        "width": section.width(s),
        "perimeter": section.perimeter(s),
        "area": section.area(s),
        "second_moment": section.second_moment(s),
    }
    names = ("mass", "reach", "drop", "volume")
    return {
        "length": specimen.length,
        "density": specimen.density,
        "order": model.order,
        "section": _section(section),
        "gravity": [float(pull) for pull in chain.model.opt.gravity[:2]],
        "water": {name: float(water[name]) for name in WATER},
        "body_carries": SPHERE,
        "bodies": [dict(zip(names, body.tolist(), strict=True)) for body in chain.bodies if body[0] > 0.0],
        "along": {name: np.asarray(values, dtype=float).tolist() for name, values in along.items()},
    }


def _section(section: Any) -> dict[str, Any]:
    if isinstance(section, Cone):
        return {"shape": "cone", "base_radius": section.base_radius, "tip_radius": section.tip_radius}
    return {"shape": "rectangle", "width": section.section_width, "height": section.height}

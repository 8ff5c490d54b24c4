"""The arm of benchmarks/affine.py: its geometry, its parameters, and the step of its simulations."""

from __future__ import annotations

from affine_model.arm import Arm, neutral_parameters, parameter_index
from tentacle.signals import Array
from tentacle.specimen import WATER, Cone, Gravity, Specimen

SPECIMEN = Specimen(Cone(0.0125, 0.001), 0.14, 1070.0)
ARM = Arm(SPECIMEN, WATER, Gravity(0.0), order=2, nodes=6)
STEP = 1 / 150  # s: the coarsest at which the median mean thrust is right to 0.1 % (thrust_error below)
FREE = (("elasticity", "E"), ("damping", "eta"), ("drag", "C_perp"), ("added_mass", "C_a"))
TRUTH = (2.0e5, 2.0e3, 1.1, 1.0)


def parameters() -> Array:
    """The vector (R,) of TRUTH, all other effects absent."""
    vector = neutral_parameters()
    for (effect, name), value in zip(FREE, TRUTH, strict=True):
        vector[parameter_index(effect, name)] = value
    return vector

"""The sight of a parameter vector: what its measurement effects make of the arm, one after the other."""

from __future__ import annotations

from types import SimpleNamespace

from affine_model.arm import parameter_index
from affine_model.curvature import Array
from affine_model.effects import catalogue
from affine_model.sight import Sight


def sight_of(parameters: Array) -> Sight:
    """What camera and clock show under the parameters (R, ...). Its numbers have shape (...)."""
    sight = Sight()
    for effect in catalogue().values():
        if effect.sight is not None:
            values = {p.name: parameters[parameter_index(effect.name, p.name)] for p in effect.parameters}
            sight = effect.sight(sight, SimpleNamespace(**values))
    return sight

"""Camera scale: metres per pixel are not what was declared."""

from dataclasses import replace
from typing import Any

from affine_model.effect import Effect, Parameter
from affine_model.sight import Sight


def _scaled(sight: Sight, p: Any) -> Sight:
    """(1 + excess) x"""
    return replace(sight, excess=p.excess)


CAMERA_SCALE = Effect(
    name="camera_scale",
    title="Scale of the camera",
    parameters=(Parameter("excess", "1", 0.02, (-0.5, 1.0), "apparent size over true size, less one"),),
    source="pinhole camera",
    family="measurement",
    sight=_scaled,
)

"""Camera roll: the image is turned against the declared direction of the arm, about a point of the straight arm's line.

A point at x appears at R x + (I - R) (0, centre L), R the rotation by the roll.
"""

from dataclasses import replace
from typing import Any

from affine_model.effect import Effect, Parameter
from affine_model.laws import cos, sin
from affine_model.sight import Sight


def _turned(sight: Sight, p: Any) -> Sight:
    """R(roll) x + (I - R(roll)) (0, centre L)"""
    return replace(sight, roll=p.roll, shift=(p.centre * sin(p.roll), p.centre * (1.0 - cos(p.roll))))


CAMERA_ROLL = Effect(
    name="camera_roll",
    title="Roll of the camera",
    parameters=(
        Parameter("roll", "rad", 0.02, (-1.0, 1.0), "angle by which the arm appears turned"),
        Parameter("centre", "arm lengths", 0.5, (-1.0, 2.0), "where the point that stays lies", scan=(0.0,)),
    ),
    source="rotation of the image plane",
    family="measurement",
    sight=_turned,
)

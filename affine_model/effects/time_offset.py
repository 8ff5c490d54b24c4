"""Time offset: a frame that the camera stamps with t shows the arm at the motor's time

    t + offset + drift t.

Two clocks that were started apart differ by the offset. Quartz crystals run at rates that differ by some 1e-5 to 1e-4,
and a film whose nominal frame rate is not the true one by up to 1e-3.
"""

from dataclasses import replace
from typing import Any

from affine_model.effect import Effect, Parameter
from affine_model.sight import Sight


def _stamped(sight: Sight, p: Any) -> Sight:
    """frames show t + offset + drift t"""
    return replace(sight, offset=p.offset, drift=p.drift)


TIME_OFFSET = Effect(
    name="time_offset",
    title="Offset between camera and motor clock",
    parameters=(
        Parameter("offset", "s", 0.01, (-1.0, 1.0), "frames show the arm this much later than they are stamped"),
        Parameter("drift", "1", 1e-4, (-0.01, 0.01), "and later still by this share of the stamp"),
    ),
    source="two clocks",
    family="measurement",
    sight=_stamped,
)

"""Time offset: the camera's clock runs ahead of the motor's by a constant."""

from affine_model.effect import Effect, Parameter

TIME_OFFSET = Effect(
    name="time_offset",
    title="Offset between camera and motor clock",
    parameters=(
        Parameter("offset", "s", 0.01, (-1.0, 1.0), "frames show the arm this much later than they are stamped"),
    ),
    source="two clocks",
    family="measurement",
    measurement="time_offset",
)

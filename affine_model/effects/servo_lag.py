"""Servo lag: the base follows the recorded angle late, as a first-order lag."""

from affine_model.effect import Effect, Parameter

SERVO_LAG = Effect(
    name="servo_lag",
    title="Lag of the servo",
    parameters=(Parameter("tau", "s", 0.02, (0.0, 0.5), "time constant of the lag"),),
    source="first-order low-pass between horn and clamp",
    family="servo",
    base="lag",
)

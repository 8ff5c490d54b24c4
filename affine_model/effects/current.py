"""Current: the water streams steadily past the clamp. Every fluid law sees the velocity relative to it."""

from affine_model.effect import Effect, Parameter

CURRENT = Effect(
    name="current",
    title="Steady current",
    parameters=(
        Parameter("U_x", "m/s", 0.05, (-2.0, 2.0), "velocity of the water along n at theta = 0"),
        Parameter("U_y", "m/s", 0.05, (-2.0, 2.0), "velocity of the water along the straight arm at theta = 0"),
    ),
    source="Galilean change of frame in eq. 15",
    family="fluid",
    water_velocity=lambda x, p: (p.U_x, p.U_y),
)

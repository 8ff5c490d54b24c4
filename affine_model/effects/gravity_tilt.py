"""Gravity tilt: the clamp is tilted by a small angle, so that gravity's direction differs from the declared one."""

from affine_model.effect import Effect, Parameter

GRAVITY_TILT = Effect(
    name="gravity_tilt",
    title="Tilt of gravity",
    parameters=(Parameter("tilt", "rad", 0.1, (-3.2, 3.2), "angle of gravity beyond the declared one"),),
    source="rotation of g in eq. 10",
    family="weight",
    gravity_tilt=lambda x, p: p.tilt,
)

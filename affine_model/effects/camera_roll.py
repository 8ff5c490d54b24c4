"""Camera roll: the image is turned against the declared direction of the arm."""

from affine_model.effect import Effect, Parameter

CAMERA_ROLL = Effect(
    name="camera_roll",
    title="Roll of the camera",
    parameters=(Parameter("roll", "rad", 0.02, (-1.0, 1.0), "angle by which the arm appears turned about the clamp"),),
    source="rotation of the image plane",
    family="measurement",
    measurement="roll",
)

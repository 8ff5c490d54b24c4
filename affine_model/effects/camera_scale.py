"""Camera scale: metres per pixel are not what was declared."""

from affine_model.effect import Effect, Parameter

CAMERA_SCALE = Effect(
    name="camera_scale",
    title="Scale of the camera",
    parameters=(Parameter("excess", "1", 0.02, (-0.5, 1.0), "apparent size over true size, less one"),),
    source="pinhole camera",
    family="measurement",
    measurement="(1 + excess) x",
)

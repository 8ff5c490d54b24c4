"""Place of the payload: its centre is farther out, or farther beside the axis, than declared."""

from affine_model.effect import Effect, Parameter

PAYLOAD_PLACE = Effect(
    name="payload_place",
    title="Payload hangs elsewhere",
    parameters=(
        Parameter("along", "m", 0.005, (-0.1, 0.1), "how much farther out its centre lies, along the tangent"),
        Parameter("aside", "m", 0.002, (-0.1, 0.1), "how much farther beside the axis, along the normal"),
    ),
    source="Newton: the declared mass on another lever",
    family="weight",
    payload_shift=lambda x, p: (p.along, p.aside),
)

"""Backlash: play between the servo's gear and the clamp; the base turns only when the play is used up."""

from affine_model.effect import Effect, Parameter

BACKLASH = Effect(
    name="backlash",
    title="Backlash of the servo",
    parameters=(Parameter("play", "rad", 0.03, (0.0, 0.5), "total play of the gear"),),
    source="play operator: Krasnosel'skii and Pokrovskii 1989",
    family="servo",
    dissipative=True,
    base="backlash",
)

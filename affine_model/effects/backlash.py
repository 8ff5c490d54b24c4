"""Backlash: play between the servo's gear and the clamp; the base turns only when the play is used up.

Where the coupling gives, the clamp follows what is left of the command, v, as a spring with a damper lets it:

    (period / 2 pi)^2 theta'' + delay theta' + theta = v.
"""

from affine_model.effect import Effect, Parameter

BACKLASH = Effect(
    name="backlash",
    title="Backlash of the servo",
    parameters=(
        Parameter("play", "rad", 0.03, (0.0, 0.5), "total play of the gear"),
        Parameter("delay", "s", 0.01, (0.0, 0.2), "damping of the coupling over its stiffness", scan=(0.0,)),
        Parameter("period", "s", 0.1, (0.0, 0.5), "natural period of the clamp on its coupling", scan=(0.0,)),
    ),
    source="play operator: Krasnosel'skii and Pokrovskii 1989; elastic coupling: Nordin and Gutman 2002",
    family="servo",
    dissipative=True,
    base="backlash",
)

"""Backlash: play between the servo's gear and the clamp; the base turns only when the play is used up.

Where the coupling gives, the clamp follows what is left of the command, v, as a spring with a damper lets it:

    (play period / 2 pi)^2 theta'' + play delay theta' + theta = v.

Delay and period count per play, so that a gear without play is no lag.
"""

from affine_model.effect import Effect, Parameter

BACKLASH = Effect(
    name="backlash",
    title="Backlash of the servo",
    parameters=(
        Parameter("play", "rad", 0.03, (0.0, 0.5), "total play of the gear"),
        Parameter(
            "delay", "s/rad", 0.3, (0.0, 2.0), "damping of the coupling over its stiffness, per play", scan=(0.0,)
        ),
        Parameter(
            "period", "s/rad", 3.0, (0.0, 15.0), "natural period of the clamp on its coupling, per play", scan=(0.0,)
        ),
    ),
    source="play operator: Krasnosel'skii and Pokrovskii 1989; elastic coupling: Nordin and Gutman 2002",
    family="servo",
    dissipative=True,
    base="backlash",
)

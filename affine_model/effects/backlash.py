"""Backlash: play between the servo's gear and the clamp; the base turns only when the play is used up.

Behind the play the angle is v. An elastic coupling is a spring with a damper between v and the clamp:

    (play period / 2 pi)^2 theta'' + play delay theta' + theta = v.

Delay and period are stated per play, so that a gear without play has no lag either.
"""

from typing import Any

from affine_model.base_laws import low_pass, with_play
from affine_model.curvature import Array
from affine_model.effect import Effect, Parameter


def _loose(table: Array, step: float, p: Any) -> Array:
    """(play period / 2 pi)^2 theta'' + play delay theta' + theta = v, v = u behind the play"""
    return low_pass(with_play(table, step, p.play), step, p.play * p.delay, p.play * p.period)


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
    base=_loose,
)

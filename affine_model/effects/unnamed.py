"""What has no name: a small smooth force along the arm and a small moment in it, linear in a few shapes of the motion.

It is no physics but a record of what physics is still owed: discovery adds a few of its terms after the catalogue,
where they help on data that were held out, and never in place of a named effect.
"""

from typing import Any

from affine_model.effect import Effect, Parameter


def _force(x: Any, p: Any) -> tuple[Any, Any]:
    per_mass = (
        p.push * x.s**3
        + p.tether * x.x
        + p.tip_tether * x.x * x.s**3
        + p.bowed_tether * x.x**2 / x.length
        + p.tip_brake * x.u_n * x.s**3
    )
    return -x.density * x.area * per_mass, 0.0


def _moment(x: Any, p: Any) -> Any:
    elastic = p.set_tip * x.s + p.stiff_tip * x.c * x.s + p.one_sided * x.c**2
    return x.stiffness * (elastic + p.slow_tip * x.c_rate * x.s)


UNNAMED = Effect(
    name="unnamed",
    title="A rest without a name",
    parameters=(
        Parameter("push", "m/s^2", 0.05, (-5.0, 5.0), "steady push per mass, towards the tip"),
        Parameter("tether", "1/s^2", 1.0, (-100.0, 100.0), "pull per mass back to the straight line"),
        Parameter("tip_tether", "1/s^2", 1.0, (-100.0, 100.0), "the same, towards the tip"),
        Parameter("bowed_tether", "1/s^2", 1.0, (-100.0, 100.0), "pull that grows with the square of the way"),
        Parameter("tip_brake", "1/s", 0.5, (-20.0, 20.0), "brake per mass and velocity, towards the tip"),
        Parameter("set_tip", "rad", 0.05, (-2.0, 2.0), "curvature at rest, towards the tip"),
        Parameter("stiff_tip", "1", 0.05, (-0.8, 2.0), "share of stiffness more at the tip"),
        Parameter("one_sided", "1/rad", 0.05, (-1.0, 1.0), "stiffer to one side"),
        Parameter("slow_tip", "s", 0.005, (-0.1, 0.5), "damping over stiffness, towards the tip"),
    ),
    source="the first terms of a power series in s, c, c_rate, x and u_n",
    family="rest",
    force=_force,
    bending_moment=_moment,
)

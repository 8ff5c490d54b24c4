"""Cross-flow principle: normal drag follows the normal velocity alone, |u_n| u_n, where eq. 15 has |u| u_n.

share = 1 is the independence principle, valid for oblique cylinders in subcritical flow; share = 0 is eq. 15.
"""

from affine_model.effect import Effect, Parameter
from affine_model.laws import sqrt

CROSS_FLOW = Effect(
    name="cross_flow",
    title="Cross-flow principle",
    parameters=(Parameter("share", "1", 1.0, (0.0, 1.0), "1: |u_n| u_n; 0: |u| u_n"),),
    source="Hoerner 1965, ch. 3; independence principle: Sears 1948",
    family="option",
    force=lambda x, p: (
        0.5 * x.fluid_density * x.drag_coefficient * x.width * p.share * (x.speed - sqrt(x.u_n**2 + 1e-16)) * x.u_n,
        0.0,
    ),
)

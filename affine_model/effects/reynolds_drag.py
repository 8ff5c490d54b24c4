"""Drag that grows at small Reynolds numbers: C_perp (1 + share 10 Re^(-2/3)), Re = speed width / nu, along the taper.

share = 1 is the curve of a smooth cylinder, 1 < Re < 2e5, for which C_perp = 1.
"""

from affine_model.effect import Effect, Parameter

VISCOSITY = 1.0e-6  # m^2/s, water at 20 degrees C
LEAST_REYNOLDS = 1e-3  # Reynolds number, below which the coefficient stays what it is

REYNOLDS_DRAG = Effect(
    name="reynolds_drag",
    title="Drag coefficient of the Reynolds number",
    parameters=(Parameter("share", "1", 1.0, (0.0, 3.0), "strength of the published curve"),),
    source="White 1991, Viscous Fluid Flow, eq. 3-225",
    family="option",
    dissipative=True,
    force=lambda x, p: (
        -5.0
        * p.share
        * (x.speed * x.width / VISCOSITY + LEAST_REYNOLDS) ** (-2.0 / 3.0)
        * x.fluid_density
        * x.drag_coefficient
        * x.width
        * x.speed
        * x.u_n,
        0.0,
    ),
)

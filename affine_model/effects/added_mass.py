"""Added mass: water that moves with a section along its normal (potential flow; a circle has C_a = 1).

Per length, with m_a = C_a rho pi w^2 / 4, a_n the acceleration along n relative to the water's, and x = `convective`:

    force  -m_a (a_n n + x phi' (u_t n + u_n t)),    couple  x m_a u_n u_t.

At x = 1 it is Kirchhoff's: f = -d/dt(m_a u_n n), where n turns with phi' and d(u_n)/dt = a_n + phi' u_t, and the couple
-u x P of the water's momentum P = m_a u_n n. These are Lagrange's equations of the energy m_a u_n^2 / 2, which is
conserved. At x = 0 only the first term is left, Morison's normal acceleration. The water then gives the arm the power
(1 - x) m_a phi' u_n u_t, although still water cannot give power to a body.

With a slender body no water moves along the tangent. Some simulators add the water's mass to their links, so that it
moves along the tangent too. Therefore the share `tangential` of m_a acts like mass, in every direction, and has no
convective terms.
"""

from typing import Any

from affine_model.effect import Effect, Parameter


def _carried(x: Any, p: Any) -> Any:
    """kg/m along the normal."""
    return 0.25 * 3.141592653589793 * p.C_a * x.fluid_density * x.width**2


def _along_normal_alone(x: Any, p: Any) -> Any:
    """kg/m along the normal and not along the tangent."""
    return (1.0 - p.tangential) * _carried(x, p)


def _left_out(x: Any, p: Any) -> Any:
    """kg/m whose convective terms do not act."""
    return (1.0 - p.convective) * _along_normal_alone(x, p)


ADDED_MASS = Effect(
    name="added_mass",
    title="Added mass",
    parameters=(
        Parameter("C_a", "1", 1.0, (0.0, 5.0), "added mass over that of the water in a circle of the width"),
        Parameter(
            "convective",
            "1",
            0.5,
            (0.0, 1.0),
            "share of Kirchhoff's convective terms that acts; 0: Morison's normal acceleration alone",
            scan=(1.0,),
        ),
        Parameter(
            "tangential",
            "1",
            0.5,
            (0.0, 1.0),
            "added mass along the tangent, over that along the normal",
            scan=(0.0, 1.0),
        ),
    ),
    source="Kirchhoff: Lamb 1932, art. 124, and Lighthill 1960; Morison et al. 1950, inertia term",
    family="fluid",
    normal_inertia=_along_normal_alone,
    carried_water=lambda x, p: p.tangential * _carried(x, p),
    force=lambda x, p: (_left_out(x, p) * x.phi_rate * x.u_t, _left_out(x, p) * x.phi_rate * x.u_n),
    couple=lambda x, p: -_left_out(x, p) * x.u_n * x.u_t,
)

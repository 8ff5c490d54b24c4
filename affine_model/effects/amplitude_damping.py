"""Amplitude-dependent damping: adds b k c^2 to the damping d, so that the loss factor grows with the amplitude squared.

Over a cycle of amplitude A it removes the same energy as a damping b k A^2 / 4 (equivalent viscous damping).
"""

from affine_model.effect import Effect, Parameter

AMPLITUDE_DAMPING = Effect(
    name="amplitude_damping",
    title="Damping that grows with amplitude",
    parameters=(
        Parameter("b", "s/rad^2", 0.01, (0.0, 10.0), "loss over stiffness, per squared curvature: adds b k c^2 to d"),
    ),
    source="Amabili 2018, J. Mech. Phys. Solids 118: x^2 x', from a viscoelastic law at finite strain; Nayfeh and Mook"
    " 1979, ch. 3",
    family="elastic",
    dissipative=True,
    bending_moment=lambda x, p: p.b * x.stiffness * x.c**2 * x.c_rate,
)

"""Inertia of the arm and of its declared payload (eq. 9,
with the circular or rectangular section in place of the lamina).
"""

from affine_model.effect import Effect

INERTIA = Effect(
    name="inertia",
    title="Inertia",
    parameters=(),
    source="paper eq. 9; rotary inertia as in Rayleigh's beam",
    family="base",
    line_inertia=lambda x, p: x.density * x.area,
    rotary_inertia=lambda x, p: x.density * x.second_moment,
    hung_mass=lambda x, p: (x.payload, x.payload_reach, x.payload_drop, x.payload_density),
)

"""Stiffness drift: the arm softens (or stiffens) steadily while it is recorded, as it warms or takes up water."""

from affine_model.effect import Effect, Parameter

STIFFNESS_DRIFT = Effect(
    name="stiffness_drift",
    title="Drift of the stiffness",
    parameters=(Parameter("rate", "1/s", 2.0e-3, (-0.05, 0.05), "relative change of stiffness per second"),),
    source="first-order term in time",
    family="elastic",
    stiffness_share=lambda x, p: p.rate * x.t,
)

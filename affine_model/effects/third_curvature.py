"""Third curvature: the arm bends in ways that two coordinates cannot follow; one more term q3 s^2 in eq. 1."""

from affine_model.effect import Effect

THIRD_CURVATURE = Effect(
    name="third_curvature",
    title="More curvature coordinates than two",
    parameters=(),
    source="Della Santina and Rus 2020, polynomial curvature",
    family="shape",
    extra_order=1,
)

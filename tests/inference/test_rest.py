"""What a model alone leaves does not depend on where its fit begins."""

from dataclasses import replace

import pytest

from affine_model.arm import parameter_index
from inference.posterior import Hypothesis, declared_model, with_rest
from tentacle.solver_result import RESULTS

STIFFNESS, VISCOSITY = parameter_index("elasticity", "E"), parameter_index("damping", "eta")


@pytest.fixture(scope="module")
def near(with_current) -> Hypothesis:
    """The declared model of a recording with a current, with its rest."""
    return with_rest(declared_model(with_current.problem, with_current.fitted.nuisances))


def begun_at(h: Hypothesis, stiffer: float, tougher: float) -> Hypothesis:
    """The hypothesis, to be followed from so many times its modulus and viscosity."""
    assert h.alone is not None
    parameters = h.problem.parameters.copy()
    parameters[STIFFNESS] = stiffer * h.alone.parameters[STIFFNESS]
    parameters[VISCOSITY] = tougher * h.alone.parameters[VISCOSITY]
    return replace(h, problem=replace(h.problem, parameters=parameters), alone=None, rest=float("nan"))


@pytest.mark.parametrize(("stiffer", "tougher"), [(1.3, 1.0), (0.01, 0.01), (1000.0, 100.0), (0.1, 1000.0)])
def test_the_rest_does_not_depend_on_where_the_model_stood(near, stiffer, tougher):
    """From near it ends within its FIRST rounds, from far it goes on after them; the noise's square is one of the sum.

    Each fit ends where a round lowers the sum by less than 1e-4 of it. Some such rounds may be left.
    """
    again = with_rest(begun_at(near, stiffer, tougher))
    assert again.alone is not None
    assert again.alone.result is RESULTS.CONVERGED
    assert again.rest == pytest.approx(near.rest, abs=1e-3 * (near.rest + 1.0))


def test_a_model_leaves_no_more_than_one_that_it_contains(near):
    assert with_rest(begun_at(near, 0.1, 1000.0), near).rest <= near.rest

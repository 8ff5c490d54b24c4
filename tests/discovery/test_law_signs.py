"""The sign of a strength: what brakes or holds by its words does so; the words of the others tell their way."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from discovery.laws.grammar import Scale, forms
from discovery.laws.inputs import LawInputs
from discovery.laws.search import Sought
from discovery.laws.words import title_of
from inference.fit import Fit
from inference.prior import log_prior
from inference.small_motions import SmallMotions
from inference.trajectory import Problem
from tentacle.law.in_use import using
from tests.discovery.test_laws_over import ARM, N, swinging

FORMS = {form.law.name: form for form in forms(Scale(0.14, wet=True, duration=20.0))}
DRAGS = [name for name in FORMS if name.startswith(("drag_", "skin_", "one_way_", "tip_drag", "patch_"))]
HOLD = [name for name in FORMS if name.startswith(("tether", "stop_", "late", "bending_loss"))]


@pytest.mark.parametrize("name", DRAGS)
def test_a_drag_takes_energy(name):
    law, motion = FORMS[name].law, swinging()
    motion = type(motion)(**{**vars(motion), "u": motion.u.copy(), "rate": motion.rate.copy()})
    motion.u[:, N:], motion.rate[:, N:] = 0.0, 0.0  # the base stands, so that the power is that of the coordinates
    inputs = LawInputs(ARM, cast(SmallMotions, SimpleNamespace(motion=motion)), np.zeros(ARM.rule.s.size))
    values = {p.name: p.scan[len(p.scan) // 2] if p.scan else 0.01 for p in law.parameters}
    power = np.sum(inputs.force(law, values) * motion.rate[:, :N], axis=1)
    # positive() is rounded over .1 mm/s: beyond its corner a one-way drag still has 1e-7 of its force at .1 m/s
    assert power.max() < 1e-5 * -power.min()
    assert law.parameters[0].bounds[0] == 0.0


@pytest.mark.parametrize("name", HOLD)
def test_what_holds_cannot_push(name):
    assert FORMS[name].law.parameters[0].bounds[0] == 0.0


@pytest.mark.parametrize(("name", "explains"), [("tether", False), ("attraction", True)])
def test_a_form_whose_best_strength_is_negative_explains_nothing_where_it_may_not_be(name, explains):
    target = np.random.default_rng(1).standard_normal(50)
    found, strengths = Sought.explained(
        cast(Sought, SimpleNamespace(target=target)), FORMS[name], -50.0 * target[:, None]
    )
    assert strengths[0, 0] == pytest.approx(-0.02)
    assert found[0] == pytest.approx(target @ target if explains else 0.0)


@pytest.mark.parametrize(
    ("name", "pulls", "pushes"),
    [
        ("attraction", "towards a point", "away from a point"),
        ("tip_spring", "towards x = 0", "away from x = 0"),
        ("line_spring", "towards x = 0", "away from x = 0"),
        ("bending", "a stiffening moment", "a softening moment"),
        ("one_sided", "more stiffness", "less stiffness"),
    ],
)
def test_words_tell_the_way_of_a_force_of_either_sign(name, pulls, pushes):
    law = FORMS[name].law
    assert pulls in title_of(law, {"a": 0.1})
    assert pushes in title_of(law, {"a": -0.1})
    assert pulls not in title_of(law, {"a": -0.1})


def test_the_prior_of_a_strength_has_the_size_of_its_nominal_value_whatever_its_sign():
    law = replace(FORMS["tip_push"].law, name="law_push")
    problem = cast(Problem, SimpleNamespace(free=(("law_push", "a"), ("law_push", "b")), experiments=(), declared=()))
    problem.arm = ARM  # type: ignore[misc]
    fitted = cast(Fit, SimpleNamespace(values=np.array([-0.3, 0.2])))
    densities = []
    for sign in (1.0, -1.0):
        own = tuple(replace(p, nominal=sign * p.nominal) for p in law.parameters)
        with using([replace(law, parameters=own)]):
            densities.append(log_prior(problem, fitted))
    assert np.isfinite(densities[0])
    assert densities[0] == densities[1]

"""Sections that shear are taken as the arm's own where the recordings show them, and only there."""

from __future__ import annotations

from dataclasses import replace

import pytest

from discovery.declared_fit import fit_declared
from discovery.diagnose import AS_USUAL, diagnose
from discovery.given import Given
from discovery.sheared import declares_shear, sheared_fit
from inference.declared_arm import SHEAR
from tentacle.declared import Uncertain
from tentacle.progress import silent
from tentacle.recording import Declaration
from tentacle.specimen import WATER
from tests.made_recordings import SPECIMEN, Run, record_declared

PLAIN = Declaration(SPECIMEN, WATER)


def recorded(compliance, hidden=None):
    """A run of an arm whose sections shear so much, declared without a word on it."""
    made = record_declared(Declaration(replace(SPECIMEN, shear_compliance=compliance), WATER), hidden or {}, Run())
    return replace(made, declaration=PLAIN)


def taken(given):
    return sheared_fit(fit_declared(given, AS_USUAL, silent), AS_USUAL, silent)


@pytest.mark.parametrize("with_baseline", [False, True])
def test_shear_is_taken_where_the_recordings_or_their_baseline_show_it(with_baseline) -> None:
    shearing = recorded(1.0)
    baseline = [replace(shearing, name="bare")] if with_baseline else []
    found = taken(Given([shearing], baseline))
    assert found is not None
    assert found.problem.arm.specimen.shear_compliance == 1.0
    assert any("shear" in words for words in found.prepared[0].words)


def test_no_shear_is_taken_of_an_arm_without() -> None:
    assert taken(Given([recorded(0.0)])) is None


def test_what_is_declared_is_not_asked() -> None:
    uncertain = Uncertain(SHEAR, 0.5, 0.5, 0.0, 10.0)
    for declaration in (
        Declaration(replace(SPECIMEN, shear_compliance=0.5), WATER),
        replace(PLAIN, uncertain=(uncertain,)),
    ):
        assert declares_shear(declaration)
    assert not declares_shear(PLAIN)


def test_an_arm_that_shears_lacks_nothing_and_its_model_is_written_with_shear() -> None:
    found = diagnose([recorded(1.0)])
    assert found.verdict == "nothing_missing"
    assert found.augmented_model.specimen.shear_compliance == 1.0


def test_a_payload_on_an_arm_that_shears_is_found() -> None:
    found = diagnose([recorded(1.0, {("tip_mass", "mass"): 3e-3})])
    assert found.effects == ("tip_mass",)
    mass = found.parameters["tip_mass"]["mass"]
    assert mass.low <= 3e-3 <= mass.high

"""Refits: at the step that a law needs, and with no shape that the data do not need."""

import numpy as np
import pytest

from discovery.rules.refit import prune_shape_parameters, refit
from inference.base_fit import Setting, fit_base
from inference.hypothesis import gated_hypothesis, parameter_interval
from inference.prepare import prepare
from inference.score import score
from tests.made_recordings import as_markers, base_of


def added(current, name):
    """The hypothesis with the named effect, from the score test's estimate."""
    return refit(current, next(c for c in score(current.problem, current.fitted) if c.effect.name == name))


def test_a_bristle_stiffer_than_the_arm_is_fitted_at_the_step_that_it_needs(recorded):
    """Friction that yields at an eighth of the curvature that it holds is eight times as stiff as the arm until then:
    at the step that suffices without it the simulation is far off, and a fit flees to where it errs less."""
    hidden = {("dry_friction", "c_f"): 0.01, ("dry_friction", "slip"): 0.00125}
    experiment = prepare(recorded(hidden, order=4, seconds=6.0, noise=2e-4), hold_out=True).experiment
    setting = Setting(recorded(seconds=0.5).declaration, (experiment,), 4)
    base = gated_hypothesis((), *fit_base(setting, 4))
    found = added(base, "dry_friction")
    assert found.problem.step < base.problem.step
    # chi-square with `count` degrees of freedom, five standard deviations
    assert 2.0 * found.fitted.misfit < found.fitted.count + 5.0 * np.sqrt(2.0 * found.fitted.count)
    values = dict(zip(found.fitted.free, found.fitted.values, strict=True))
    assert values["dry_friction", "c_f"] == pytest.approx(0.01, rel=0.1)


@pytest.mark.parametrize("tangential", [0.0, 1.0])
def test_water_along_the_tangent_is_kept_only_where_the_data_need_it(recorded, tangential):
    found = added(
        base_of(recorded({("added_mass", "C_a"): 1.0, ("added_mass", "tangential"): tangential})), "added_mass"
    )
    simpler = prune_shape_parameters(found)
    assert (("added_mass", "tangential") in simpler.problem.free) == (tangential > 0.0)
    place = simpler.problem.free.index(("added_mass", "C_a"))
    low, high = parameter_interval(simpler, place, 1.0)
    # The 95 % interval taken twice as wide: it holds the truth with a chance of .9999.
    assert abs(0.5 * (low + high) - 1.0) < high - low


def test_markers_give_what_their_score_promised(recorded):
    """A faint effect acts linearly: the refit gains what the score test says, to a twentieth. A marker's frame is where
    it says, for the one as for the other.
    """
    base = base_of(as_markers(recorded({("intrinsic_curvature", "c0"): 0.01}, noise=5e-5)))
    candidate = next(c for c in score(base.problem, base.fitted) if c.effect.name == "intrinsic_curvature")
    assert candidate.gain > 50.0
    gained = base.fitted.misfit - refit(base, candidate).fitted.misfit
    assert gained == pytest.approx(candidate.gain, rel=0.05)

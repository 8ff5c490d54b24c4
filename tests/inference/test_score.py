"""The score test: to first order it knows how strong an absent effect is, and that nothing is where nothing is."""

import numpy as np

from inference.score import responses, score, twin_cosines
from inference.trajectory import RAN_AWAY, Problem
from inference.whitened_fit import tangent_basis, whitened_fit


def scored(known):
    """The candidates about a fitted problem."""
    return score(whitened_fit(known.problem, known.fitted), responses(known.problem, known.fitted))


def test_a_hidden_effect_is_found_with_its_strength(with_current):
    candidates = scored(with_current)
    best = candidates[0]
    assert best.effect.name == "current"
    strengths = dict(zip((p.name for p in best.effect.strengths), best.strengths, strict=True))
    # A linear estimate about the model without it, whose drag was fitted to hide it: right to a third.
    assert abs(strengths["U_x"] - 0.03) < 0.01


def test_gains_are_what_the_freed_columns_explain(with_current):
    basis = tangent_basis(with_current.fitted.jacobian)
    np.testing.assert_allclose(basis.T @ basis, np.eye(basis.shape[1]), atol=1e-9)
    residual = with_current.fitted.used_residuals
    residual = residual - basis @ (basis.T @ residual)
    for candidate in scored(with_current)[:5]:
        # Freed of all that refitting absorbs, and no candidate explains more than there is.
        scale = np.linalg.norm(candidate.sensitivity, axis=0).max()
        assert np.abs(basis.T @ candidate.sensitivity).max() < 1e-9 * scale
        assert candidate.gain <= 0.5 * residual @ residual * (1.0 + 1e-9)


def test_where_nothing_is_hidden_no_effect_gains_much(plain):
    # 2 gain is chi-square with as many degrees as strengths (two at most, scanned over a few shapes): 12 nats beside
    # some forty looks has a chance under 1e-3.
    assert scored(plain)[0].gain < 12.0


def test_twin_cosines_are_a_gram_matrix_of_what_is_known(with_current):
    candidates = scored(with_current)
    cosines = twin_cosines(candidates)
    names = [candidate.effect.name for candidate in candidates]
    np.testing.assert_array_equal(np.diag(cosines), 1.0)
    np.testing.assert_array_equal(cosines, cosines.T)
    assert cosines.max() <= 1.0 + 1e-12
    # Twins of long standing (closing the loop: .995): a tilt of gravity and a bent arm.
    tilt, bent = names.index("gravity_tilt"), names.index("intrinsic_curvature")
    assert cosines[tilt, bent] > 0.9
    assert cosines[names.index("current"), names.index("stiffness_drift")] < 0.6


def test_a_strength_whose_coarse_run_leaves_all_bounds_is_seen_at_the_finer_step(plain, monkeypatch):
    """The first strength's run is made to leave all bounds at the coarse step: its slope is that of the fine step."""
    problem, fitted = plain.problem, plain.fitted
    run = Problem.residuals_everywhere

    def leaves(self, parameters, unknowns):
        everything = run(self, parameters, unknowns)
        if self.step > problem.step:
            for rows in everything:
                rows[:, :, 0] = RAN_AWAY
        return everything

    undisturbed = responses(problem, fitted)[0]
    monkeypatch.setattr(Problem, "residuals_everywhere", leaves)
    found = responses(problem, fitted)[0]
    for mended, own in zip(found.slopes, undisturbed.slopes, strict=True):
        # The two steps give nearly the same derivative; the lost pair alone would differ by RAN_AWAY over its width.
        assert np.abs(mended[:, :, 0] - own[:, :, 0]).max() < 0.05 * np.abs(own[:, :, 0]).max()

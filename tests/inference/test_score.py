"""The score test: to first order it knows how strong an absent effect is, and that nothing is where nothing is."""

import numpy as np

from inference.score import responses, score, twin_cosines
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

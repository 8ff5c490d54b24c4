"""The latent force's filter: an exact factor of the covariance, and nothing but the noise where no force is unknown."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from inference.evidence import evidence_beside
from inference.latent_force import FASTEST_MODE, discretised, with_scaled_mass
from inference.linearise import latent_forces
from inference.posterior import FORCE_SHARES, filters_at


@pytest.fixture(scope="module")
def forces(plain):
    return latent_forces(plain.problem, plain.fitted.parameters, plain.fitted.nuisances)


def test_whitening_is_the_inverse_root_of_the_covariance(forces):
    """Of its first cells: the whitened unit columns form W with (W'W)^-1 the covariance, so det W is known to be the
    filter's own determinant, cell by cell.
    """
    found = forces[0].filter(0.03)
    cells, count = 6, found.root.shape[1]
    whole = np.zeros((found.cells.place.max() + 1, count, cells * count))
    for cell in range(cells):
        frames = np.flatnonzero(found.cells.cell == cell)
        for channel in range(count):
            whole[found.cells.place[frames[0]], channel, cell * count + channel] = 1.0 / found.cells.weight[frames[0]]
    white = found.whiten(whole).reshape(-1, cells * count)[: cells * count]
    own = np.log(np.abs(np.linalg.det(found.root[:cells]))).sum()
    assert np.linalg.slogdet(white)[1] == pytest.approx(own, rel=1e-9)
    covariance = np.linalg.inv(white.T @ white)
    # Noise alone would be the identity; the unknown force adds to it, and later cells hang together with earlier ones.
    assert np.linalg.eigvalsh(covariance).min() > 1.0 - 1e-9
    assert np.trace(covariance) > cells * count


def test_without_unknown_forces_rows_are_as_white_as_they_were(forces):
    found = forces[0]
    posed = found.seen.copy()
    posed[:, :, found.linearised.mass.shape[0] :] = 0.0  # base angle and scale are never known without any error
    silent = replace(found, linearised=replace(found.linearised, laws=0.0 * found.linearised.laws), seen=posed)
    whitened = silent.filter(1e-9)
    rows = np.random.default_rng(0).standard_normal((found.cells.place.max() + 1, whitened.root.shape[1], 1))
    averaged = whitened.cells.averaged(rows).reshape(-1)
    np.testing.assert_allclose(whitened.whiten(rows)[:, 0], averaged, atol=1e-3 * np.abs(averaged).max())
    assert abs(whitened.log_determinant) < 1.0


def test_an_interval_in_two_halves_is_the_same():
    drift = np.array([[0.0, 1.0], [-400.0, -3.0]])
    diffusion = np.diag([0.0, 2.0])
    whole, half = discretised(drift, diffusion, 0.1), discretised(drift, diffusion, 0.05)
    np.testing.assert_allclose(half[0] @ half[0], whole[0], atol=1e-10)
    np.testing.assert_allclose(half[0] @ half[1] @ half[0].T + half[1], whole[1], atol=1e-12)
    np.testing.assert_allclose(half[0] @ half[2] + half[2], whole[2], atol=1e-9)


def test_a_complete_model_wants_little_unknown_force(plain, forces):
    problem = replace(plain.problem, filters=tuple(force.filter(0.003) for force in forces))
    evidence = [evidence_beside(problem, plain.fitted, filters_at(forces, k)).log for k in range(len(FORCE_SHARES))]
    # A tenth of the acting forces unknown: hundreds of nats too loose for data that the model made itself.
    assert evidence[0] > evidence[4] + 100.0


def test_modes_too_fast_to_be_seen_answer_a_slow_force_by_their_stiffness_alone():
    mass, stiffness = np.array([[1.0, 0.2, 0.0], [0.2, 0.5, 0.0]]), np.array([[4.0, 0.0, 0.0], [0.0, 1e8, 0.0]])
    scaled = with_scaled_mass(mass, stiffness, 0.15)
    before, after = (np.sqrt(eigh(stiffness[:, :2], m[:, :2], eigvals_only=True)) for m in (mass, scaled))
    assert after[0] == pytest.approx(before[0], rel=1e-6)  # the mode that is seen stays as it was
    assert after[1] == pytest.approx(FASTEST_MODE / 0.15, rel=1e-6)


def test_a_stiff_arm_s_filter_is_finite(forces):
    """A silicone beam in air is a thousand times as stiff as its slowest motion needs: the transition must not
    overflow.
    """
    found = forces[0]
    lin = found.linearised
    stiff = lin.stiffness.copy()
    stiff[:, :-1] *= 1e5
    mass = with_scaled_mass(lin.mass, stiff, lin.time)
    made = replace(found, linearised=replace(lin, stiffness=stiff, mass=mass)).filter(0.1)
    assert np.isfinite(made.log_determinant)
    assert np.all(np.isfinite(made.gain))

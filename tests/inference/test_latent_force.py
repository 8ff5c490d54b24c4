"""The latent force's filter: an exact factor of the covariance, and nothing but the noise where no force is unknown."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from inference.cells import Cells
from inference.evidence import evidence_beside
from inference.latent_force import FASTEST_MODE, PLACE, discretised, pose_variance, with_scaled_mass
from inference.linearise import latent_forces
from inference.observation import POSE
from inference.posterior import FORCE_SHARES, filters_at


@pytest.fixture(scope="module")
def forces(plain):
    return latent_forces(plain.problem, plain.fitted.parameters, plain.fitted.nuisances)


def test_whitening_is_the_inverse_root_of_the_covariance(forces):
    """The whitened unit columns form W with (W'W)^-1 the covariance, so det W is known to be the filter's own."""
    found = shortened(forces[0], 8).filter(0.03)
    white = found.whiten(unit_columns(found))
    assert np.linalg.slogdet(white)[1] == pytest.approx(-found.log_determinant, rel=1e-9)
    covariance = np.linalg.inv(white.T @ white)
    # Noise alone would be the identity; the unknown force adds to it, and later cells hang together with earlier ones.
    assert np.linalg.eigvalsh(covariance).min() > 1.0 - 1e-9
    assert np.trace(covariance) > len(white)


def test_the_covariance_is_that_of_the_equations(forces):
    """Summed over the cells by powers of the transition, with every constant and every unit column written out."""
    force = shortened(forces[0], 5)
    found, lin = force.filter(0.1), force.linearised
    n, (cells, channels) = lin.mass.shape[0], force.seen.shape[:2]
    drift, diffusion, start = force.state_equation(0.1)
    transition, added, held = discretised(drift, diffusion, force.cells.interval)
    pushed = held[:, n : 2 * n] @ np.linalg.inv(lin.mass[:, :n])
    f = slice(3 * n + 2, 4 * n + 2)
    size = len(drift)
    constants = np.concatenate([np.repeat(0.1 * lin.force_root[None], cells, axis=0), lin.laws], axis=2)
    deviations = np.repeat([np.sqrt(pose_variance(0.1)), PLACE], [2, force.seen.shape[2] - n - 2])
    offsets = force.seen[:, :, n:] * deviations
    spread, state = start, np.zeros((size, constants.shape[2]))
    seen, driven, spreads, forward = [], [], [], []
    for k in range(cells):
        if k > 0:
            moves = transition.copy()
            moves[:, f] += 0.1 * lin.envelope[k - 1] * pushed @ lin.force_root
            spread, state = moves @ spread @ moves.T + added, moves @ state + pushed @ constants[k - 1]
            forward.append(moves)
        rows = np.zeros((channels, size))
        rows[:, :n], rows[:, 3 * n] = force.seen[k, :, :n], force.seen[k, :, n]
        rows[:, 4 * n + 2 :] = lin.envelope[k] * force.error.rows[k]
        seen.append(rows)
        driven.append(np.concatenate([rows @ state, offsets[k]], axis=1))
        spreads.append(spread)
    covariance = np.eye(cells * channels) + np.concatenate(driven) @ np.concatenate(driven).T
    for k in range(cells):
        between = spreads[k]
        for later in range(k, cells):
            if later > k:
                between = forward[later - 1] @ between
            block = seen[later] @ between @ seen[k].T
            covariance[later * channels : (later + 1) * channels, k * channels : (k + 1) * channels] += block
            if later > k:
                covariance[k * channels : (k + 1) * channels, later * channels : (later + 1) * channels] += block.T
    white = found.whiten(unit_columns(found))
    np.testing.assert_allclose(white @ covariance @ white.T, np.eye(len(white)), atol=1e-6)


def shortened(force, cells):
    """The latent force of the first cells alone, with one frame in each."""
    own = force.cells
    few = Cells(np.arange(cells), np.arange(cells), np.ones(cells), own.t[:cells], own.interval)
    lin = replace(force.linearised, laws=force.linearised.laws[:cells], envelope=force.linearised.envelope[:cells])
    error = replace(force.error, rows=force.error.rows[:cells])
    return replace(force, linearised=lin, cells=few, seen=force.seen[:cells], error=error)


def silent(force):
    """The same without variations of the laws, and with base angle and scale known: they never are without an error."""
    posed = force.seen.copy()
    posed[:, :, force.linearised.mass.shape[0] :] = 0.0
    return replace(force, linearised=replace(force.linearised, laws=0.0 * force.linearised.laws), seen=posed)


def unit_columns(found):
    """One column of rows (T, K, T K) for every row."""
    cells, channels = found.cells.t.size, found.rows // found.cells.t.size
    return np.eye(cells * channels).reshape(cells, channels, -1)


def test_without_unknown_forces_rows_are_as_white_as_they_were(forces):
    found = forces[0]
    whitened = silent(found).filter(1e-9)
    rows = np.random.default_rng(0).standard_normal((found.cells.place.max() + 1, found.seen.shape[1], 1))
    turned = np.matmul(found.seeing.transpose(0, 2, 1), whitened.cells.averaged(rows))
    count = found.error.size.size
    apart = np.concatenate([turned[:, :count].ravel(), turned[:, count:].ravel()])
    np.testing.assert_allclose(whitened.whiten(rows)[:, 0], apart, atol=1e-3 * np.abs(apart).max())
    assert abs(whitened.log_determinant) < 1.0


def test_slow_errors_of_a_track_hide_no_direction_more_than_another(plain):
    """A frame of a film knows one combination of root angle and coordinates a million times better than another."""
    experiment, *others = plain.problem.experiments
    shapes = experiment.observation
    told = [0, *range(POSE, shapes.channels)]
    turned = np.linalg.qr(np.random.default_rng(1).standard_normal((len(told), len(told))))[0]
    root = np.zeros_like(shapes.root)
    root[np.ix_(shapes.seen, told, told)] = np.linalg.qr(np.geomspace(1e6, 1.0, len(told))[:, None] * turned)[1]
    film = replace(experiment, observation=replace(shapes, root=root))
    problem = replace(plain.problem, experiments=(film, *others))
    force = latent_forces(problem, plain.fitted.parameters, plain.fitted.nuisances)[0]
    n, frame = force.linearised.mass.shape[0], int(np.flatnonzero(shapes.seen)[0])
    directions = np.linalg.qr(root[frame][:, [0, *range(POSE, POSE + n)]])[0]  # unit rows of what the model can show
    whitened = silent(force).filter(1e-9).whiten(np.repeat(directions[None], len(shapes.t), axis=0))
    nats = 0.5 * np.sum(whitened**2, axis=0)
    np.testing.assert_allclose(nats, nats.mean(), rtol=1e-3)
    assert nats.mean() < 0.25 * experiment.used.sum()  # a slow error hides a slow change beyond frames' noise


def test_an_interval_in_two_halves_is_the_same():
    drift = np.array([[0.0, 1.0], [-400.0, -3.0]])
    diffusion = np.diag([0.0, 2.0])
    whole, half = discretised(drift, diffusion, 0.1), discretised(drift, diffusion, 0.05)
    np.testing.assert_allclose(half[0] @ half[0], whole[0], atol=1e-10)
    np.testing.assert_allclose(half[0] @ half[1] @ half[0].T + half[1], whole[1], atol=1e-12)
    np.testing.assert_allclose(half[0] @ half[2] + half[2], whole[2], atol=1e-9)


def test_a_motion_that_dies_at_once_is_discretised_as_its_limit():
    """A creeping arm: damping takes away a rate in a hundred-millionth of a second, and its shape drifts as pushed."""
    rate = 1.4e8  # 1/s
    transition, added, held = discretised(np.array([[0.0, 1.0], [0.0, -rate]]), np.diag([0.0, 2.0 * rate]), 0.06)
    np.testing.assert_allclose(transition, [[1.0, 1.0 / rate], [0.0, 0.0]], atol=1e-12)
    # An Ornstein-Uhlenbeck rate of unit variance: the shape's variance grows by 2 t / rate.
    np.testing.assert_allclose(added, [[2.0 * 0.06 / rate, 1.0 / rate], [1.0 / rate, 1.0]], rtol=1e-6)
    np.testing.assert_allclose(held[0], [0.06, 0.06 / rate], rtol=1e-5)


def test_a_complete_model_wants_little_unknown_force(plain, forces):
    problem = replace(plain.problem, filters=tuple(force.filter(0.003) for force in forces))
    tenth = int(np.searchsorted(FORCE_SHARES, 0.1))
    least, more = (evidence_beside(problem, plain.fitted, filters_at(forces, place)).log for place in (0, tenth))
    # A tenth of the acting forces unknown: hundreds of nats too loose for data that the model made itself.
    assert least > more + 100.0


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
    assert np.all(np.isfinite(made.innovations.gain))

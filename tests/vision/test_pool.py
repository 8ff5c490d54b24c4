"""The joint estimate of all frames, and what each frame tells by itself."""

import numpy as np
import pytest

from vision.kinematics import SHARED
from vision.pool import pool
from vision.tracked_frame import TrackedFrame

FRAMES, SIZE = 2000, 4  # [base angle offset, q1, q2, q3]
TURNS, THIRD = 1e-3, 3e-4  # rad: how far the arm's root turns against the servo, and a coordinate hidden in the noise


@pytest.fixture(scope="module")
def filmed():
    """Frames of an arm whose root turns and whose third coordinate is small; true shapes (T, K), covariance (K, K)."""
    rng = np.random.default_rng(5)
    mixed = rng.standard_normal((SIZE, SIZE)) + 2.0 * np.eye(SIZE)
    covariance = 3e-7 * mixed @ mixed.T
    true = rng.standard_normal((FRAMES, SIZE)) * np.array([TURNS, 0.5, 0.2, THIRD])
    seen = true + rng.standard_normal((FRAMES, SIZE)) @ np.linalg.cholesky(covariance).T
    no_g, nothing = np.zeros((SIZE, SHARED)), (np.zeros((SHARED, SHARED)), np.zeros(SHARED))
    frames = [
        TrackedFrame(t, 0.0, x, covariance, "", no_g, *nothing, 0.1, np.zeros(16), np.zeros((0, 2)))
        for t, x in enumerate(seen)
    ]
    return pool(frames, np.zeros(SHARED), None), true, covariance


def test_what_a_frame_tells_by_itself_errs_by_its_covariance(filmed):
    found, true, _ = filmed
    error = found.by_frames.coefficients - true
    square = np.einsum("ti,tij,tj->t", error, np.linalg.inv(found.by_frames.covariance), error)
    assert np.mean(square) == pytest.approx(SIZE, abs=4.0 * np.sqrt(2.0 * SIZE / FRAMES))  # chi-square of T K numbers


def test_the_root_turns_as_far_as_it_does_by_itself_and_less_in_the_joint_estimate(filmed):
    """The joint estimate draws the base's angle towards the mean of all frames, which makes it more accurate, and the
    less so the further it is from there. A model that says how the root turns must not be compared with that.
    """
    found, true, covariance = filmed

    def slope(angle: np.ndarray) -> float:
        return float(np.polyfit(true[:, 0], angle, 1)[0])

    # To hold q3 at zero makes the angle known as well as its error beside that of q3.
    known = 1.0 / np.linalg.inv(covariance[np.ix_([0, 3], [0, 3])])[0, 0]
    drawn = TURNS**2 / (TURNS**2 + known)
    chance = np.sqrt(covariance[0, 0] / FRAMES) / TURNS
    assert drawn < 0.9
    assert slope(found.by_frames.coefficients[:, 0]) == pytest.approx(1.0, abs=4.0 * chance)
    assert slope(found.x[:, 0]) == pytest.approx(drawn, abs=4.0 * chance)


def test_a_coordinate_that_is_held_at_zero_is_there_by_itself(filmed):
    found, true, covariance = filmed
    assert found.order == 2
    third = found.by_frames.coefficients[:, 3]
    chance = np.sqrt(covariance[3, 3] / FRAMES) / THIRD
    assert np.polyfit(true[:, 3], third, 1)[0] == pytest.approx(1.0, abs=4.0 * chance)

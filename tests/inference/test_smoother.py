"""The filter and the smoother of a linear system against the whole Gaussian, conditioned at once."""

import numpy as np

from inference.kalman import filtered_along, smoothed_along


def test_filter_and_smoother_are_the_conditioned_gaussian() -> None:
    """Means, deviations and likelihood to rounding: both are exact, one step after the other or all at once."""
    random = np.random.default_rng(3)
    cells, size, count = 7, 3, 2
    transition = 0.9 * np.linalg.qr(random.normal(size=(size, size)))[0]
    root = random.normal(size=(size, size))
    added, start = root @ root.T / 4.0, np.diag([1.0, 2.0, 0.5])
    seen, rows = random.normal(size=(cells, count, size)), random.normal(size=(cells, count))

    mean, covariance, likelihood = filtered_along(rows, seen, transition, added, start)
    smooth, deviation = smoothed_along(mean, covariance, transition, added)

    spread = [start]
    for _ in range(cells - 1):
        spread.append(transition @ spread[-1] @ transition.T + added)
    joint = np.zeros((cells * size, cells * size))
    for j in range(cells):
        for k in range(j, cells):
            block = np.linalg.matrix_power(transition, k - j) @ spread[j]
            joint[k * size : (k + 1) * size, j * size : (j + 1) * size] = block
            joint[j * size : (j + 1) * size, k * size : (k + 1) * size] = block.T
    observed = np.zeros((cells * count, cells * size))
    for k in range(cells):
        observed[k * count : (k + 1) * count, k * size : (k + 1) * size] = seen[k]
    innovation = observed @ joint @ observed.T + np.eye(cells * count)
    gain = joint @ observed.T @ np.linalg.inv(innovation)
    known = gain @ rows.ravel()
    left = joint - gain @ observed @ joint
    nats = -0.5 * (rows.ravel() @ np.linalg.solve(innovation, rows.ravel()) + np.linalg.slogdet(innovation)[1])
    np.testing.assert_allclose(smooth.ravel(), known, atol=1e-7)
    np.testing.assert_allclose(deviation.ravel(), np.sqrt(np.diag(left)), atol=1e-7)
    np.testing.assert_allclose(mean[-1], known[-size:], atol=1e-9)
    assert abs(likelihood - nats) < 1e-9

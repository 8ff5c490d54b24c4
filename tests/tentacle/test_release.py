"""The instant of a release out of a measured path."""

from __future__ import annotations

import numpy as np

from tentacle.release import find_release


def oscillation(release: float, noise: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """A point held aside by 50 mm and let go: a swing of 1.4 Hz, filmed at 100 Hz."""
    t = np.arange(0.0, 3.0, 0.01)
    since = np.maximum(t - release, 0.0)
    omega, decay = 2.0 * np.pi * 1.4, 0.5  # rad/s, 1/s
    x = 0.05 * np.exp(-decay * since) * (np.cos(omega * since) + decay / omega * np.sin(omega * since))  # from rest
    path = np.stack([x, np.zeros_like(x)], axis=-1)
    return t, path + noise * np.random.default_rng(seed).standard_normal(path.shape)


def test_the_release_of_a_swing_is_found_between_frames() -> None:
    for release in (0.503, 0.61, 0.777):
        found = find_release(*oscillation(release, 2e-5))
        assert found is not None
        assert (
            abs(found.time - release) < 1e-3
        )  # a tenth of a frame: damping of 6 % of critical bends the line so little
        assert found.sd >= 2.5e-3  # never under a quarter of a frame


def test_what_never_moves_was_never_let_go() -> None:
    t, path = oscillation(10.0, 2e-5)
    assert find_release(t, path) is None


def test_a_hand_that_lets_go_slowly_is_known_less_well() -> None:
    t, path = oscillation(0.6, 2e-5)
    slow = path.copy()
    slow[:, 0] -= 0.02 * np.clip((t - 0.2) / 0.4, 0.0, 1.0) ** 3 * (t < 0.6) + 0.02 * (t >= 0.6)
    quick, creeping = find_release(t, path), find_release(t, slow)
    assert quick is not None
    assert creeping is not None
    assert creeping.sd > quick.sd

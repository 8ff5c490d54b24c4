"""Where nothing is named, the answer says how much more than noise the model leaves."""

from __future__ import annotations

import pytest

from discovery.assemble import left_words


@pytest.mark.parametrize(
    ("after", "floor", "said"), [(0.83, 0.005, True), (0.285, 0.213, True), (0.22, 0.21, False), (None, 0.2, False)]
)
def test_an_error_far_above_the_noise_is_told(after: float | None, floor: float, said: bool) -> None:
    words = left_words(after, floor)
    assert bool(words) == said
    assert not said or f"{after:.2g} mm where noise alone would leave {floor:.2g} mm" in words[0]

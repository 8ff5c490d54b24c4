"""What an answer says beside its verdict: what the model leaves, what it explains, and what would have been named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from discovery.assemble import FEWEST_PIECES, explained, left_words
from discovery.detection import of_unnamed
from inference.posterior import declared_model
from tentacle.diagnosis import Limit


@pytest.mark.parametrize(
    ("after", "floor", "said"), [(0.83, 0.005, True), (0.285, 0.213, True), (0.22, 0.21, False), (None, 0.2, False)]
)
def test_an_error_far_above_the_noise_is_told(after: float | None, floor: float, said: bool) -> None:
    words = left_words(after, floor)
    assert bool(words) == said
    assert not said or f"{after:.2g} mm where noise alone would leave {floor:.2g} mm" in words[0]


def test_a_share_that_is_explained_has_an_interval_with_a_width_or_is_not_told(plain) -> None:
    known = declared_model(plain.problem, plain.fitted.nuisances)
    left = np.linspace(0.05, 0.15, FEWEST_PIECES)  # of 1, in each piece of the recording
    base, chosen = replace(known, rest_in_time=np.ones(FEWEST_PIECES)), replace(known, rest_in_time=left)
    found = explained(base, chosen, 0)
    assert found is not None
    assert found.share == pytest.approx(0.9)
    assert 0.85 <= found.low < found.share < found.high <= 0.95
    for pieces in range(FEWEST_PIECES):
        one, other = (replace(h, rest_in_time=h.rest_in_time[:pieces]) for h in (base, chosen))
        assert explained(one, other, 0) is None


def test_what_is_named_has_no_detection_limit() -> None:
    limits = {name: {"p": Limit(0.1, "1")} for name in ("camera_roll", "tip_mass", "wall")}
    assert set(of_unnamed(limits, ("tip_mass", "camera_roll"))) == {"wall"}

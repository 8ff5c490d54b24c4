"""A plant whose motion grows without bound is refused in one line, and does not end a series of trials."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tentacle.errors import InputError
from validation.plants.draw import Filming, drawn
from validation.plants.filmed import Plant, film


def diverging(*_: Any) -> Any:
    return np.linalg.svd(np.full((2, 2), np.nan))  # as the solvers of the plants answer a state that is not finite


def test_a_plant_that_diverges_is_refused():
    with pytest.raises(InputError, match="grows without bound"):
        film(drawn(3, (), {}, Filming(0.6, 25.0, 1e-4), (6.0, 15.0)), Plant(diverging), ())

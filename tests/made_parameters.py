"""Arms and parameters that several tests share."""

from collections.abc import Callable

import numpy as np
import pytest

from affine_model.arm import neutral_parameters, parameter_index


@pytest.fixture
def parameters() -> Callable[..., np.ndarray]:
    """parameters(elasticity_E=2e5, ...): the vector with these values, all else neutral."""

    def make(**values: float) -> np.ndarray:
        vector = neutral_parameters()
        for key, value in values.items():
            effect, name = key.split("__")
            vector[parameter_index(effect, name)] = value
        return vector

    return make

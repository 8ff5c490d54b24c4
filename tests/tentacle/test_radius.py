"""A cone's radii are those of an arm."""

import pytest

from tentacle.errors import InputError
from tentacle.specimen import Cone


@pytest.mark.parametrize("radii", [(1e308, 0.1), (0.1, 1e200)])
def test_a_radius_that_no_arm_has_is_refused(radii: tuple[float, float]) -> None:
    """Its fourth power, in the second moment of area, would not be a finite number."""
    with pytest.raises(InputError, match="not usable"):
        Cone(*radii)

import pytest

from mujoco_ref.third_opinion import _lowest_sine, first_frequency, is_installed
from tentacle.specimen import Specimen
from tests.mujoco_ref.arms import CONE, STRIP


def test_the_lowest_of_three_sines_is_found():
    import numpy as np

    t = np.linspace(0.0, 1.0, 2000)
    x = np.cos(2 * np.pi * 5.1 * t) + 0.1 * np.sin(2 * np.pi * 12.9 * t) + 0.02 * np.sin(2 * np.pi * 24.0 * t)
    assert _lowest_sine(t, x, 5.0) == pytest.approx(5.1, rel=1e-6)


def test_only_round_rods():
    with pytest.raises(ValueError, match="round"):
        first_frequency(Specimen(STRIP, 0.2, 1070.0), 2e5, 5.0)


@pytest.mark.skipif(not is_installed(), reason="PyElastica is not installed (pip install pyelastica)")
def test_pyelastica_lies_between_timoshenko_and_rotary_inertia():
    # The Euler-Bernoulli cone: 5.0754 and 5.1621 Hz; 20 elements lie .06 above their limit of 5.11.
    assert 5.0754 < first_frequency(CONE, 2e5, 5.16, elements=20) < 5.1621 + 0.06

"""Table II as the paper prints it, and the protocol that computes it."""

import numpy as np
import pytest

from affine_model.swim.table2 import FAST_BAND, MAP_LIMITS, PRINTED_SPEEDS, TABLE2_HEADER, cells, ratios, table2
from affine_model.swim.table2_curves import gain


def test_printed_ratios_are_those_of_the_text():
    # Paper IV-D: "5.5 times ... over 2 times ... over 3 times", and 3.5 on average.
    found = [printed.ratio for printed in PRINTED_SPEEDS.values()]
    assert found == pytest.approx([5.5, 2.18, 3.19], abs=0.01)
    assert np.mean(found) == pytest.approx(3.6, abs=0.05)


def test_one_row_keeps_to_the_map_and_gains():
    (row,) = table2(lengths=(0.21,), evaluations=96, seed=2, reference=lambda *_: 0.01)
    slow, fast, gait, _, _ = row.gaits
    for sine in (slow, fast):
        assert sine.alpha[0] <= np.pi / 6 + 1e-9
        assert sine.alpha[3] <= 2 * np.pi * FAST_BAND[1] + 1e-9
    peak = np.max(np.abs(gait(np.arange(0.0, 60.0, 1e-3))[0]))
    assert peak <= MAP_LIMITS.servo.angle * 1.001
    assert max(gait.alpha[3:6]) <= 2 * np.pi * FAST_BAND[1] + 1e-9
    over_map, over_servo = ratios(row.affine)
    # A gait includes the sines, so neither ratio is under one; harmonics alone about double the speed of this arm.
    assert over_map > 1.5
    assert over_servo > 0.999
    # The rail's friction was chosen so that this arm's sine at 3 rad/s swims at the printed 0.52 cm/s.
    assert row.affine[0] == pytest.approx(PRINTED_SPEEDS[0.21].means[0], rel=0.25)
    lines = cells([row])
    assert len(lines) == 3
    assert {len(line) for line in lines} == {len(TABLE2_HEADER)}
    assert row.reference is not None
    assert ratios(row.reference) == (1.0, 1.0)


def test_the_maps_edge_decides_the_ratio_of_the_short_arm():
    """Below its resonance the sines of the 14 cm arm hardly move; a map that reaches it leaves little to gain."""
    narrow, wide = (gain(0.14, edge, 0.35, evaluations=48, seed=1, device=None) for edge in (0.6, 1.5))
    assert narrow > 3.0 * wide
    assert 0.999 < wide < 1.5

"""The plant's own laws: each does what its words say, and vanishes without strength."""

import numpy as np
import pytest

from validation.plants.hidden_law import (
    DELAYED,
    DRAG,
    JET,
    KINDS,
    MAGNET,
    NEAR_POINT,
    ONE_WAY,
    STOP,
    TETHER,
    VORTEX,
    delayed_moment,
    law_at_end,
    law_on_piece,
)
from validation.plants.laws import law_record
from validation.trials.law_trial import CLASSES, FORMS

ARM = {"length": 0.14, "E": 2e5}
HERE = (0.02, 0.1, 1.0, 0.0)  # x, y and a normal along x


def one(**numbers):
    return law_record(**ARM, **numbers).view(np.recarray)[0]


def on_piece(kind, speed, t=0.0, **numbers):
    return law_on_piece.py_func(one(law_kind=kind, **numbers), 0.007, HERE, (speed, 0.0), t)


def at_end(kind, x, y, **numbers):
    return law_at_end.py_func(one(law_kind=kind, **numbers), (x, y), (0.0, 0.0), (1.0, 0.0))


@pytest.mark.parametrize("power", [0.5, 1.5, 3.0])
def test_a_drag_grows_with_its_power_against_the_motion(power):
    slow, fast, back = (on_piece(DRAG, v, law_a=2.0, law_power=power)[0] for v in (0.1, 0.2, -0.2))
    assert slow < 0.0 < back
    assert fast / slow == pytest.approx(2.0**power, rel=1e-6)
    assert back == pytest.approx(-fast)


def test_a_one_way_drag_acts_on_its_side_alone():
    assert on_piece(ONE_WAY, 0.2, law_a=2.0, law_b=1.0, law_power=1.5)[0] < 0.0
    assert on_piece(ONE_WAY, -0.2, law_a=2.0, law_b=1.0, law_power=1.5)[0] == 0.0


def test_what_acts_near_a_point_is_a_third_at_its_reach():
    for kind, share in ((JET, 1.0), (NEAR_POINT, -1.0)):
        numbers = {"law_a": 2.0, "law_power": 1.0, "law_reach": 0.03, "law_y": 0.1}
        near, off = (on_piece(kind, 0.1, law_x=x, **numbers)[0] for x in (0.02, 0.05))
        assert np.sign(near) == share
        assert off / near == pytest.approx(np.exp(-1.0))


def test_a_vortex_force_swings_at_its_frequency():
    numbers = {"law_a": 2.0, "law_power": 2.0, "law_frequency": 2.0}
    push = [on_piece(VORTEX, 0.2, t, **numbers)[0] for t in (0.0, 0.25, 0.5)]
    assert push[0] == pytest.approx(push[2]) == pytest.approx(-push[1])


def test_a_stop_and_a_tether_act_beyond_their_edges_only():
    stop = {"law_a": 0.002, "law_b": 1.0, "law_x": 0.02, "law_power": 1.5}
    assert at_end(STOP, 0.019, 0.14, **stop)[0] == 0.0
    assert at_end(STOP, 0.034, 0.14, **stop)[0] == pytest.approx(-0.002)
    thread = {"law_a": 0.002, "law_x": 0.0, "law_y": 0.0, "law_reach": 0.1}
    assert at_end(TETHER, 0.0, 0.09, **thread) == (0.0, 0.0)
    assert at_end(TETHER, 0.0, 0.14, **thread)[1] == pytest.approx(-0.002 * 0.04 / 0.14)


def test_a_magnet_falls_with_its_power():
    near, far = (np.hypot(*at_end(MAGNET, 0.0, y, law_a=0.002, law_power=3.0)) for y in (0.05, 0.1))
    assert near / far == pytest.approx(8.0, rel=0.01)


def test_a_delayed_spring_forgets():
    laws = one(law_kind=DELAYED, law_a=1.0, law_tau=0.1)
    held, step = 1.0, 1e-3
    for _ in range(100):
        held = 2.0 * delayed_moment.py_func(laws, 0.5, 1e-9, 0.0, held, step)[1] - held
    assert held == pytest.approx(np.exp(-1.0), rel=1e-3)


def test_every_kind_has_a_form_in_the_grammar():
    assert set(FORMS) == set(CLASSES) == set(KINDS[1:])

import numpy as np
import pytest

from mujoco_ref.midline import chain_midline_points
from mujoco_ref.simulate import make_stepper
from mujoco_ref.statics import chain_equilibrium
from tentacle.errors import InputError
from tentacle.specimen import AIR, Gravity, Specimen
from tests.mujoco_ref.arms import CONE, HORIZONTAL, STRIP, model_of, swimming_model

MODULUS = 2e5


def shape_at_rest(stepper, theta=0.0):
    state = chain_equilibrium(stepper, theta)
    angles = np.cumsum(state.q[2:])
    tip = chain_midline_points(angles[None], np.zeros((1, 2)), stepper.chain.specimen.length, np.array([1.0]))[0, 0]
    return tip, angles


def test_own_weight_of_the_horizontal_cone():
    # The elastica: tip at .137193, drop .024279 m (with g = 9.81: scaled here, the drop is linear to 1 %).
    model = model_of(CONE, gravity=Gravity(np.pi / 2, 9.81))
    tip, _ = shape_at_rest(make_stepper(model, links=40))
    assert tip[0] == pytest.approx(0.024279, rel=2e-4)
    assert tip[1] == pytest.approx(0.137193, rel=2e-5)


@pytest.mark.parametrize(
    ("load", "drop", "shortening", "angle"),
    [
        (1, 0.30172, 0.05643, 0.46135),
        (2, 0.49346, 0.16064, 0.78175),
        (5, 0.71379, 0.38763, 1.21537),
        (10, 0.81061, 0.55500, 1.43029),
    ],
)
def test_elastica_with_a_tip_load(load, drop, shortening, angle):
    length = 0.2
    stiffness = MODULUS * float(STRIP.second_moment(0.0))
    payload = load * stiffness / length**2 / HORIZONTAL.magnitude
    light = Specimen(STRIP, length, 1e-3, payload)  # the strip's own weight is 5e-5 of the payload's
    stepper = make_stepper(model_of(light, AIR, HORIZONTAL), links=40)
    tip, angles = shape_at_rest(stepper)
    # 40 links leave 6e-5 (order 2); the targets have five digits.
    assert tip[0] / length == pytest.approx(drop, abs=2e-4)
    assert 1.0 - tip[1] / length == pytest.approx(shortening, abs=2e-4)
    assert -angles[-1] == pytest.approx(angle, abs=3e-4)


def test_elastica_converges_with_order_two():
    length = 0.2
    payload = 5 * MODULUS * float(STRIP.second_moment(0.0)) / length**2 / HORIZONTAL.magnitude
    model = model_of(Specimen(STRIP, length, 1e-3, payload), AIR, HORIZONTAL)
    drops = [shape_at_rest(make_stepper(model, links=links))[0][0] for links in (10, 20, 40)]
    assert np.log2((drops[1] - drops[0]) / (drops[2] - drops[1])) > 1.8


def test_buoyancy_takes_the_weight_off():
    # An arm as heavy as its water hangs straight, however it is held.
    model = swimming_model()
    neutral = model_of(Specimen(CONE.section, 0.14, model.fluid.density), model.fluid, HORIZONTAL)
    _, angles = shape_at_rest(make_stepper(neutral))
    assert np.max(np.abs(angles)) < 1e-9


def test_intrinsic_curvature_is_an_arc_where_nothing_else_acts():
    stepper = make_stepper(model_of(CONE), {"intrinsic_curvature": {"c0": 0.8}}, links=20)
    _, angles = shape_at_rest(stepper)
    np.testing.assert_allclose(angles, 0.8 * np.linspace(0.0, 1.0, 21), atol=1e-9)


def test_a_current_bends_the_arm_downstream():
    tip, _ = shape_at_rest(make_stepper(swimming_model(), {"current": {"U_x": 0.2, "U_y": 0.0}}))
    assert tip[0] > 5e-3


def test_a_thread_pulls_and_never_pushes():
    thread = {"stiffness": 5.0, "anchor_x": 0.05, "anchor_y": 0.14}
    taut, _ = shape_at_rest(make_stepper(swimming_model(), {"thread": {**thread, "slack": 0.04}}))
    slack, _ = shape_at_rest(make_stepper(swimming_model(), {"thread": {**thread, "slack": 0.06}}))
    assert taut[0] > 1e-4
    assert abs(slack[0]) < 1e-9


def test_negative_stiffness_is_refused_with_its_place():
    with pytest.raises(InputError, match=r"k = .* at s = 0.5"):
        make_stepper(model_of(CONE, elasticity={"k0": 0.01, "k1": -0.02}), links=20)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"elasticity": {"E": 0.2}}, "0.2 MPa is 2e5"),
        ({"elasticity": {"E": 2e5, "G": 1.0}}, "no such parameter"),
        ({"wind": {"U": 1.0}}, "no such effect"),
        ({"drag": {"C_perp": float("nan")}}, "finite"),
    ],
)
def test_unusable_models_are_refused_in_one_line(change, match):
    with pytest.raises(InputError, match=match) as error:
        make_stepper(model_of(CONE, **change))
    assert "\n" not in str(error.value)


def test_too_few_links():
    with pytest.raises(InputError, match="links"):
        make_stepper(model_of(CONE), links=0)

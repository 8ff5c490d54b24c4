"""What camera and clock show: each measurement effect by itself, and all of them together."""

import numpy as np

from affine_model.arm import neutral_parameters, parameter_index
from affine_model.camera import sight_of


def _sight(**values: float):
    parameters = neutral_parameters()
    for name, value in values.items():
        effect, parameter = name.split("__")
        parameters[parameter_index(effect, parameter)] = value
    return sight_of(parameters)


def test_without_effects_a_frame_shows_the_arm_as_it_is():
    sight = _sight()
    t = np.array([0.0, 1.5])
    assert (sight.roll, sight.excess, *sight.shift) == (0.0, 0.0, 0.0, 0.0)
    np.testing.assert_array_equal(sight.shown_times(t), t)


def test_the_centre_of_the_roll_stays_where_it_is():
    """R (0, centre) + shift = (0, centre), with every other effect beside it."""
    sight = _sight(camera_roll__roll=0.3, camera_roll__centre=0.7, camera_scale__excess=0.1, time_offset__offset=0.2)
    turn = np.array([[np.cos(sight.roll), -np.sin(sight.roll)], [np.sin(sight.roll), np.cos(sight.roll)]])
    np.testing.assert_allclose(turn @ [0.0, 0.7] + np.array(sight.shift), [0.0, 0.7], atol=1e-15)
    assert (sight.excess, sight.offset) == (0.1, 0.2)


def test_stamps_and_times_undo_each_other():
    sight = _sight(time_offset__offset=-0.03, time_offset__drift=4e-3)
    t = np.linspace(0.0, 39.0, 7)
    np.testing.assert_allclose(sight.seen_times(sight.shown_times(t)), t, rtol=1e-14)

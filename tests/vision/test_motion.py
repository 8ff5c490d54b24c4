"""An edge's sweep over an exposure: against the renderer's mean pictures, and against paths that are known."""

from dataclasses import replace

import numpy as np
import pytest

from tentacle.recording import Declaration
from tentacle.signals import MotorSignal
from vision.encode import write_video
from vision.kinematics import SHARED, Geometry, outline
from vision.looks import CLEAN
from vision.motion import ShapeMotion, sweep
from vision.render import RenderSettings, render
from vision.scene import swaying
from vision.track import track


def test_speed_and_acceleration_of_a_parabola():
    def path(t):
        return np.array([0.3, -1.0]) + np.array([2.0, 1.0]) * t + np.array([-4.0, 6.0]) * t**2

    t0, t1, t = 0.1, 0.13, 0.2  # unequal steps
    speed, acceleration = ShapeMotion(((t0, path(t0)), (t1, path(t1)))).at(t, path(t))
    np.testing.assert_allclose(speed, np.array([2.0, 1.0]) + 2.0 * np.array([-4.0, 6.0]) * t, atol=1e-9)
    np.testing.assert_allclose(acceleration, 2.0 * np.array([-4.0, 6.0]), atol=1e-9)
    later, _ = ShapeMotion(((0.3, path(0.3)), (0.25, path(0.25)))).at(t, path(t))  # from what follows, as well
    np.testing.assert_allclose(later, speed, atol=1e-9)
    assert not np.any(ShapeMotion().at(t, path(t)))
    assert not np.any(ShapeMotion(((t, path(0.0)),)).at(t, path(t)))  # two frames of one time stamp tell no speed


def test_mean_place_of_a_turning_straight_arm():
    scene = swaying(seed=1)
    geometry = Geometry.declared(scene.specimen, scene.camera)
    x, shared = np.zeros(3), np.zeros(SHARED)
    expected = outline(geometry, 0.0, x, shared)
    speed, span = np.array([6.0, 0.0, 0.0]), 0.01
    swept = sweep(geometry, x, shared, expected, (speed, np.zeros(3)), span)
    tip = np.flatnonzero(expected.kind == 0)[-1]
    # the edge is a straight line at a distance from the base that turning keeps: at angle b its crossing with the
    # profile through a point at along, across is across (1 / cos b - 1) - along tan b; even in b: across b^2 / 2
    base = geometry.base
    rest, normal = expected.points[tip] - base, expected.normals[tip]
    across = rest @ normal
    along = np.sqrt(rest @ rest - across**2)
    assert swept.width[tip] == pytest.approx(along * 6.0 * span, rel=1e-3)
    assert swept.shift[tip] == pytest.approx(across * (6.0 * span) ** 2 / 24.0, abs=1e-4)  # px
    assert swept.slip[tip] == pytest.approx(abs(across) * 6.0 * span, rel=1e-3)


def test_a_long_exposure_does_not_bias_the_shape(tmp_path):
    scene = swaying(seed=5, frames=24, size=(960, 540), exposure=0.006)  # the tip moves by up to 7 px
    quiet = replace(CLEAN, noise=0.5)
    frames = render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, quiet, 5))
    write_video(tmp_path / "video.mp4", frames, scene.t)
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    shape = track(tmp_path / "video.mp4", Declaration(scene.specimen, camera=scene.camera), motor)
    assert shape.accepted.all()
    error = shape.coefficients[:, 1:] - scene.q
    assert shape.coefficients.shape[1] == 3  # nothing of the smear is taken for a third coordinate
    # rad; noise leaves .05 and .2 mrad, an edge that is sought at its place of mid exposure leaves 2 and 5
    assert np.sqrt(np.mean(error[:, 0] ** 2)) < 0.2e-3
    assert np.sqrt(np.mean(error[:, 1] ** 2)) < 0.6e-3

"""The validation's own parts, and what must never be accepted with a small sigma."""

from dataclasses import replace

import numpy as np
import pytest

from tentacle.recording import Declaration
from tentacle.signals import MotorSignal
from tests.vision.edge_limit import edge_sigma, shape_limit
from vision.encode import write_video
from vision.looks import CLEAN, TANK_LENS
from vision.picture_limit import jpeg_steps, picture_information, pose_known_limit, recording_limit
from vision.render import RenderSettings, render
from vision.scene import Swing, swaying
from vision.track import track
from vision.validate import false_accepts, judge_disturbed, judge_look, look_table, results_json


def test_limit_has_its_closed_form():
    covariance = shape_limit(np.zeros(2), 0.3, 1.0, 500.0)
    sigma = np.sqrt(np.diag(covariance))
    expected = np.sqrt([720.0, 9072.0]) / (500.0 * np.sqrt(1000.0))
    np.testing.assert_allclose(sigma, expected, rtol=1e-3)  # 500 rows stand for the integral
    assert covariance[0, 1] / np.prod(np.sqrt(np.diag(covariance))) == pytest.approx(-0.987, abs=1e-3)


@pytest.mark.parametrize("disturb", ["hand", "second_arm"])
def test_what_is_in_the_way_is_never_believed(disturb):
    tracked, wrong = judge_disturbed(disturb, seed=3, frames=24, size=(640, 360))
    assert wrong == 0
    assert tracked.shape.accepted.mean() > 0.9


def test_what_leaves_the_picture_widens_the_covariance_and_no_more(tmp_path):
    scene = swaying(seed=5, frames=90, size=(640, 360), swing=Swing(amplitude=1.2))
    tips = scene.camera.to_pixels(scene.midline.xy[:, -1])[:, 0]
    right = int(np.quantile(tips, 0.7))  # the tip is beyond this column in 3 of 10 frames
    frames = [
        f[:, :right] for f in render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1))
    ]
    write_video(tmp_path / "video.mp4", [np.ascontiguousarray(f[:, : right - right % 2]) for f in frames], scene.t)
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    shape = track(tmp_path / "video.mp4", Declaration(scene.specimen, camera=scene.camera), motor)
    outside = tips > right + 15.0
    assert outside.any()
    inside = tips < right - 10.0
    assert shape.accepted[inside].mean() > 0.9
    assert shape.accepted[outside].mean() > 0.5
    spread = np.sqrt(shape.covariance[:, 2, 2])
    assert np.nanmedian(spread[outside]) > 1.5 * np.nanmedian(spread[inside])
    assert false_accepts(scene, shape) == 0


@pytest.mark.long
def test_report_of_a_look_with_a_lens():
    result = judge_look(TANK_LENS, (3,), 20, (960, 540))
    assert result.false_accepts == 0
    assert result.missed < 0.2
    assert result.rms[0] < 4e-3  # rad; some ten times the limit: bubbles are large beside an arm of 356 px
    assert result.rms[0] < 0.1 * result.paper_rms[0]
    assert "tank_lens" in look_table([result])
    assert results_json([result])[0]["look"] == "tank_lens"


def test_the_pictures_limit_is_the_edges_limit_where_nothing_disturbs():
    scene = swaying(seed=1, frames=3, size=(640, 360))
    exact = pose_known_limit(picture_information(scene, CLEAN, 1, 2, range(1, 2)), 2)
    blur = np.sqrt(CLEAN.blur**2 + 1 / 12)  # of the lens, and the pixel's own
    sigma_e = edge_sigma(CLEAN.noise, 150.0, blur)
    rows = shape_limit(scene.q[1], scene.theta[1] + scene.offset, sigma_e, 0.66 * 360)
    np.testing.assert_allclose(exact, np.sqrt(np.diag(rows)), rtol=0.06)  # taper and tip are left out of the latter


def test_jpeg_costs_information_and_its_steps_are_those_of_the_standard():
    assert jpeg_steps(50)[0, 0] == 16
    assert jpeg_steps(85)[7, 7] == 30  # (99 x 30 + 50) // 100
    scene = swaying(seed=1, frames=3, size=(640, 360))
    looks = [replace(CLEAN, jpeg_quality=q) for q in (0, 95, 60)]
    limits = [pose_known_limit(picture_information(scene, look, 1, 2, range(1, 2)), 2)[0] for look in looks]
    assert limits[0] < limits[1] < limits[2]


def test_the_recordings_limit_is_what_the_best_linear_estimate_reaches():
    scene = swaying(seed=2, frames=6, size=(320, 180))
    count, order = 6, 2
    information = picture_information(scene, CLEAN, 2, order, range(count))
    # all frames' q and the recording's constants in one least-squares problem, solved for data drawn with its noise
    roots = np.linalg.cholesky(information)  # a frame's data: L' (q, g) + normal noise of variance 1
    size = order + 4
    design = np.zeros((count * size, count * order + 4))
    for k, root in enumerate(roots):
        rows = slice(k * size, (k + 1) * size)
        design[rows, k * order : (k + 1) * order] = root.T[:, :order]
        design[rows, -4:] = root.T[:, order:]
    noise = np.random.default_rng(0).standard_normal((len(design), 4000))
    error = np.linalg.lstsq(design, noise)[0][: count * order].reshape(count, order, -1)
    reached = np.sqrt(np.mean(error**2, axis=(0, 2)))
    np.testing.assert_allclose(reached, recording_limit(information, order, count), rtol=0.03)  # 4000 draws: 1.5 %
    known = pose_known_limit(information, order)
    assert np.all(recording_limit(information, order, count) > known)  # what must be told costs
    np.testing.assert_allclose(recording_limit(information, order, 10**6), known, rtol=1e-3)  # ... less, the longer

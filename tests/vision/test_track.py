"""Tracking rendered videos, whose truth is known exactly."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.recording import Declaration
from tentacle.signals import MotorSignal
from tentacle.specimen import Cone
from vision.encode import write_video
from vision.follow import Follower
from vision.frame_loop import follow_frames
from vision.frames import Frame
from vision.kinematics import SHARED, Geometry, outline
from vision.lens import Lens
from vision.looks import CLEAN, LIGHT_ARM, TANK, TANK_LENS
from vision.pool import pool
from vision.render import RenderSettings, bend_by_lens, frame_times, render
from vision.scene import Swing, swaying
from vision.scenery import frame_faults
from vision.track import Following, stream_tracking, track, track_fully


def film(scene, look, folder, seed=2, name="video.mp4"):
    path = folder / name
    frames = render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, look, seed), scene.theta)
    write_video(path, frames, frame_times(scene.t, look, seed))
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    return path, Declaration(scene.specimen, camera=scene.camera), motor


def errors(scene, shape):
    """Error (T, K) of [offset, q] and covariance (T, K, K) of the accepted frames; a coordinate not there is 0."""
    index = np.searchsorted(scene.t, shape.t[shape.accepted] - 1e-4)
    size = shape.coefficients.shape[1]
    truth = np.zeros((len(index), max(size, scene.q.shape[1] + 1)))
    truth[:, 0] = scene.offset
    truth[:, 1 : scene.q.shape[1] + 1] = scene.q[index]
    return shape.coefficients[shape.accepted] - truth[:, :size], shape.covariance[shape.accepted]


def z_rms(error, covariance):
    return np.sqrt(np.mean(np.einsum("ti,tij,tj->t", error, np.linalg.inv(covariance), error)) / error.shape[1])


def test_a_thin_arm_errs_as_its_edges_do(tmp_path):
    """An arm of 5 to 3 px, whose middle no pixel shows without blur. Its two sides have one grey; with a grey of each
    side alone q1 and q2 erred by 2.0 and 4.6 mrad rms, 1.8 times the stated errors.
    """
    scene = swaying(seed=2, frames=40, size=(320, 240), swing=Swing(frequency=1.2))
    per_px = scene.camera.metres_per_px
    thin = replace(scene, specimen=replace(scene.specimen, section=Cone(2.5 * per_px, 1.5 * per_px)))
    path, declaration, motor = film(thin, CLEAN, tmp_path)
    shape = track(path, declaration, motor, order=2)
    assert shape.accepted.all()
    error, covariance = errors(thin, shape)
    assert np.all(np.sqrt(np.mean(error[:, 1:] ** 2, axis=0)) < (0.6e-3, 2.0e-3))  # .35 and 1.2 mrad were measured
    assert 0.8 < z_rms(error, covariance) < 1.25  # of 117 values


def test_outline_jacobian_is_the_derivative():
    scene = swaying(seed=1)
    geometry = Geometry.declared(scene.specimen, scene.camera)
    x, shared = np.array([0.02, 0.5, -0.8, 0.3]), np.array([1.0, -2.0, 0.01, 0.5, 0.2, 0.1])
    expected = outline(geometry, 0.3, x, shared)
    step = 1e-5
    for k in range(len(x) + SHARED):
        change = np.zeros(len(x) + SHARED)
        change[k] = step
        ends = [outline(geometry, 0.3, x + c[: len(x)], shared + c[len(x) :]).points for c in (change, -change)]
        numeric = np.sum((ends[0] - ends[1]) / (2 * step) * expected.normals, axis=1)
        np.testing.assert_allclose(expected.jacobian[:, k], numeric, atol=1e-5)  # px; central differences of 500 px


def test_clean_video_is_tracked_at_the_limit(tmp_path):
    scene = swaying(seed=7, frames=40, size=(640, 360))
    shape = track(*film(scene, CLEAN, tmp_path))
    assert shape.accepted.all()
    error, covariance = errors(scene, shape)
    # the limit at 1.5 of 150 grey levels and 238 px of length is .1 and .35 mrad; twice that is the aim
    assert np.sqrt(np.mean(error[:, 1] ** 2)) < 0.25e-3
    assert np.sqrt(np.mean(error[:, 2] ** 2)) < 0.8e-3
    assert 0.7 < z_rms(error, covariance) < 1.4  # 40 frames: sampling spread of some 0.1
    assert shape.scale == pytest.approx(1.0, abs=1e-3)


def test_what_the_declaration_has_wrong_stays_visible(tmp_path):
    scene = swaying(seed=4, frames=30, size=(640, 360))
    path, declaration, motor = film(scene, CLEAN, tmp_path)
    roll = 0.03
    base = np.add(scene.camera.base_px, (4.0, -3.0))
    wrong = replace(
        scene.camera,
        metres_per_px=scene.camera.metres_per_px * 1.02,
        base_px=tuple(base),
        arm_px=(np.sin(roll), np.cos(roll)),
    )
    shape = track(path, replace(declaration, camera=wrong), motor)
    # the arm measures 2 % longer, sits 5 px elsewhere, and is turned: none of it goes into q
    assert shape.scale == pytest.approx(1.02, abs=2e-3)
    axes = np.array([wrong.normal_px, wrong.arm_px])
    np.testing.assert_allclose(shape.base_shift / wrong.metres_per_px, axes @ [-4.0, 3.0], atol=0.2)
    error, _ = errors(scene, shape)
    assert np.mean(error[:, 0]) == pytest.approx(roll, abs=2e-3)
    assert np.sqrt(np.mean(error[:, 1] ** 2)) < 1.5e-3


def test_light_arm_that_points_anywhere_without_a_motor(tmp_path):
    scene = swaying(seed=9, frames=30, size=(640, 360))
    turned = replace(scene.camera, base_px=(320.0, 300.0), arm_px=(0.6, -0.8), mirrored=True)
    scene = replace(scene, camera=turned)
    path, declaration, _ = film(scene, LIGHT_ARM, tmp_path)
    shape = track(path, declaration, None)
    assert shape.accepted.all()
    index = np.searchsorted(scene.t, shape.t - 1e-4)
    error = shape.coefficients[:, 0] - scene.theta[index] - scene.offset
    assert np.sqrt(np.mean(error**2)) < 2e-3  # now the offset is the base angle itself, and each frame has its own


def test_tank_video_with_its_faults(tmp_path):
    scene = swaying(seed=5, frames=40, size=(640, 360), exposure=0.004)
    look = replace(TANK, duplicated=0.1, dropped=0.15)
    result = track_fully(*film(scene, look, tmp_path, seed=8))
    dropped, duplicated = frame_faults(len(scene.t), look, 8)
    repeats = np.array([reason == "repeats the frame before" for reason in result.shape.reason])
    np.testing.assert_array_equal(repeats, duplicated[~dropped])  # every copy, and nothing else
    assert any("missing" in remark for remark in result.remarks)
    assert result.shape.accepted.mean() > 0.8
    error, covariance = errors(scene, result.shape)
    assert np.sqrt(np.mean(error[:, 1] ** 2)) < 3e-3
    assert z_rms(error, covariance) < 2.0


def test_third_coordinate_is_noticed_when_not_fitted(tmp_path):
    scene = swaying(seed=6, frames=20, size=(640, 360), swing=Swing(order=3))
    film_and_words = film(scene, CLEAN, tmp_path)
    assert track(*film_and_words).coefficients.shape[1] == 4  # [offset, q1, q2, q3]
    forced = track_fully(*film_and_words, following=Following(2))
    assert forced.shape.coefficients.shape[1] == 3
    assert any("more curvature than order 2" in remark for remark in forced.remarks)


def test_the_fifth_coordinate_is_found_where_it_is():
    scene = swaying(seed=6, frames=8, size=(1280, 720), swing=Swing(order=5))
    quiet = replace(CLEAN, noise=0.5)
    frames = render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, quiet, 1), scene.theta)
    follower = Follower(
        Geometry.declared(scene.specimen, scene.camera), 0.0, 5, lambda t: float(np.interp(t, scene.t, scene.theta))
    )
    seen = list(follow_frames((Frame(float(t), image) for t, image in zip(scene.t, frames, strict=True)), follower))
    pooled = pool(seen, follower.shared, None)
    assert pooled.order == 5
    error = pooled.x[:, 1:] - scene.q
    assert np.sqrt(np.mean(error[:, 4] ** 2)) < 0.1  # rad, of an amplitude of .27
    z = np.einsum("ti,tij,tj->t", error, np.linalg.inv(pooled.covariance[:, 1:, 1:]), error) / 5
    assert np.sqrt(np.mean(z)) < 1.6  # 8 frames share g, so that errors go together


def test_the_lens_bends_as_the_renderer_s_does():
    lens = Lens((639.5, 359.5), float(np.hypot(640, 360)), TANK_LENS.lens + TANK_LENS.refraction)
    points = np.random.default_rng(0).uniform(0, 700, (50, 2))
    np.testing.assert_allclose(lens.bend(points), bend_by_lens(points, (1280, 720), TANK_LENS), atol=1e-9)


def test_no_arm_in_view_is_one_clear_line(tmp_path):
    scene = swaying(seed=5, frames=4, size=(320, 180))
    empty = [np.full((180, 320), 200, np.uint8)] * 4
    write_video(tmp_path / "empty.mp4", empty, scene.t)
    with pytest.raises(InputError, match=r"empty\.mp4: no arm"):
        track(tmp_path / "empty.mp4", Declaration(scene.specimen, camera=scene.camera), None)


def test_no_camera_declared(tmp_path):
    with pytest.raises(InputError, match="camera"):
        track(tmp_path / "x.mp4", Declaration(swaying(seed=1, frames=2).specimen), None)


def test_a_video_that_a_codec_has_smoothed_is_tracked(tmp_path):
    scene = swaying(seed=1, frames=20, size=(640, 360))
    frames = render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1))
    write_video(tmp_path / "video.mp4", frames, scene.t, crf=18)
    shape = track(
        tmp_path / "video.mp4",
        Declaration(scene.specimen, camera=scene.camera),
        MotorSignal(scene.t, scene.theta, scene.theta),
    )
    assert shape.accepted.mean() > 0.9
    error, covariance = errors(scene, shape)
    # rad; the codec's own errors go with its blocks, far above noise, and differ from scene to scene: 1 to 6 mrad
    assert np.sqrt(np.mean(error[:, 1] ** 2)) < 8e-3
    assert z_rms(error, covariance) < 2.0  # and they are stated


@pytest.mark.long
def test_a_long_video_does_not_grow_in_memory(tmp_path):
    scene = swaying(seed=1, frames=20, size=(160, 120))
    pictures = list(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1)))
    there_and_back = [*range(20), *range(18, 0, -1)]
    order = [there_and_back[k % len(there_and_back)] for k in range(460)]
    times = np.arange(460) / scene.camera.fps
    write_video(tmp_path / "long.mp4", [pictures[k] for k in order], times)
    motor = MotorSignal(times, scene.theta[order], scene.theta[order])
    _, results = stream_tracking(tmp_path / "long.mp4", Declaration(scene.specimen, camera=scene.camera), motor)
    accepted, before = 0, 0
    try:
        for k, seen in enumerate(results):
            accepted += seen.accepted
            if k == 30:
                tracemalloc.start()
            if k == 300:  # as many pictures of the ground as are ever kept: from here on every frame is the same work
                before = tracemalloc.get_traced_memory()[0]
        growth = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    assert accepted > 440
    assert growth < 200_000  # bytes: six pictures in flight; 160 frames' results kept would be 500 kB


def test_tracking_follows_a_file_that_is_still_being_written(tmp_path):
    scene = swaying(seed=1, frames=60, size=(320, 180))
    frames = render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1))
    write_video(tmp_path / "whole.mkv", frames, scene.t)
    data = (tmp_path / "whole.mkv").read_bytes()
    growing = tmp_path / "growing.mkv"
    growing.write_bytes(data[: len(data) * 2 // 3])
    declaration = Declaration(scene.specimen, camera=scene.camera)
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    came: list[float] = []

    def add(result):  # the rest of the file comes only after frames of its first part have been told
        if not came:
            with growing.open("ab") as file:
                file.write(data[len(data) * 2 // 3 :])
        came.append(result.t)

    live = track_fully(growing, declaration, motor, following=Following(order=2, patience=2.0), progress=add).shape
    assert len(came) == 60
    whole = track(tmp_path / "whole.mkv", declaration, motor, order=2)
    np.testing.assert_array_equal(live.coefficients, whole.coefficients)

"""The renderer against geometry: exact coverage, sub-pixel truth, smear, faults, seeds."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from tentacle.errors import InputError
from vision.coverage import polygon_coverage
from vision.encode import write_video
from vision.frames import read_frames
from vision.looks import CLEAN, TANK, look_named
from vision.render import RenderSettings, frame_times, render
from vision.scene import swaying


def test_coverage_sums_to_the_polygon_area():
    rng = np.random.default_rng(1)
    angle = np.sort(rng.uniform(0, 2 * np.pi, 23))
    polygon = np.column_stack([40 + 25.3 * np.cos(angle), 30.7 + 21.9 * np.sin(angle)])
    x, y = polygon.T
    area = 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
    coverage = polygon_coverage(polygon, (80, 60))
    assert coverage.sum() == pytest.approx(area, rel=1e-12)  # exact but for rounding
    rows, columns = np.mgrid[:60, :80]
    # the first moment is that of each pixel's centre: good to a small part of a pixel
    assert (coverage * columns).sum() / area == pytest.approx(_centroid(polygon)[0], abs=2e-3)
    assert (coverage * rows).sum() / area == pytest.approx(_centroid(polygon)[1], abs=2e-3)


def _centroid(polygon):
    x, y = polygon.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    return np.array([((x + np.roll(x, -1)) * cross).sum(), ((y + np.roll(y, -1)) * cross).sum()]) / (3 * cross.sum())


def test_a_pixel_half_covered_is_half():
    square = np.array([[9.5, 9.5], [12.0, 9.5], [12.0, 12.5], [9.5, 12.5]])  # pixel 12 spans 11.5 to 12.5
    coverage = polygon_coverage(square, (20, 20))
    np.testing.assert_allclose(coverage[10:13, 10:14], np.array([[1.0, 1.0, 0.5, 0.0]] * 3), atol=1e-12)


def test_silhouette_area_is_the_arm_and_smear_keeps_it():
    scene = swaying(seed=3, frames=2, size=(320, 200))
    look = replace(CLEAN, noise=0.0)
    sharp = next(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, look, 0))).astype(float)
    smeared_camera = replace(scene.camera, exposure=0.01)
    smeared = next(render(scene.midline, scene.specimen, smeared_camera, RenderSettings(scene.size, look, 0))).astype(
        float
    )
    dark = [(look.ground_level - image).sum() / (look.ground_level - look.arm_level) for image in (sharp, smeared)]
    length = scene.specimen.length / scene.camera.metres_per_px
    expected = length * (0.0125 + 1.5e-3) / scene.camera.metres_per_px  # a bent cone keeps its lamina's area (Pappus)
    assert dark[0] == pytest.approx(expected, rel=3e-3)  # rounding to whole grey levels
    assert dark[1] == pytest.approx(expected, rel=3e-3)


def test_same_seed_same_frames_and_another_seed_others():
    scene = swaying(seed=1, frames=3, size=(320, 180))
    frames = [
        list(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, TANK, seed), scene.theta))
        for seed in (5, 5, 6)
    ]
    assert all(np.array_equal(a, b) for a, b in zip(frames[0], frames[1], strict=True))
    assert not np.array_equal(frames[0][0], frames[2][0])


def test_dropped_frames_leave_gaps_and_repeats_are_copies():
    scene = swaying(seed=1, frames=40, size=(160, 90))
    look = replace(CLEAN, dropped=0.2, duplicated=0.2)
    times = frame_times(scene.t, look, 4)
    frames = list(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, look, 4)))
    assert len(times) == len(frames) < 40
    assert any(np.array_equal(a, b) for a, b in pairwise(frames))


def test_video_keeps_time_stamps_and_every_grey_level(tmp_path):
    rng = np.random.default_rng(0)
    frames = [rng.integers(0, 256, (48, 64), dtype=np.uint8) for _ in range(6)]
    times = np.array([0.3, 0.34, 0.45, 0.46, 1.0, 1.25])  # a variable rate
    write_video(tmp_path / "v.mp4", frames, times)
    read = list(read_frames(tmp_path / "v.mp4"))
    np.testing.assert_allclose([frame.t for frame in read], times, atol=1e-6)  # stamps are in microseconds
    assert all(np.array_equal(a, b.image) for a, b in zip(frames, read, strict=True))


def test_a_failed_video_leaves_nothing(tmp_path):
    with pytest.raises(InputError, match="differ in number"):
        write_video(tmp_path / "v.mp4", [np.zeros((8, 8), np.uint8)] * 3, [0.0, 1.0])
    assert list(tmp_path.iterdir()) == []


def test_unknown_look():
    with pytest.raises(InputError, match="clean, light_arm"):
        look_named("underwater")

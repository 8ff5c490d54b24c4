"""Arms of which a part is not seen: the shape comes, with a covariance that is honest about the hidden part."""

import cv2
import numpy as np
import pytest

from tentacle.recording import Declaration
from tentacle.signals import MotorSignal
from vision.encode import write_video
from vision.looks import BUBBLES, CLEAN
from vision.render import RenderSettings, render
from vision.scene import Swing, swaying
from vision.track import Following, track_fully

FRAMES, WHOLE = 48, 18  # pictures, of which the first show the whole arm


@pytest.mark.parametrize("hides", ["the picture's edge", "a cloth before the tip", "a blob beside the tip"])
def test_a_hidden_part_widens_the_covariance_and_no_more(tmp_path, hides):
    scene = swaying(seed=2, frames=FRAMES, size=(240, 180), swing=Swing(frequency=1.2))
    rng = np.random.default_rng(4)
    tips = [scene.camera.to_pixels(scene.midline.xy[k, -1]) for k in range(FRAMES)]
    lowest = int(max(tip[1] for tip in tips))
    pictures = []
    clear = render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1))
    for k, clean in enumerate(clear):
        picture = np.array(clean)
        if hides == "a cloth before the tip" and k >= WHOLE:
            picture[lowest - 18 :] = int(np.median(clean))
        if hides == "a blob beside the tip" and k >= WHOLE:
            cv2.circle(picture, (int(tips[k][0]) + 14, int(tips[k][1]) - 12), 12, int(np.min(clean)), -1)
        noisy = np.clip(np.rint(picture + 4.0 * rng.standard_normal(picture.shape)), 0, 255).astype(np.uint8)
        pictures.append(noisy[: lowest - 12 - lowest % 2] if hides == "the picture's edge" else noisy)
    video = tmp_path / "film.mp4"
    write_video(video, pictures, scene.t)
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    shape = track_fully(video, Declaration(scene.specimen, camera=scene.camera), motor, Following(order=2)).shape
    kept = np.flatnonzero(shape.accepted & (np.arange(FRAMES) >= WHOLE))
    assert len(kept) > 0.8 * (FRAMES - WHOLE)
    truth = np.column_stack([np.full(FRAMES, scene.offset), scene.q])
    error, covariance = (shape.coefficients - truth)[kept], shape.covariance[kept]
    squares = np.einsum("ti,tij,tj->t", error, np.linalg.inv(covariance), error) / 3
    assert 0.6 < np.sqrt(squares.mean()) < 1.4


def test_bubbles_over_half_of_the_edges_leave_every_stretch_of_the_arm_seen(tmp_path):
    """In this picture more than half of the side edges are covered, but seldom both edges of a stretch."""
    scene = swaying(seed=3, frames=24, size=(640, 360))
    video = tmp_path / "film.mp4"
    pictures = render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, BUBBLES, 3), scene.theta)
    write_video(video, list(pictures), scene.t)
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    shape = track_fully(video, Declaration(scene.specimen, camera=scene.camera), motor, Following(order=2)).shape
    assert shape.accepted.mean() > 0.9
    error = (shape.coefficients - np.column_stack([np.full(24, scene.offset), scene.q]))[shape.accepted]
    squares = np.einsum("ti,tij,tj->t", error, np.linalg.inv(shape.covariance[shape.accepted]), error) / 3
    # three films of 60 frames gave 1.27; a film's frames share base and scale, so that 24 scatter by some tenths
    assert np.sqrt(squares.mean()) < 2.0

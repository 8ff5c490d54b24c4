"""Silhouettes: mean axes of known curves, real video against an outside reference, the paper's pipeline, the board."""

import os
from pathlib import Path

import numpy as np
import pytest

from tentacle.errors import InputError
from vision.body import polynomial_rms, track_body
from vision.calibrate import CharucoBoard, calibrate_lens
from vision.frames import Frame, read_frames
from vision.lens_file import format_lens, read_lens
from vision.looks import CLEAN
from vision.paper_pipeline import paper_axis
from vision.render import RenderSettings, render
from vision.scene import swaying
from vision.silhouette import Axis

DATA = Path(os.environ.get("TENTACLE_DATA", "../shared/data")) / "worm_crops"


def clean_frame(seed=1):
    scene = swaying(seed=seed, frames=1, size=(640, 360))
    return scene, next(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 0)))


def test_paper_axis_lies_on_the_true_midline():
    scene, image = clean_frame()
    axis = paper_axis(image, scene.camera)
    assert axis is not None
    truth = scene.midline.xy[0]
    distance = np.linalg.norm(axis[5:-5, None] - truth[None], axis=2).min(axis=1) / scene.camera.metres_per_px
    # the truth's points are 6 px apart, so that a point between them is up to 3 px from the next one
    assert np.median(distance) < 2.5


def test_a_curve_of_affine_curvature_is_fitted_exactly():
    scene = swaying(seed=3, frames=1)
    points = scene.midline.xy[0] / scene.camera.metres_per_px
    length = float(np.sum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    assert polynomial_rms(Axis(points, np.ones(len(points)), length), 2) < 0.02  # px: the curve's own chords


@pytest.mark.skipif(not (DATA / "reference_midlines.npz").exists(), reason=f"real video is not in {DATA}")
def test_worm_against_the_outside_reference():
    reference = np.load(DATA / "reference_midlines.npz")["midline_px"][::12]
    frames = list(read_frames(DATA / "frames", 15.0))[::12]
    body = track_body(frames)
    known = np.isfinite(reference).all(axis=(1, 2))
    assert body.accepted[known].mean() > 0.95
    distances = []
    for k in np.flatnonzero(known & body.accepted):
        fine = np.stack([np.interp(np.linspace(0, 51, 500), np.arange(52), body.midline[k][:, i]) for i in (0, 1)], 1)
        distances.append(np.median(np.linalg.norm(reference[k][:, None] - fine[None], axis=2).min(axis=1)))
    assert np.median(distances) < 0.8  # px; a plain skeleton lies at 0.66
    assert (~body.accepted[~known]).any()  # coils are among the frames without a reference
    assert "affine fit is bad" in body.words()


@pytest.mark.parametrize("board", [CharucoBoard(), CharucoBoard(12, 10)], ids=["24 markers", "60 markers"])
def test_board_gives_its_scale_and_a_lens_survives_its_file(board, tmp_path):
    found = calibrate_lens([Frame(0.0, board.picture(100))], board)
    assert found.lens.metres_per_px == pytest.approx(0.02 / 100, rel=1e-3)
    assert abs(found.lens.k1) < 1e-3  # a drawn board is seen through no lens
    (tmp_path / "lens.toml").write_text(format_lens(found.lens, rms_px=found.rms_px))
    assert read_lens(tmp_path / "lens.toml") == found.lens


@pytest.mark.parametrize(
    ("line", "field"),
    [
        ("reference_px = 1e-300", "reference_px"),
        (f"reference_px = {'9' * 400}", "reference_px"),
        ("k1 = 1e300", "k1"),
        ("m_per_px = 0", "m_per_px"),
        ("centre_px = [1e300, 60]", "centre_px"),
        ("centre_px = [80]", "centre_px"),
    ],
)
def test_a_lens_that_no_camera_has_is_refused(line, field, tmp_path):
    lines = {"centre_px": "[80, 60]", "reference_px": "100.0", "k1": "0.0", "m_per_px": "0.001"}
    lines[field] = line.partition("= ")[2]
    file = tmp_path / "lens.toml"
    file.write_text("[lens]\n" + "".join(f"{name} = {value}\n" for name, value in lines.items()))
    with pytest.raises(InputError) as caught:
        read_lens(file)
    assert caught.value.field == f"lens.{field}"


@pytest.mark.parametrize("sizes", [(2, 8, 0.02, 0.015), (60, 60, 0.02, 0.015), (8, 6, 0.02, 0.02), (8, 6, 10.0, 0.015)])
def test_what_is_no_board_is_refused(sizes):
    with pytest.raises(InputError, match="--"):
        CharucoBoard(*sizes)

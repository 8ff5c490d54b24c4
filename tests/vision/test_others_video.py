"""What other people's video brings: a reversed log, a wild start, dirt, files to go over by hand, many at once."""

import re
from dataclasses import replace

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.io.reading import read_recording
from tentacle.recording import Declaration
from tentacle.signals import MotorSignal
from tentacle.specimen import Cone
from vision.batch import TrackingBatch, sources_of, track_all
from vision.body_evidence import length_doubts, width_doubts
from vision.declared import DeclaredNumbers
from vision.encode import write_video
from vision.looks import CLEAN
from vision.midline_file import midline_columns, write_midline
from vision.pick import pick, write_pick
from vision.proofread import decided, parse_frames, read_verdicts
from vision.remedy import Watch
from vision.render import RenderSettings, render
from vision.scene import Swing, swaying
from vision.silhouette import Axis
from vision.track import Following, track_fully


@pytest.fixture(scope="module")
def filmed(tmp_path_factory):
    """A swaying arm with a scene's truth: (video, scene, declaration)."""
    scene = swaying(seed=2, frames=45, size=(240, 180), swing=Swing(frequency=1.2))
    video = tmp_path_factory.mktemp("film") / "film.mp4"
    write_video(
        video, render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1)), scene.t
    )
    return video, scene, Declaration(scene.specimen, camera=scene.camera)


def test_a_log_of_the_wrong_sign_is_said_and_one_of_the_right_sign_is_not(filmed):
    video, scene, declaration = filmed
    right = MotorSignal(scene.t, scene.theta, scene.theta)
    assert track_fully(video, declaration, right, following=Following(order=2)).shape.accepted.all()
    with pytest.raises(InputError, match="root turns -1"):
        track_fully(video, declaration, MotorSignal(scene.t, -scene.theta, -scene.theta))


def test_a_length_that_is_not_the_declared_one_is_a_finding_in_words(filmed):
    video, scene, declaration = filmed
    shorter = replace(declaration, specimen=replace(scene.specimen, length=0.97 * scene.specimen.length))
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    remarks = track_fully(video, shorter, motor, following=Following(order=2)).remarks
    assert any("longer than declared" in remark and "tip of the silicone" in remark for remark in remarks)


@pytest.mark.parametrize(("declared", "within"), [(0.004, 3e-4), (None, 2e-3)])
def test_a_rounded_tip_of_4_mm_gives_the_true_scale(tmp_path, declared, within):
    """Declared it is right to .05 px of 158 (the blur rounds a cap of 4.5 px); taken as flat it is .15 % short."""
    scene = swaying(seed=1, frames=24, size=(320, 240), swing=Swing(frequency=1.2))
    arm = replace(scene.specimen, section=Cone(0.0125, 0.004), tip_rounding=0.004)
    film = render(scene.midline, arm, scene.camera, RenderSettings(scene.size, CLEAN, 1))
    write_video(tmp_path / "film.mp4", film, scene.t)
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    declaration = Declaration(replace(arm, tip_rounding=declared), camera=scene.camera)
    tracked = track_fully(tmp_path / "film.mp4", declaration, motor, following=Following(order=2))
    assert tracked.shape.accepted.all()
    assert abs(tracked.shape.scale - 1.0) < within
    if declared is None:  # a tip of untold shape may be half a pixel longer or shorter: the stated error holds it
        assert abs(tracked.shape.scale - 1.0) < 2.0 * tracked.shape.scale_sigma
    assert not any("than declared" in remark for remark in tracked.remarks)


def test_a_length_without_the_rounded_cap_is_told_in_words(tmp_path):
    scene = swaying(seed=1, frames=24, size=(320, 240), swing=Swing(frequency=1.2))
    arm = replace(scene.specimen, section=Cone(0.0125, 0.004), tip_rounding=0.004)
    film = render(scene.midline, arm, scene.camera, RenderSettings(scene.size, CLEAN, 1))
    write_video(tmp_path / "film.mp4", film, scene.t)
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    short = Declaration(replace(arm, length=arm.length - 0.004, tip_rounding=None), camera=scene.camera)
    tracked = track_fully(tmp_path / "film.mp4", short, motor, following=Following(order=2))
    assert any("as much as the tip's radius" in remark for remark in tracked.remarks)


def test_a_base_that_is_elsewhere_is_told_with_its_place(filmed):
    video, scene, declaration = filmed
    u, v = scene.camera.base_px
    off = replace(declaration, camera=replace(scene.camera, base_px=(u - 90.0, v + 60.0)))
    with pytest.raises(InputError, match="begins at base_px") as told:
        track_fully(video, off, None)
    place = [float(number) for number in re.findall(r"base_px = \[(\d+), (\d+)\]", str(told.value))[0]]
    assert np.linalg.norm(np.subtract(place, (u, v))) < 3.0


def test_a_track_that_loses_its_frames_says_so_once():
    watch = Watch()
    said = [watch.look(0.01 * k, "arm not found" if k % 3 else "") for k in range(80)]
    assert [bool(words) for words in said].count(True) == 1
    assert "frames are lost" in next(words for words in said if words)


def test_what_a_person_decides_is_kept_and_holds_in_the_next_run(filmed):
    video, _, declaration = filmed
    assert parse_frames("7, 3-5", "--reject") == [7, 3, 4, 5]
    with pytest.raises(InputError, match="no frame or range"):
        parse_frames("5-3", "--reject")
    with pytest.raises(InputError, match="no frame or range"):
        parse_frames("0-999999999", "--reject")  # 32 years of film
    decided(video, ["3-5", "40"], [])
    decided(video, [], ["4"])
    verdicts = read_verdicts(video)
    assert verdicts == {3: False, 4: True, 5: False, 40: False}
    shape = track_fully(video, declaration, None, following=Following(order=2, verdicts=verdicts)).shape
    by_hand = [k for k, reason in enumerate(shape.reason) if reason == "rejected by hand"]
    assert by_hand == [3, 5, 40]


def test_midlines_read_back_as_an_import_folders_own(filmed, tmp_path):
    video, scene, declaration = filmed
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    shape = track_fully(video, declaration, motor, following=Following(order=2)).shape
    write_midline(shape, scene.theta, scene.specimen, tmp_path / "midline.csv")
    home = write_pick(video, pick(video, DeclaredNumbers(length=0.14)))
    recording_toml = (home / "recording.toml").read_text(encoding="utf-8")
    (tmp_path / "recording.toml").write_text(recording_toml, encoding="utf-8")
    midline = read_recording(tmp_path).midline
    points = midline_columns(shape, scene.theta, scene.specimen)
    np.testing.assert_allclose(midline.xy[:, :, 0], points["x_m"], atol=1e-12)
    off = np.linalg.norm(midline.xy - scene.midline.xy, axis=2)  # 41 points both
    assert off.max() < 0.3 * scene.camera.metres_per_px
    assert read_recording(home).declaration.camera.metres_per_px == pytest.approx(scene.camera.metres_per_px, rel=0.05)


def test_many_videos_give_one_table_and_a_bad_one_is_a_row(filmed, tmp_path):
    video, scene, _ = filmed
    (tmp_path / "films").mkdir()
    (tmp_path / "films" / "a.MP4").write_bytes(video.read_bytes())
    (tmp_path / "films" / "b.mov").write_bytes(b"no video")
    sources = sources_of([tmp_path / "films"])
    arm = DeclaredNumbers(0.14, 0.0125, 0.0015, scene.camera.base_px, scene.camera.metres_per_px)
    rows = track_all(sources, TrackingBatch(arm, 2, None, tmp_path / "out"), workers=1)
    assert [bool(row["problem"]) for row in rows] == [False, True]
    assert rows[0]["accepted"] == 45
    table = (tmp_path / "out" / "summary.csv").read_text(encoding="utf-8").splitlines()
    assert len(table) == 3
    assert (tmp_path / "out" / "a.midline.csv").exists()


def test_dirt_at_an_end_and_at_a_flank_is_doubted_by_length_and_width():
    rng = np.random.default_rng(0)
    s = np.linspace(0.0, 1.0, 52)
    axes: list[Axis | None] = []
    for _ in range(60):
        width = 8.0 * np.sqrt(1.0 - (2.0 * s - 1.0) ** 4) + 0.1 * rng.standard_normal(52)
        axes.append(Axis(np.column_stack([90.0 * s, np.zeros(52)]), width, 90.0 + rng.standard_normal()))
    axes[20] = replace(axes[20], length=100.0)
    bumped = axes[40].width.copy()
    bumped[20:26] += 6.0
    axes[40] = replace(axes[40], width=bumped)
    axes[50] = None
    assert np.flatnonzero(np.abs(length_doubts(axes)) > 5.0).tolist() == [20]
    assert np.flatnonzero(width_doubts(axes) > 5.0).tolist() == [40]

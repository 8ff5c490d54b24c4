"""`tentacle track` as a person calls it: what is refused, what is told, and how it ends."""

from pathlib import Path

import pytest

from tentacle.cli import main
from tentacle.io.write_folder import write_folder
from tentacle.recording import Declaration, Recording
from tentacle.signals import MotorSignal, Video
from vision.encode import write_video
from vision.looks import CLEAN
from vision.render import RenderSettings, render
from vision.scene import swaying


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of 20 pictures of a rendered arm."""
    scene = swaying(seed=4, frames=20, size=(240, 180))
    folder = tmp_path_factory.mktemp("films")
    settings = RenderSettings(scene.size, CLEAN, 1)
    pictures = render(scene.midline, scene.specimen, scene.camera, settings, scene.theta)
    write_video(folder / "film.mp4", pictures, scene.t)
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    declaration = Declaration(scene.specimen, camera=scene.camera)
    write_folder(Recording("clip", declaration, motor=motor, video=Video(folder / "film.mp4")), folder / "clip")
    return folder / "clip"


def test_an_option_for_plain_videos_is_refused_beside_a_recording(clip, tmp_path, capsys):
    """It would not be applied: recording.toml states the base."""
    assert main(["track", str(clip), "--out", str(tmp_path / "a.csv"), "--base-px", "3", "4"]) == 2
    assert "--base-px: is for a plain video" in capsys.readouterr().err
    assert not (tmp_path / "a.csv").exists()


def test_doubtful_frames_have_times_and_decisions_beyond_the_film_are_told(clip, tmp_path, capsys):
    assert main(["track", str(clip), "--out", str(tmp_path / "a.csv"), "--reject", "5,30-31"]) == 0
    told = capsys.readouterr().out
    assert "19 of 20 frames accepted" in told
    assert "2 frames of the proofreading are not in the video: its last one is 19" in told
    doubtful = told.split("most doubtful of the accepted: frames ")[1].split(" s)")[0].split(" (")
    assert float(doubtful[1]) == pytest.approx(int(doubtful[0]) / 60.0, abs=0.005)  # 60 pictures/s, two digits
    # the tip's shape is not declared: half a pixel of 150 px
    assert "for the tip's shape, until tip_rounding_m tells it" in told


def test_a_video_without_an_accepted_frame_ends_with_1(clip, tmp_path, capsys):
    assert main(["track", str(clip), "--out", str(tmp_path / "a.csv"), "--reject", "0-19"]) == 1
    assert "0 of 20 frames accepted" in capsys.readouterr().out

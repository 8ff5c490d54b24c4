"""A plain film, of which only the arm's length is told, or its length and radius: the arm is found, or refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tentacle.cli import main
from tentacle.errors import InputError
from tentacle.signals import Array
from vision import propose
from vision.declared import DeclaredNumbers, found_in, recording_of
from vision.encode import write_video
from vision.frames import Frame, Grey
from vision.known_arm import NOTHING_KNOWN, KnownArm
from vision.lens import Lens
from vision.looks import CLEAN, Look
from vision.propose import propose_among, propose_in
from vision.render import RenderSettings, render
from vision.scene import Scene, Swing, swaying
from vision.track import track_fully

GREY_CLAMP = replace(CLEAN, clamp=True, arm_level=80.0)  # a clamp is drawn with the grey 80
LENGTH, RADIUS = 0.14, 0.0125  # m, of the arm that swaying draws


def _film(look: Look, size: tuple[int, int] = (320, 240), frames: int = 60) -> tuple[Scene, list[Grey]]:
    scene = swaying(seed=3, frames=frames, size=size, swing=Swing(frequency=1.2))
    return scene, list(
        render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, look, 1), scene.theta)
    )


def _points_px(scene: Scene, file: Path) -> Array:
    """Midline points (T, P, 2) [px] that a track wrote, by its arm's length and the picture's own scale."""
    rows = np.genfromtxt(file, delimiter=",", names=True)
    points = np.stack([rows["x_m"], rows["y_m"]], axis=-1).reshape(len(scene.t), -1, 2)
    return points / scene.camera.metres_per_px


def test_the_straight_arm_lies_along_the_nearest_axis_though_the_film_begins_bent(tmp_path):
    """In the first six pictures the arm leans by .5 rad, and nobody has looked at it."""
    scene, film = _film(CLEAN)
    leans = int(np.argmax(np.abs(scene.theta)))
    write_video(tmp_path / "film.mp4", [film[leans]] * 6, np.arange(6) / 60.0)
    camera = recording_of(tmp_path / "film.mp4", DeclaredNumbers(LENGTH), None).declaration.camera
    assert camera is not None
    assert camera.arm_px == (0.0, 1.0)


@pytest.mark.parametrize("told", [("--base-radius", str(RADIUS)), ()])
def test_an_arm_in_a_clamp_of_its_own_grey_is_tracked_by_its_length(tmp_path, told, capsys):
    scene, film = _film(GREY_CLAMP)
    write_video(tmp_path / "film.mp4", film, scene.t)
    out = ["--out", str(tmp_path / "a.csv"), "--midline", str(tmp_path / "m.csv")]
    assert main(["track", str(tmp_path / "film.mp4"), "--length", str(LENGTH), *told, *out]) == 0
    said = capsys.readouterr()
    assert "60 of 60 frames accepted" in said.out
    assert "found in the film: base (" in said.err
    assert "--pick shows it" in said.err
    true = scene.midline.xy / scene.camera.metres_per_px
    off = np.linalg.norm(_points_px(scene, tmp_path / "m.csv") - true, axis=2)
    # 158 px of arm. The base is hidden in the clamp's corners, whose place a silhouette gives to 1 or 2 px; the
    # tracker's scale follows from it, so that all points err by about as much.
    assert np.sqrt(np.mean(off**2)) < 2.0


def test_a_film_without_an_arm_is_refused_in_one_line(tmp_path, capsys):
    rng = np.random.default_rng(0)
    still = np.full((240, 320), 180.0)
    still[:30, 130:190] = 60.0  # a clamp that holds nothing
    film = [np.clip(still + rng.normal(0, 2, still.shape), 0, 255).astype(np.uint8) for _ in range(40)]
    write_video(tmp_path / "film.mp4", film, np.arange(40) / 60.0)
    arguments = ["track", str(tmp_path / "film.mp4"), "--length", str(LENGTH), "--out", str(tmp_path / "a.csv")]
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert "nothing slender stands out" in said
    assert said.count("\n") == 1
    assert not (tmp_path / "a.csv").exists()


@pytest.fixture(scope="module")
def pair(tmp_path_factory) -> tuple[Path, Scene, int]:
    """A film of two equal arms, the second so many px to the right of the scene's."""
    aside = 120
    scene, film = _film(replace(CLEAN, noise=0.0), frames=40)
    clear = np.uint8(CLEAN.ground_level)
    other = [np.full_like(picture, clear) for picture in film]
    for sheet, picture in zip(other, film[::-1], strict=True):
        sheet[:, aside:] = picture[:, :-aside]
    noise = np.random.default_rng(1).normal(0, 1.5, (len(film), *film[0].shape))
    both = [np.minimum(*two) + grain for two, grain in zip(zip(film, other, strict=True), noise, strict=True)]
    video = tmp_path_factory.mktemp("pair") / "film.mp4"
    write_video(video, [np.clip(picture, 0, 255).astype(np.uint8) for picture in both], scene.t)
    return video, scene, aside


def test_two_arms_are_refused_until_the_base_tells_which(pair):
    video, scene, aside = pair
    with pytest.raises(InputError, match=r"another slender body.*--base-px"):
        recording_of(video, DeclaredNumbers(LENGTH), None)
    u, v = scene.camera.base_px
    for base in ((u, v), (u + aside, v)):
        recording = recording_of(video, DeclaredNumbers(LENGTH, base_px=base), None)
        camera = recording.declaration.camera
        assert camera is not None
        assert camera.base_px == pytest.approx(base)  # as it was given
        assert camera.metres_per_px == pytest.approx(scene.camera.metres_per_px, rel=0.03)  # ends are found to 2 %
        assert track_fully(video, recording.declaration, None).shape.accepted.mean() > 0.9


def test_a_body_that_contradicts_the_numbers_is_refused_and_is_shown_by_pick(pair):
    """The arm is 5.6 times as long as wide at its base; one of a third of that radius is not in view."""
    video, scene, _ = pair
    numbers = DeclaredNumbers(LENGTH, RADIUS / 3.0, base_px=scene.camera.base_px)
    with pytest.raises(InputError, match=r"times as long as wide at its base.*--pick"):
        recording_of(video, numbers, None)
    found, _ = found_in(video, numbers)
    assert len(found.doubts) == 1
    wrong = replace(numbers, base_radius=RADIUS, metres_per_px=2.0 * scene.camera.metres_per_px)
    with pytest.raises(InputError, match="by its scale the arm is"):
        recording_of(video, wrong, None)


def test_the_scale_that_is_given_is_taken(pair):
    video, scene, _ = pair
    scale = 1.01 * scene.camera.metres_per_px
    numbers = DeclaredNumbers(LENGTH, base_px=scene.camera.base_px, metres_per_px=scale)
    camera = recording_of(video, numbers, None).declaration.camera
    assert camera is not None
    assert camera.metres_per_px == scale


def test_a_large_picture_is_shrunk_and_the_proposal_is_in_its_own_pixels():
    scene, film = _film(CLEAN, (2560, 1440), 1)
    found = propose_among(film, KnownArm(length_px=LENGTH / scene.camera.metres_per_px, slender=0.5 * LENGTH / RADIUS))
    assert found.doubts == ()
    # the two ends are found to 2 % of 950 px
    assert np.linalg.norm(np.subtract(found.base_px, scene.camera.base_px)) < 19.0
    assert found.length_px == pytest.approx(LENGTH / scene.camera.metres_per_px, rel=0.02)
    tip = scene.camera.to_pixels(scene.midline.xy[0, -1])
    assert np.linalg.norm(np.subtract(found.tip_px, tip)) < 19.0


def test_of_a_film_that_is_being_written_two_seconds_are_looked_at(monkeypatch):
    """A camera of 5 pictures a second, which never ends, does not delay the start."""
    _, film = _film(CLEAN, frames=30)
    read: list[float] = []

    def endless(*_: object) -> Iterator[Frame]:
        for k in range(10_000):
            read.append(k / 5.0)
            yield Frame(k / 5.0, film[k % len(film)])

    monkeypatch.setattr(propose, "read_frames", endless)
    propose_in(Path("camera.mkv"), None, NOTHING_KNOWN, patience=5.0)
    assert max(read) < 2.5


def test_a_straightened_place_bends_to_where_it_is_seen():
    lens = Lens((640.0, 360.0), 734.0, -0.05, 0.01)
    corners = np.array([[0.0, 0.0], [1279.0, 719.0], [640.0, 10.0]])
    np.testing.assert_allclose(lens.bend(lens.straighten(corners)), corners, atol=1e-6)

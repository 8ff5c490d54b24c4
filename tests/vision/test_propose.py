"""A proposal of where the arm is, from a film alone: rendered arms of known base, tip and width."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from tentacle.errors import InputError
from vision.arm_proposal import ArmProposal, picture
from vision.encode import write_video
from vision.looks import CLEAN, LIGHT_ARM, TANK
from vision.propose import propose_among, propose_arm
from vision.render import RenderSettings, render
from vision.scene import swaying


@pytest.mark.parametrize(
    ("look", "polarity", "near"), [(CLEAN, 1.0, 2.0), (LIGHT_ARM, -1.0, 2.0), (replace(TANK, dropped=0.0), 1.0, 7.0)]
)
def test_base_tip_and_width_are_found_in_a_film(tmp_path, look, polarity, near):
    scene = swaying(seed=3, frames=30, size=(320, 240))
    film = list(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, look, 1), scene.theta))
    write_video(tmp_path / "film.mp4", film, scene.t)
    found = propose_arm(tmp_path / "film.mp4")
    assert found.polarity == polarity
    assert np.linalg.norm(np.subtract(found.base_px, scene.camera.base_px)) < near  # px; a clamp hides it
    tip = scene.camera.to_pixels(scene.midline.xy[0, -1])
    assert np.linalg.norm(np.subtract(found.tip_px, tip)) < 4.0
    length = scene.specimen.length / scene.camera.metres_per_px
    assert found.length_px == pytest.approx(length, rel=0.05)
    assert found.width_px[0] == pytest.approx(2 * 0.0125 / scene.camera.metres_per_px, rel=0.15)
    camera = found.camera(scene.specimen.length, 60.0)
    assert camera.metres_per_px == pytest.approx(scene.camera.metres_per_px, rel=0.05)
    shown = picture(film[0], found)
    assert shown.shape == (480, 640, 3)
    assert np.ptp(shown.astype(int), axis=2).max() > 100  # something is drawn in colour


@pytest.mark.parametrize("turned", [0, 1, 2, 3])
def test_the_base_is_where_the_arm_leaves_a_clamp_at_any_side_of_the_picture(turned):
    scene = swaying(seed=3, frames=30, size=(320, 240))
    look = replace(CLEAN, clamp=True, arm_level=80.0)
    film = list(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, look, 1), scene.theta))
    found = propose_among([np.ascontiguousarray(np.rot90(picture, turned)) for picture in film[::3]])
    u, v = scene.camera.base_px
    width, height = scene.size
    base = [(u, v), (v, width - 1 - u), (width - 1 - u, height - 1 - v), (height - 1 - v, u)][turned]
    assert np.linalg.norm(np.subtract(found.base_px, base)) < 2.0  # px; the threshold rounds the inner corners
    assert found.length_px == pytest.approx(scene.specimen.length / scene.camera.metres_per_px, rel=0.02)


@pytest.mark.parametrize(("mean", "straight"), [(0.03, 0.0), (-0.09, 0.0), (0.2, 0.2), (1.6, np.pi / 2)])
def test_the_straight_arm_hangs_along_the_pictures_axis_if_its_mean_is_near(mean, straight):
    arm_px = (np.sin(mean), np.cos(mean))
    found = ArmProposal((100.0, 20.0), (0.0, 0.0), arm_px, (20.0, 8.0), 200.0, 1.0, 1.0, np.zeros((2, 2)))
    assert found.camera(0.1, 30.0).arm_px == pytest.approx((np.sin(straight), np.cos(straight)), abs=1e-12)
    tip = (100.0 + 200.0 * np.sin(straight), 20.0 + 200.0 * np.cos(straight))
    assert found.straight_tip_px() == pytest.approx(tip)


def _held_arm(angle: float) -> np.ndarray:
    """A cone of 504 px at (643, 96) that turns below a wide block; turned, it touches the block's lower edge."""
    picture = np.full((720, 1280), 200, np.uint8)
    cv2.rectangle(picture, (560, 0), (726, 92), 80, -1)
    along, base = np.array([np.sin(angle), np.cos(angle)]), np.array([643.0, 96.0])
    across, tip = np.array([along[1], -along[0]]), base + 504 * along
    corners = [base + 45 * across, tip + 14 * across, tip - 14 * across, base - 45 * across]
    cv2.fillPoly(picture, [np.rint(corners).astype(np.int32)], 48)
    noise = np.random.default_rng(round(1000 * angle) % 97).normal(0, 2, picture.shape)
    return np.clip(picture + noise, 0, 255).astype(np.uint8)


def test_an_arm_that_touches_its_holder_in_most_pictures_is_found_by_the_others():
    """In ten of fifteen pictures arm and block are one body, which is longer than the arm."""
    angles = np.linspace(0.25, 0.6, 15)
    angles[::3] = 0.0
    found = propose_among([_held_arm(angle) for angle in angles])
    assert np.linalg.norm(np.subtract(found.base_px, (643.0, 96.0))) < 3.0  # px
    assert found.length_px == pytest.approx(504.0, rel=0.02)


def _tail(turn: float, bend: float) -> np.ndarray:
    """A tail of 98 px at (60, 70), its angle turn + bend s, whose still trunk gets wider without a corner."""
    fine = 4
    s = np.linspace(0.0, 1.0, 200)
    angle = turn + bend * s
    tail = np.array([60.0, 70.0]) + 98.0 * np.column_stack(
        [np.cumsum(np.cos(angle)) / len(s), np.cumsum(np.sin(angle)) / len(s)]
    )
    back = np.linspace(54.0, 0.0, 60)
    trunk = np.column_stack([60.0 - back, np.full(60, 70.0)])
    half = np.concatenate([3.5 * (1.0 + 2.2 / (1.0 + np.exp(-(back - 20.0) / 5.0))), 3.5 - 2.0 * s])
    line = np.concatenate([trunk, tail])
    along = np.gradient(line, axis=0)
    normal = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1, keepdims=True)
    outline = np.concatenate([line + half[:, None] * normal, (line - half[:, None] * normal)[::-1]])
    picture = np.full((140 * fine, 200 * fine), 150, np.uint8)
    cv2.fillPoly(picture, [np.rint((outline + 0.5) * fine).astype(np.int32)], 95)
    small = cv2.resize(cv2.GaussianBlur(picture, (0, 0), 0.9 * fine), (200, 140), interpolation=cv2.INTER_AREA)
    noise = np.random.default_rng(round(1e4 * (turn + bend)) % 9973).normal(0, 2, small.shape)
    return np.clip(small + noise, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("sway", [0.0, 0.15])
def test_a_tail_is_held_where_it_begins_to_move(sway):
    """The trunk is 1.35 times as wide as the tail only 11 px behind the tail's base. Without a turn at the base the
    motion begins as the square of the distance: then 1 px of it is reached only 15 px beyond.
    """
    phase = np.linspace(0.0, 2.0 * np.pi, 15, endpoint=False)
    found = propose_among([_tail(sway * np.sin(p + 1.0), 0.9 * np.sin(p)) for p in phase])
    assert np.linalg.norm(np.subtract(found.base_px, (60.0, 70.0))) < (5.0 if sway == 0.0 else 2.5)  # px
    assert found.length_px == pytest.approx(98.0, abs=6.0)
    assert "begins to move" in found.words[0]


def _swung(angle: float, tip: float = 60.0) -> np.ndarray:
    """A cone of 150 px at (160, 15) that turns, four times too large; grey 60 at its base, tip at its tip, on 180."""
    fine = 4
    picture = np.full((240 * fine, 320 * fine), 180, np.uint8)
    s = np.linspace(0.0, 1.0, 31)
    heading = angle + 0.6 * angle * s
    steps = 5.0 * np.column_stack([np.sin(heading), np.cos(heading)])
    line = np.array([160.0, 15.0]) + np.cumsum(steps, axis=0) - steps[0]
    across = np.column_stack([np.cos(heading), -np.sin(heading)]) * (7.0 - 4.0 * s)[:, None]
    for k in range(30):
        part = np.array(
            [line[k] - across[k], line[k] + across[k], line[k + 1] + across[k + 1], line[k + 1] - across[k + 1]]
        )
        cv2.fillPoly(picture, [np.rint((part + 0.5) * fine).astype(np.int32)], round(60.0 + (tip - 60.0) * s[k] ** 2))
    return picture


def _seen(picture: np.ndarray, seed: int, dirt: np.ndarray | float = 0.0) -> np.ndarray:
    """A picture through the lens, with noise."""
    small = cv2.resize(cv2.GaussianBlur(picture, (0, 0), 3.6), (320, 240), interpolation=cv2.INTER_AREA)
    noise = np.random.default_rng(seed).normal(0, 2, small.shape)
    return np.clip(small + dirt + noise, 0, 255).astype(np.uint8)


ANGLES = 0.5 * np.sin(np.arange(15) * 0.9)
LENGTH = 150.0


def _is_the_arm(found: ArmProposal) -> None:
    assert np.linalg.norm(np.subtract(found.base_px, (160.0, 15.0))) < 3.0  # px
    assert found.length_px == pytest.approx(LENGTH, rel=0.05)
    assert found.level_arm_px() == (0.0, 1.0)


def test_an_arm_behind_a_post_is_proposed_whole():
    """A post of the ground's grey hides 18 of 150 px in all pictures, and cuts the arm in two."""
    drawn = [_swung(angle) for angle in ANGLES]
    for sheet in drawn:
        sheet[4 * 95 : 4 * 113] = 180
    _is_the_arm(propose_among([_seen(sheet, k) for k, sheet in enumerate(drawn)]))


def test_a_larger_body_that_passes_is_not_the_arm():
    """A hand of 160 px crosses the picture; it has no end that stays in its place."""
    drawn = [_swung(angle) for angle in ANGLES]
    for k, sheet in enumerate(drawn):
        u = 4 * (30 * k - 60)
        cv2.line(sheet, (u, 4 * 190), (u + 4 * 90, 4 * 60), 55, 4 * 40)
    _is_the_arm(propose_among([_seen(sheet, k) for k, sheet in enumerate(drawn)]))


def test_a_tip_that_lets_light_through_is_proposed_in_front_of_dirt():
    """The tip has a third of the contrast, and still dirt on the ground a sixth of it."""
    dirt = cv2.GaussianBlur(np.random.default_rng(3).standard_normal((240, 320)), (0, 0), 4.0)
    pictures = [_seen(_swung(angle, 140.0), k, 6.0 * dirt / dirt.std()) for k, angle in enumerate(ANGLES)]
    _is_the_arm(propose_among(pictures))


def test_two_arms_that_cross_are_no_arm():
    """In the pictures where they cross they are one body, whose area no axis times width gives."""
    pictures = []
    for k, angle in enumerate(ANGLES):
        both = np.minimum(_swung(angle), np.roll(_swung(-0.8 * angle), 4 * 45, axis=1))
        pictures.append(_seen(both, k))
    found = propose_among(pictures)
    assert min(abs(found.base_px[0] - 160.0), abs(found.base_px[0] - 205.0)) < 3.0
    assert found.length_px == pytest.approx(LENGTH, rel=0.05)


def test_an_empty_picture_is_one_line():
    empty = (200 + np.random.default_rng(0).normal(0, 2, (120, 160))).astype(np.uint8)
    with pytest.raises(InputError, match="nothing slender"):
        propose_arm(empty)


@pytest.mark.parametrize("shape", [(1, 1), (2, 300), (3000, 2), (1, 5000), (16, 16), (12, 4000)])
def test_a_picture_too_narrow_for_an_arm_is_one_line(shape):
    with pytest.raises(InputError, match=r"too narrow|nothing slender"):
        propose_arm(np.random.default_rng(0).integers(0, 255, shape).astype(np.uint8))

"""The light learnt from many pictures: a smooth field through its greys, the ground without what moves over it."""

import cv2
import numpy as np
import pytest
from scipy.special import ndtr

from vision.field import Field
from vision.greys_beside import level_sums
from vision.lens import Lens
from vision.levels import KnownLight, side_greys
from vision.light import Light
from vision.profiles import Bars, Pixels

SIZE = (640, 360)


def lamp(place: np.ndarray) -> np.ndarray:
    """A light that falls to a corner, with a broad spot."""
    spot = np.exp(-np.sum((place - (250.0, 150.0)) ** 2, axis=-1) / (2.0 * 150.0**2))
    return 0.7 + 2e-4 * place[..., 0] - 1e-4 * place[..., 1] + 0.15 * spot


def test_a_field_follows_smooth_light_and_goes_on_straight_where_nothing_told_it():
    rng = np.random.default_rng(1)
    place = rng.uniform((0.0, 0.0), (400.0, 360.0), (20_000, 2))
    field = Field.over(SIZE).adding(place, 150.0 * lamp(place) + rng.normal(0.0, 0.5, 20_000), np.full(20_000, 20.0))
    field = field.settled()
    inside = rng.uniform((10.0, 10.0), (390.0, 350.0), (500, 2))
    # a cell's straight line is off the spot by cell^2 / 8 of its curvature: 0.1 grey; noise adds .5 / sqrt(20) at most
    assert np.abs(field.at(inside) - 150.0 * lamp(inside)).max() < 0.3
    plane = Field.over(SIZE).adding(place, 0.1 * place[:, 0] + 20.0, np.ones(20_000)).settled()
    assert plane.at(np.array([[600.0, 100.0]])) == pytest.approx(80.0, abs=0.05)
    assert field.told(np.array([[600.0, 100.0]])) == 0.0
    assert field.told(inside).min() > 300.0  # 400 000 pixels over 24 x 22 nodes: 750 each


def test_two_halves_joined_are_the_field_of_the_whole():
    rng = np.random.default_rng(2)
    place, grey = rng.uniform((0.0, 0.0), SIZE, (3000, 2)), rng.normal(100.0, 9.0, 3000)
    half = [Field.over(SIZE).adding(place[k], grey[k], np.ones(1500)) for k in (slice(1500), slice(1500, 3000))]
    whole = Field.over(SIZE).adding(place, grey, np.ones(3000)).settled()
    np.testing.assert_allclose(half[0].joined(half[1]).settled().grey, whole.grey, rtol=1e-9)


def test_a_field_is_as_smooth_as_the_light_that_told_it():
    rng = np.random.default_rng(5)
    place, pixels = rng.uniform((0.0, 0.0), SIZE, (4000, 2)), np.full(4000, 5.0)
    even = 150.0 + rng.normal(0.0, 2.0 / np.sqrt(5.0), 4000)
    flat = Field.over(SIZE).adding(place, even, pixels).chosen(2.0)
    # a plane through 4000 x 5 pixels errs by 2 sqrt(3 / 20 000) = .024; each node by itself would err by .3
    assert np.abs(flat.at(place) - 150.0).max() < 0.1
    assert flat.freedom() < 10.0
    spots = 150.0 + 20.0 * np.cos(place[:, 0] / 60.0) * np.cos(place[:, 1] / 60.0)
    rough = Field.over(SIZE).adding(place, spots + even - 150.0, pixels).chosen(2.0)
    # noise of 2 / sqrt(20) a node, cells of 16 px bilinear to 16^2 / 8 x 20 / 60^2 = .2 twice over; a plane misses 10
    assert np.sqrt(np.mean((rough.at(place) - spots) ** 2)) < 0.8
    # the rest is the noise's: a chi-square of as many pixels' means as there are, less what the field chose
    assert flat.misfit() / 2.0**2 == pytest.approx(4000 - flat.freedom(), rel=0.1)


def pictures(count: int):
    """An arm that swings over lit ground; a bubble drifts, a shadow goes with the arm: (image, sides, normal, told)."""
    rng = np.random.default_rng(3)
    rows, columns = np.indices(SIZE[::-1])
    light = lamp(np.stack([columns, rows], axis=-1))
    s = np.linspace(0.0, 1.0, 120)[:, None]
    for k in range(count):
        turn = 0.6 * np.sin(0.13 * k) * s
        centre = np.array([320.0, 40.0]) + 220.0 * s * np.concatenate([np.sin(turn), np.cos(turn)], axis=1)
        normal = np.concatenate([np.cos(turn), -np.sin(turn)], axis=1)
        sides = (centre + 14.0 * normal, centre - 14.0 * normal)
        scene = np.full(SIZE[::-1], 180.0)
        shifted = [np.rint(side + np.array([40.0, 6.0])).astype(np.int32) for side in sides]
        cv2.fillPoly(scene, [np.concatenate([shifted[0], shifted[1][::-1]])], 170.0)  # the shadow
        cv2.circle(scene, (int(150 + 2 * k), 250), 9, 90.0, -1)  # the bubble
        outline = np.rint(np.concatenate([sides[0], sides[1][::-1]])).astype(np.int32)
        cv2.fillPoly(scene, [outline], 60.0)
        image = np.rint(scene * light + rng.normal(0.0, 1.5, light.shape)).astype(np.uint8)
        told = []
        for away in (-5.0, 5.0):
            steps = zip(sides, (away * normal, -away * normal), strict=True)
            place = np.concatenate([(side + step)[:115] for side, step in steps])  # not the end, which 3 x 3 px mix
            grey = cv2.blur(image, (3, 3)).astype(float)[tuple(np.rint(place[:, ::-1]).astype(int).T)]
            told.append(np.column_stack([np.full(len(place), 9.0), grey, place]))
        yield image, sides, normal, (told[0], told[1])


def test_the_light_is_the_lamps_though_a_shadow_moves_with_the_arm_and_a_bubble_drifts():
    light = Light(SIZE)
    for k, (image, sides, _, told) in enumerate(pictures(160)):
        light.learn(k / 60.0, image, Lens(), sides, told, 1.5)
    _, sides, normal, _ = list(pictures(25))[-1]
    beyond = sides[0][75:], normal[75:]  # that the arm swings over; nearer to its base the shadow stands still
    greys, known = light.beside(*beyond, Lens())
    assert known.all()
    truth = lamp(beyond[0])
    # whole greys, blocks of 4 px beside an edge drawn in whole px: half a grey of a hundred
    assert np.abs(greys[:, 0] - 60.0 * truth).max() < 1.0
    assert np.abs(greys[:, 1] - 180.0 * truth).max() < 0.5  # the shadow takes 8.5
    step = 3.0 * normal[75:]
    slope = 180.0 * (lamp(beyond[0] + step) - lamp(beyond[0] - step)) / 6.0
    assert np.abs(greys[:, 2] - slope).max() < 0.05  # over the 3 px of a profile: .15 grey


def test_a_picture_that_was_learnt_is_not_learnt_twice():
    twice, once = Light(SIZE), Light(SIZE)
    for k, (image, sides, normal, told) in enumerate(pictures(4)):
        for _ in range(3):
            twice.learn(k / 60.0, image, Lens(), sides, told, 1.5)
        once.learn(k / 60.0, image, Lens(), sides, told, 1.5)
        np.testing.assert_array_equal(
            twice.beside(sides[0], normal, Lens())[0], once.beside(sides[0], normal, Lens())[0]
        )


def profiles(inside: float, outside: float, slope: float, seed: int):
    """Pixels about 240 edges of one side, 12 each: (kind, start, grey, place) of a blurred step with noise."""
    rng = np.random.default_rng(seed)
    place = np.tile(np.linspace(-5.5, 5.5, 12), 240)
    share = ndtr(place)
    grey = (1.0 - share) * inside + share * (outside + slope * place) + rng.normal(0.0, 2.0, len(place))
    return np.zeros(240), np.arange(0, 12 * 240 + 1, 12), grey, place


@pytest.mark.parametrize("shadow", [0.0, 8.0])
def test_greys_are_the_lights_unless_the_picture_contradicts_it(shadow):
    kind, start, grey, place = profiles(60.0, 180.0 - shadow, 0.4 if shadow else 0.0, seed=4)
    shape = Pixels(start, grey, place), Bars(np.full(240, 40.0), 1.0, np.zeros(240))
    lit = np.tile([60.2, 179.9, 0.0, 0.0], (240, 1))
    light = KnownLight(lit, np.ones(240, dtype=bool))
    sums = level_sums(*shape, 1.0 / 3.0, np.zeros((240, 2)), np.ones(240))
    without = level_sums(*shape, 0.0, np.ascontiguousarray(lit[:, ::3]), np.ones(240))
    greys, known, contradicted = side_greys(kind, np.ones(240, dtype=bool), sums, 1.0 / 3.0, light, without)
    assert known.all()
    if not shadow:
        assert contradicted == 0.0
        np.testing.assert_array_equal(greys, lit)
    else:
        assert contradicted > 0.95
        # noise over 33 edges of five free pixels each: 2 / sqrt(165) = .16; four of it
        assert np.abs(greys[:, 0] - 60.0).max() < 0.65
        assert np.abs(greys[:, 1] - 172.0).max() < 0.65
        assert np.abs(greys[:, 2] - 0.4).max() < 0.2

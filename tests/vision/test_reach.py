"""An arm's length by how far it is seen, its width as evidence of what covers it, and a film against itself."""

from dataclasses import replace

import numpy as np
import pytest

from vision.edge_look import EdgeLook
from vision.edges import Edges
from vision.kinematics import SHARED, Geometry, outline
from vision.looks import CLEAN
from vision.pool import KnownBefore, pool
from vision.reach import AHEAD, FROM, STEPS, SeenEnd, led_to_end, seen_reach
from vision.render import RenderSettings, render
from vision.scene import swaying
from vision.tracked_frame import TrackedFrame
from vision.width import another_width, usual_widths


@pytest.mark.parametrize("declared", [0.93, 1.0, 1.08])
def test_the_reach_tells_how_long_an_arm_is_and_whether_its_tip_lies_beside_the_fit(declared):
    scene = swaying(seed=3, frames=1, size=(320, 240))
    picture = next(iter(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1))))
    geometry = Geometry.declared(scene.specimen, scene.camera)
    geometry = replace(geometry, length=declared * geometry.length)
    x = np.array([scene.offset, *scene.q[0]])
    dark, light = np.quantile(picture, (0.005, 0.5))
    sight = EdgeLook(1.0, 1.0, float(light - dark))
    shared = np.zeros(SHARED)
    course = geometry.midline(scene.theta[0], x, shared)
    reach, off = seen_reach(picture, geometry, course, shared, sight)[:2]
    assert reach == pytest.approx(1.0 / declared, abs=0.03)
    assert off < 2.0
    line, heading = course
    last = round(0.85 * len(line))
    turn = np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])
    bent = np.concatenate([line[:last], line[last] + (line[last:] - line[last]) @ turn])
    assert seen_reach(picture, geometry, (bent, heading), shared, sight).off > 2.0


def test_the_reach_of_a_large_picture_is_as_right_as_that_of_a_small_one():
    """At 3840 x 2160 an arm of 1426 px may lie 9 px beside the nearest of the tried arcs."""
    scene = swaying(seed=1, frames=1, size=(3840, 2160))
    picture = next(iter(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1))))
    geometry = Geometry.declared(scene.specimen, scene.camera)
    dark, light = np.quantile(picture[::8, ::8], (0.005, 0.5))
    course = geometry.midline(scene.theta[0], np.array([scene.offset, *scene.q[0]]), np.zeros(SHARED))
    seen = seen_reach(picture, geometry, course, np.zeros(SHARED), EdgeLook(1.0, 1.0, float(light - dark)))
    assert seen.share == pytest.approx(1.0, abs=0.5 * AHEAD / STEPS)  # half a step of the search


def test_a_side_that_something_covers_is_told_by_the_arms_width():
    scene = swaying(seed=1, size=(320, 240))
    geometry = Geometry.declared(scene.specimen, scene.camera)
    expected = outline(geometry, 0.1, np.array([0.0, 0.4, 0.2]), np.zeros(SHARED))
    count = len(expected.s)
    offset = 0.05 * np.random.default_rng(0).standard_normal(count) + 0.8 * (expected.kind < 2)
    edges = Edges(
        offset,
        *(np.zeros(count) for _ in range(4)),
        np.ones(count, bool),
        np.zeros((count, 2)),
        np.zeros((count, 2, 3)),
    )
    sides = expected.kind < 2
    usual = usual_widths([(expected, edges, sides.astype(float))])
    assert not another_width(expected, edges, sides, usual).any()  # 1.6 px wider everywhere is the film's own width
    left = np.flatnonzero(expected.kind == 0)[40:70]
    offset[left] -= 0.25 * expected.depth[left]
    odd = another_width(expected, edges, sides, usual)
    assert odd[left].all()
    assert odd[left + np.count_nonzero(expected.kind == 0)].all()
    assert odd.sum() < 2 * (30 + 20)


def test_sides_that_contradict_the_seen_length_are_believed_less():
    """Frames all of whose sides say, within .1 %, an arm 8 % longer than its tip shows."""
    information = np.diag([0.0, 0.0, 1e6 / 20, 0.0, 0.0, 0.0])
    frames = [
        TrackedFrame(
            t=0.1 * k, theta=0.0, x=np.array([0.01 * (-1.0) ** k, 0.3, 0.1]), covariance=1e-6 * np.eye(3), reason="",
            dx_dg=np.zeros((3, SHARED)), shared_information=information, shared_gradient=0.08 * information[:, 2],
            sigma=0.1, waves=np.ones(17), outline_px=np.zeros((0, 2)),
        )
        for k in range(20)
    ]  # fmt: skip
    seen = np.diag([0.0, 0.0, 0.02**-2, 0.0, 0.0, 0.0])
    contradicted = pool(frames, np.zeros(SHARED), 2, known=KnownBefore(seen, np.zeros(SHARED)))
    assert abs(contradicted.shared[2]) < 0.02
    assert contradicted.shared_covariance[2, 2] > (0.005) ** 2
    agreed = pool(frames, np.zeros(SHARED), 2, known=KnownBefore(seen, 0.06 * seen[:, 2]))
    assert agreed.shared[2] == pytest.approx(0.08, abs=1e-3)


def test_an_arm_that_leaves_the_picture_does_not_tell_where_it_ends():
    scene = swaying(seed=3, frames=1, size=(320, 240))
    whole = next(iter(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1))))
    geometry = Geometry.declared(scene.specimen, scene.camera)
    dark, light = np.quantile(whole, (0.005, 0.5))
    course = geometry.midline(scene.theta[0], np.array([scene.offset, *scene.q[0]]), np.zeros(SHARED))
    leaves = round(0.8 * (len(course[0]) - 1))
    cut = np.ascontiguousarray(whole[: int(course[0][leaves, 1])])
    seen = seen_reach(cut, geometry, course, np.zeros(SHARED), EdgeLook(1.0, 1.0, float(light - dark)))
    assert np.isnan(seen.share)
    assert np.isnan(seen.off)


def test_a_shape_is_led_along_the_arc_to_the_seen_end():
    x = np.array([0.1, 0.8, -0.5, 0.3, 0.0, 0.0])
    s = np.linspace(0.0, 1.0, 101)
    powers = np.array([np.ones(len(s)), *(s**k / k for k in range(1, 6))]).T
    turn, bend = 0.15, -2.0
    led = powers @ led_to_end(x, SeenEnd(1.0, 3.0, turn, bend))
    at = np.interp(FROM, s, powers @ x)
    wanted = np.where(s > FROM, at + turn + bend * (s - FROM), powers @ x)
    assert np.sqrt(np.mean((led - wanted) ** 2)) < 0.05  # rad: a polynomial has no kink

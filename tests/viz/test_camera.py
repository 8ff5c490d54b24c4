"""What the camera's view draws: the measured midline, and each model as the outline of its arm."""

from __future__ import annotations

import numpy as np
import pytest

from tentacle.specimen import Cone
from viz.midline import perimeter
from viz.palette import BASE, MEASURED
from viz.scene import Party, ViewedRun
from viz.topics.camera import drawn_points

ARM = Cone(0.012, 0.004)
S = np.linspace(0.0, 1.0, 65)
ANGLE = np.array([0.0, 0.4])[:, None] * S  # a straight arm, and one on an arc
STEP = 0.14 / 64
XY = np.concatenate(
    [np.zeros((2, 1, 2)), STEP * np.cumsum(np.stack([-np.sin(ANGLE), np.cos(ANGLE)], axis=-1)[:, :-1], axis=1)], axis=1
)


def scene(points: str = "midline") -> ViewedRun:
    parties = (Party("measured", MEASURED, XY), Party("base", BASE, XY))
    return ViewedRun("x", np.arange(2.0), S, np.zeros(2), parties, np.ones(2, dtype=bool), points)  # type: ignore[arg-type]


def test_the_measured_arm_is_its_midline_and_a_model_its_outline() -> None:
    run = scene()
    assert drawn_points(run, run.subject, ARM) == pytest.approx(XY[:, ::2])
    outline = drawn_points(run, run.models[0], ARM)
    count = outline.shape[1] // 2
    left, right = outline[:, :count], outline[:, count:][:, ::-1]
    thickness = 2.0 * ARM.half_thickness(S[::2])
    assert np.linalg.norm(left - right, axis=-1) == pytest.approx(np.tile(thickness, (2, 1)))
    assert 0.5 * (left + right) == pytest.approx(XY[:, ::2])  # about the model's own midline


def test_markers_are_joined_by_a_line_as_no_midline_is_known_between_them() -> None:
    run = scene("markers")
    assert drawn_points(run, run.models[0], ARM) == pytest.approx(XY[:, ::2])


def test_the_outlines_of_many_instants_are_those_of_each() -> None:
    each = [perimeter(one, S, ARM) for one in XY]
    assert perimeter(XY, S, ARM) == pytest.approx(np.stack(each))

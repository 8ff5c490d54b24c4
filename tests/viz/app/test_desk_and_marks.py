"""What is clicked gives the camera, what is chosen is kept where it is read, two answers are set side by side."""

from __future__ import annotations

import asyncio
import gc
import json
import math
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("nicegui", reason="nicegui is not installed: pip install tentacle-twin[app]")

from tentacle.errors import InputError
from viz.app.desk import Desk, Proposed
from viz.app.job import Job
from viz.app.marks import Marks, arm_outline
from viz.app.tables import compared


def nothing(film: Path) -> Proposed:
    raise InputError("no arm", file=film)


def test_the_scale_is_the_rulers_where_it_was_clicked_and_the_arms_else():
    marks = Marks({"base": (320.0, 40.0), "tip": (320.0, 240.0)}, length=0.14, ruler=0.05)
    assert marks.metres_per_px() == pytest.approx(0.14 / 200)
    ruled = marks.with_point("ruler start", (10.0, 10.0)).with_point("ruler end", (110.0, 10.0))
    assert ruled.metres_per_px() == pytest.approx(0.0005)
    assert ruled.with_point("width", (345.0, 50.0)).base_radius() == pytest.approx(25 * 0.0005)


def test_the_declared_arm_lies_where_the_camera_says_and_turns_with_the_servo():
    camera = Marks({"base": (320.0, 40.0), "tip": (320.0, 240.0)}, length=0.2).camera(30.0)
    (_, right, left, _) = arm_outline(camera, 0.2, (0.01, 0.0), 0.0)
    assert right == pytest.approx((320.0, 240.0))
    assert left == pytest.approx((320.0, 240.0))
    turned = arm_outline(camera, 0.2, (0.01, 0.0), 0.3)[1]
    # theta turns the arm from y towards -x, as tentacle.recording.Camera maps it to the picture
    assert turned == pytest.approx(tuple(camera.to_pixels(np.array([-0.2 * math.sin(0.3), 0.2 * math.cos(0.3)]))))


@pytest.mark.parametrize("points", [{}, {"base": (1.0, 1.0)}, {"base": (1.0, 1.0), "tip": (1.5, 1.0)}])
def test_too_few_points_are_named(points):
    with pytest.raises(InputError):
        Marks(points).camera(30.0)


@pytest.mark.parametrize("name", ["", "../up", "a b", "x_answer"])
def test_a_name_that_is_no_folder_of_the_desk_is_refused(tmp_path, name):
    with pytest.raises(InputError, match="is no name"):
        Desk(tmp_path, nothing).place(name)


def test_two_answers_are_told_side_by_side(tmp_path):
    one = {
        "verdict": "effect", "effects": ["current"], "confidence": 0.9,
        "parameters": {"current": {"U_x": {"value": 0.04, "low": 0.03, "high": 0.05, "unit": "m/s"}}},
        "error": {which: {"midline_mm": mm} for which, mm in (("before", 2.0), ("after", 0.1), ("floor", None))},
    }  # fmt: skip
    other = {**one, "verdict": "nothing_missing", "effects": [], "parameters": {}}
    rows = {row["what"]: (row["one"], row["other"]) for row in compared(one, other)}
    assert rows["verdict"] == ("effect", "nothing missing")
    assert rows["current.U_x [m/s]"] == ("0.040 (0.030 to 0.050)", "-")
    (tmp_path / "a").mkdir()
    (tmp_path / "a_answer").mkdir()
    (tmp_path / "a_answer" / "verdict.json").write_text(json.dumps(one))
    assert Desk(tmp_path, nothing).state("a") == "current"


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # the pipe is left to who holds it
def test_a_verb_that_crashes_is_told_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What it started may live on and hold its output open: the page does not wait for that."""
    python = tmp_path / "python"
    python.write_text("#!/bin/sh\necho 'tentacle: a defect' >&2\nsleep 20 &\nexit 70\n")
    python.chmod(0o755)
    monkeypatch.setattr("viz.app.job.sys.executable", str(python))
    job = Job(["diagnose"], tmp_path)
    begun = time.monotonic()
    with ThreadPoolExecutor(1) as alone:  # a browser's driver may have a loop running in this thread
        alone.submit(asyncio.run, job.run()).result()
    assert (job.state, job.words) == ("failed", "tentacle: a defect")
    assert time.monotonic() - begun < 15.0  # the child sleeps for 20 s
    del job
    gc.collect()

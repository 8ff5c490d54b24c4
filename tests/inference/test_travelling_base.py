"""Recordings of an arm whose base travels: the arm is identified, in whichever frame it was measured."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from inference.identify import identify
from mujoco_ref.undeclared import Noise, Scenario, make_recording
from tentacle.errors import InputError
from tentacle.io.import_folder import read_folder
from tentacle.io.recording_rrd import read_rrd, write_rrd
from tentacle.io.sound_recording import check_recording
from tentacle.io.write_folder import write_folder
from tentacle.model import Estimate, Model
from tentacle.recording import Camera, Recording
from tentacle.signals import Markers, Video
from tentacle.slips import find_slips, refuse_slips
from tentacle.specimen import AIR
from tentacle.waveform import Sine
from tests.made_recordings import SPECIMEN

E, ETA = 2e5, 1.5e3
STILL = Sine(0.0, 1.0)


def shaken(t):
    """Across by 8 mm at 1.5 Hz and 5 mm at 4 Hz; 60 mm out of the way, so that the frame matters."""
    t = np.asarray(t, dtype=float)
    ways = [(0.008, 2.0 * np.pi * 1.5), (0.005, 2.0 * np.pi * 4.0)]
    x = [0.06 + sum(a * np.sin(w * t) for a, w in ways), sum(a * w * np.cos(w * t) for a, w in ways)]
    none = np.zeros_like(t)
    return np.stack([x[0], none, x[1], none, -sum(a * w**2 * np.sin(w * t) for a, w in ways), none])


@pytest.fixture(scope="module")
def recording() -> Recording:
    """The chain's arm in air, clamped on a shaker."""
    table = {"elasticity": {"E": E}, "damping": {"eta": ETA}}
    exact = {name: {key: Estimate.exact(v) for key, v in values.items()} for name, values in table.items()}
    scene = Scenario(Model(SPECIMEN, AIR, parameters=exact), STILL, 4.0, 100.0, travel=shaken)
    made, _ = make_recording({}, scene, 1, Noise(1e-4, 0.0, 0.0))
    return replace(made, motor=None, load_cell=None)


def test_the_arm_is_identified_from_the_ground_and_from_the_base(recording):
    midline, travel = recording.midline, recording.travel
    assert midline is not None
    assert travel is not None
    riding = replace(
        recording,
        declaration=replace(recording.declaration, seen_from="base"),
        midline=replace(midline, xy=midline.xy - travel.xy[:, None]),
    )
    for one in (recording, riding):
        assert find_slips(one) == []
        found = identify([one], order=4)  # at 4 Hz two curvatures are 2 % off
        assert found.model.parameters["elasticity"]["E"].value == pytest.approx(E, rel=0.003)
        assert found.errors.midline_mm < 0.16  # noise of .1 mm in x and y


def with_path_within(recording, first, last):
    """The recording with its base's path between two times alone."""
    travel = recording.travel
    kept = (travel.t >= first) & (travel.t <= last)
    return replace(recording, travel=replace(travel, t=travel.t[kept], xy=travel.xy[kept]))


@pytest.mark.parametrize(
    ("first", "last", "said"), [(0.0, 2.5, "ends at 2.5 s, and the arm is seen from 0 to 4"), (0.9, 9.0, "begins at")]
)
def test_a_path_that_ends_while_the_base_moves_is_refused(recording, first, last, said):
    with pytest.raises(InputError, match=said) as refused:
        refuse_slips(with_path_within(recording, first, last))
    assert refused.value.line().count("base.csv: t_s") == 1
    assert "mm in 0.1 s" in refused.value.line()


def test_a_base_may_stand_beyond_its_path(recording):
    travel = recording.travel
    at_rest = travel.xy * np.clip((2.0 - travel.t) / 0.5, 0.0, 1.0)[:, None] ** 3  # it stops at 2 s, smoothly
    stops = replace(recording, travel=replace(travel, xy=at_rest), midline=None, markers=_tip_on(recording, at_rest))
    (long,) = find_slips(with_path_within(stops, 0.0, 2.3))
    assert not long.certain
    assert "taken to stand" in long.remedy
    assert find_slips(with_path_within(stops, 0.0, 3.8)) == []


def _tip_on(recording, path):
    """The tip as a marker, where the base moves on another path."""
    xy = recording.midline.xy[:, -1:] - (recording.travel.xy - path)[:, None]
    return Markers(recording.midline.t, ("tip",), np.ones(1), np.zeros(1), xy)


def test_it_is_written_and_read_whole(recording, tmp_path):
    folder, file = write_folder(recording, tmp_path / "shaken"), tmp_path / "shaken.rrd"
    write_rrd(recording, file)
    for read in (read_folder(folder), read_rrd(file)):
        assert read.travel is not None
        np.testing.assert_array_equal(read.travel.xy, recording.travel.xy)
        assert read.declaration.seen_from == "ground"


def test_a_film_from_the_ground_and_a_path_in_millimetres_are_refused(recording, tmp_path):
    folder = write_folder(recording, tmp_path / "shaken")
    path = folder / "base.csv"
    good = path.read_text()
    rows = [line.split(",") for line in good.splitlines()]
    path.write_text("\n".join([",".join(rows[0]), *(f"{t},{1e4 * float(x)},{y}" for t, x, y in rows[1:])]) + "\n")
    with pytest.raises(InputError, match="x_m"):
        read_folder(folder)
    camera = Camera(100.0, 5e-4, (100.0, 20.0), (0.0, 1.0))
    filmed = replace(
        recording, midline=None, video=Video(folder), declaration=replace(recording.declaration, camera=camera)
    )
    with pytest.raises(InputError, match="seen_from"):
        check_recording(filmed, folder)

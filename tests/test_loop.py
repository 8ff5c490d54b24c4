"""The loop end to end: a real beam with an undeclared weight, a MuJoCo tank with and without an undeclared current."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from discovery.diagnose import diagnose
from mujoco_ref.undeclared import Scenario, make_recording
from tentacle.cli import main
from tentacle.io.external_data import data_folder
from tentacle.io.reading import read_recording
from tentacle.io.recording_rrd import write_rrd
from tentacle.io.silicone_beam import read_beam
from tentacle.io.write_folder import write_folder
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Chirp

BEAM = data_folder() / "silicone_beam"
needs_beam = pytest.mark.skipif(not BEAM.exists(), reason="data/silicone_beam is absent (set TENTACLE_DATA)")


@pytest.fixture(scope="module")
def bare_beam():
    return read_beam(BEAM / "beam_gravity_V2_a.csv")


@pytest.mark.long
@needs_beam
def test_the_weight_on_the_real_beam_is_found(bare_beam):
    answer = diagnose([read_beam(BEAM / "beam_load52_V2_b.csv")], [bare_beam])
    mass = answer.parameters["tip_mass"]["mass"]
    assert answer.verdict == "effect"
    assert answer.effects[0] == "tip_mass"
    assert "tip_mass" in answer.certain
    # The truth is 52 g. Where the weight's centre lies beyond the tip is not known, so the interval is wide.
    assert mass.value == pytest.approx(0.052, rel=0.1)
    assert mass.low < 0.052 < mass.high < 0.09
    assert answer.explained is not None
    assert answer.explained.low > 0.9
    assert answer.held_out
    assert answer.after.midline_mm < 0.25 * answer.before.midline_mm


@pytest.mark.long
@needs_beam
def test_nothing_is_found_in_a_repeat_of_the_bare_beam(bare_beam):
    answer = diagnose([read_beam(BEAM / "beam_gravity_V2_b.csv")], [bare_beam])
    assert answer.verdict == "nothing_missing"
    assert "tip_mass" not in answer.augmented_model.parameters


def tank(hidden, seed, fps=30.0):
    parameters = {
        "elasticity": {"E": Estimate.exact(1.6e5, "Pa")},
        "damping": {"eta": Estimate.exact(1.5e3, "Pa s")},
        "drag": {"C_perp": Estimate.exact(1.1)},
    }
    model = Model(Specimen(Cone(0.0125, 0.004), 0.14, 1070.0), WATER, Gravity(), 2, parameters)
    return make_recording(hidden, Scenario(model, Chirp(0.5, 0.3, 2.0, 12.0), 12.0, fps), seed, name="tank")[0]


@pytest.fixture(scope="module")
def current_recording():
    return tank({"current": {"U_x": 0.03, "U_y": 0.02}}, 3)


@pytest.mark.long
@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="cores cannot be chosen here")
def test_one_core_gives_the_same_answer_as_all(current_recording):
    cores = os.sched_getaffinity(0)
    everywhere = diagnose([current_recording])
    os.sched_setaffinity(0, {min(cores)})
    try:
        alone = diagnose([current_recording])
    finally:
        os.sched_setaffinity(0, cores)
    # Every sum is made in the same order, so that not one digit may differ.
    assert (alone.verdict, alone.confidence, alone.parameters) == (
        everywhere.verdict, everywhere.confidence, everywhere.parameters,
    )  # fmt: skip
    assert alone.after == everywhere.after


def test_a_current_is_found_and_the_rrd_tells_the_same(current_recording, tmp_path):
    folder, file = tmp_path / "tank", tmp_path / "tank.rrd"
    write_folder(current_recording, folder)
    write_rrd(read_recording(folder), file)
    assert main(["diagnose", str(folder), "--out", str(tmp_path / "a")]) == 0
    assert main(["diagnose", str(file), "--out", str(tmp_path / "b")]) == 0
    first, second = ((tmp_path / name / "verdict.json").read_text() for name in "ab")
    assert first == second  # complete: the .rrd alone gives the same answer, digit for digit
    answer = json.loads(first)
    assert answer["verdict"] == "effect"
    assert answer["effects"][0] == "current"
    for name, truth in (("U_x", 0.03), ("U_y", 0.02)):
        # Twelve seconds tell U to 4 % (one sigma): twice the 95 % interval holds it but in one of ten thousand.
        found = answer["parameters"]["current"][name]
        assert abs(found["value"] - truth) < found["high"] - found["low"] < 0.2 * abs(truth) + 0.004
    assert answer["error"]["after"]["midline_mm"] < 1.2 * answer["error"]["floor"]["midline_mm"]
    for name in ("report.html", "session.rrd", "model.toml"):
        assert (tmp_path / "a" / name).stat().st_size > 0


def test_nothing_is_found_where_nothing_is_hidden():
    answer = diagnose([tank({}, 5)])
    # A cone bends in more ways than two coordinates follow; that alone may be named.
    assert set(answer.effects) <= {"third_curvature"}
    assert answer.verdict in ("nothing_missing", "effect")


def test_an_unseen_arm_is_said_to_be_unseen(current_recording):
    from dataclasses import replace

    midline = current_recording.midline
    blind = replace(current_recording, midline=replace(midline, xy=np.full_like(midline.xy, np.nan)))
    answer = diagnose([blind])
    assert answer.verdict == "unknown"
    assert "cannot tell" in answer.headline


def test_bad_input_ends_with_one_line_and_nothing_written(tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["diagnose", str(tmp_path / "nowhere"), "--out", str(out)]) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert not Path(out).exists()


def test_the_floor_is_the_noise_that_the_answer_leaves():
    """10 frames/s and an undeclared current: the declared model's residual swings so fast that its fourth differences
    look like noise. The floor is what the answer leaves, within the 10 % by which a noise may be found larger.
    """
    answer = diagnose([tank({"current": {"U_x": 0.03}}, 3, fps=10.0)])
    assert answer.floor.midline_mm is not None
    assert answer.before.midline_mm > 2.0 * answer.after.midline_mm
    assert answer.floor.midline_mm < 1.3 * answer.after.midline_mm

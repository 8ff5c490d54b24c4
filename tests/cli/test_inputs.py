"""What a command is given is checked before it computes: a recording twice, a hidden effect that cannot be, an unknown
law.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tentacle.cli import main
from tests.tentacle.io.lab_folder import lab_folder
from tests.tentacle.io.test_bad_import_folder import CONE, MARKERS, MIDLINE

MODEL = """\
order = 2
[specimen]
section = "cone"
length_m = 0.14
base_radius_m = 0.0125
tip_radius_m = 0.004
density_kg_m3 = 1070
[effects]
elasticity.E = { value = 2e5, unit = "Pa" }
"""
MARKED = "[markers]\ntip = { s = 1, d = 0 }\n"


def refused(capsys: pytest.CaptureFixture[str], *words: str | Path) -> str:
    """The one line with which a command ends that is given something wrong."""
    assert main([str(word) for word in words]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    return line


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("diagnose", "lab", "./lab"), "RECORDING: is given twice"),
        (("diagnose", "lab", "--baseline", "lab"), "--baseline: is given as RECORDING too"),
        (("diagnose", "lab", "--held-out", "lab"), "--held-out: is given as RECORDING too"),
        (("identify", "lab", "--check", "lab"), "--check: is given as RECORDING too"),
    ],
)
def test_a_recording_does_not_answer_for_itself(words, said, tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    lab_folder(tmp_path / "lab", recording__toml=CONE, midline__csv=MIDLINE)
    assert said in refused(capsys, *words, "--out", "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("hidden", "said"),
    [
        (("tip_mass=-0.01",), "--hide tip_mass.mass: -0.01 is out of range; expected 0 to"),
        (("current=U_x:1e6,U_y:0",), "--hide current.U_x: 1e+06 is out of range; expected -"),
        (("current", "current=faint"), "--hide current: is given twice"),
    ],
)
def test_what_cannot_be_hidden_is_said(hidden, said, tmp_path, capsys) -> None:
    (tmp_path / "arm.toml").write_text(MODEL)
    flags = [word for one in hidden for word in ("--hide", one)]
    assert said in refused(capsys, "simulate", tmp_path / "arm.toml", "--out", tmp_path / "out", *flags)
    assert not (tmp_path / "out").exists()


def test_a_law_that_no_arm_has_is_refused_where_the_folder_is_checked(tmp_path, capsys) -> None:
    cone = CONE.replace("[specimen]\n", '[specimen]\nlaws = ["dry_frction"]\n')
    folder = lab_folder(tmp_path / "lab", recording__toml=cone, midline__csv=MIDLINE)
    said = refused(capsys, "import", folder, "--out", tmp_path / "out.rrd")
    assert "specimen.laws: 'dry_frction' is not known (did you mean dry_friction?)" in said
    assert not (tmp_path / "out.rrd").exists()


def test_a_base_s_short_log_is_named_as_the_base_s(tmp_path, capsys) -> None:
    folder = lab_folder(
        tmp_path / "lab", recording__toml=CONE + MARKED, markers__csv=MARKERS, base__csv="t_s,x_m,y_m\n0,0,0\n1,0,0\n"
    )
    assert "base.csv: t_s: 2 samples; expected at least 6" in refused(
        capsys, "import", folder, "--out", tmp_path / "out.rrd"
    )

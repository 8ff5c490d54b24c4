"""What a command is given is checked before it computes: a recording twice, a hidden effect that cannot be, an unknown
law.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tentacle.cli import main
from tentacle.io.write_folder import write_folder
from tentacle.recording import Declaration, Recording
from tentacle.signals import AccelerationSignal, Accelerometer, Midline, MotorSignal
from tentacle.specimen import Cone, Specimen
from tests.made_recordings import record
from tests.tentacle.io.lab_folder import lab_folder
from tests.tentacle.io.test_bad_import_folder import CONE, MARKERS, MIDLINE
from tests.tentacle.io.test_recording_rrd import small_video

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
AXES = (Accelerometer(1.0, 0.0, "normal"), Accelerometer(1.0, 0.0, "tangent"))
MARKED = "[markers]\ntip = { s = 1, d = 0 }\n"


def refused(capsys: pytest.CaptureFixture[str], *words: str | Path) -> str:
    """The one line with which a command ends that is given something wrong."""
    assert main([str(word) for word in words]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    return line


@pytest.mark.parametrize("words", [("diagnose", "lab"), ("identify", "lab"), ("blind-trial", "1")])
@pytest.mark.parametrize(("device", "said"), [("tpu", "'tpu' is not known"), ("cuda:99", "cuda:99")])
def test_a_device_is_refused_before_anything_is_read(words, device, said, tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    assert said in refused(capsys, *words, "--out", "out", "--device", device)
    assert not (tmp_path / "out").exists()


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


@pytest.mark.parametrize("verb", ["import", "diagnose", "identify"])
def test_a_servo_s_log_of_one_row_is_refused_where_the_folder_is_read(verb, tmp_path, capsys) -> None:
    log = "t_s,command_rad,angle_rad\n0,0,0\n"
    folder = lab_folder(tmp_path / "lab", recording__toml=CONE, midline__csv=MIDLINE, motor__csv=log)
    said = refused(capsys, verb, folder, "--out", tmp_path / "out.rrd")
    assert "motor.csv: t_s: 1 sample; expected at least 6" in said


def test_readings_in_g_are_refused_by_import_before_anything_is_written(tmp_path, capsys) -> None:
    """An arm that hangs swings as a stiff rod, with both axes at its tip."""
    t, s, length, omega = np.arange(0.0, 4.0, 0.01), np.linspace(0.0, 1.0, 9), 0.14, 2.0 * np.pi
    phi, rate = 0.4 * np.sin(omega * t), 0.4 * omega * np.cos(omega * t)
    xy = length * s[:, None] * np.stack([-np.sin(phi), np.cos(phi)], axis=-1)[:, None]
    # The tip's acceleration is L (-n phi'' - t phi'^2), and gravity is g (n sin phi + t cos phi).
    across = length * omega**2 * phi - 9.80665 * np.sin(phi)
    along = -length * rate**2 - 9.80665 * np.cos(phi)
    swung = Recording(
        "swung",
        Declaration(Specimen(Cone(0.0125, 0.005), length, 1070.0)),
        MotorSignal(t, phi, phi),
        midline=Midline(t, s, xy, np.full(xy.shape[:2], 1e-4)),
        acceleration=AccelerationSignal(t, ("a", "b"), AXES, np.stack([across, along], axis=1)),
    )
    sound = write_folder(swung, tmp_path / "sound")
    assert main(["import", str(sound), "--out", str(tmp_path / "sound.rrd")]) == 0
    assert "check:" not in capsys.readouterr().out
    read = swung.acceleration
    assert read is not None
    in_g = write_folder(replace(swung, acceleration=replace(read, values=read.values / 9.80665)), tmp_path / "g")
    said = refused(capsys, "import", in_g, "--out", tmp_path / "out.rrd")
    assert "acceleration.csv: b_m_s2: reads -1" in said
    assert "are these g? then multiply by 9.80665" in said
    assert not (tmp_path / "out.rrd").exists()
    assert "are these g?" in refused(capsys, "identify", in_g, "--out", tmp_path / "out")


def test_a_frame_is_accepted_or_rejected(tmp_path, capsys) -> None:
    small_video(tmp_path / "film.mp4")
    numbers = ("--length", "0.14", "--base-radius", "0.01", "--tip-radius", "0.005", "--out", tmp_path / "out.csv")
    place = ("--base-px", "80", "20", "--m-per-px", "0.001")
    said = refused(capsys, "track", tmp_path / "film.mp4", *numbers, *place, "--reject", "2-5", "--accept", "4,5")
    assert "--reject and --accept: frame 4 is accepted and rejected, and 1 more" in said
    assert not (tmp_path / "film.mp4.proofread.toml").exists()


def test_an_effect_file_takes_no_name_of_the_catalogue(tmp_path, capsys) -> None:
    (tmp_path / "arm.toml").write_text(MODEL)
    magnet = (Path(__file__).parents[2] / "examples" / "effects" / "magnet.toml").read_text()
    (tmp_path / "wall.toml").write_text(magnet.replace('name = "magnet"', 'name = "wall"'))
    words = ("simulate", tmp_path / "arm.toml", "--out", tmp_path / "out", "--effects", tmp_path / "wall.toml")
    said = refused(capsys, *words)
    assert "wall.toml:" in said
    assert "name: the catalogue has an effect 'wall'; expected another name" in said
    assert not (tmp_path / "out").exists()


def test_identify_gives_the_advice_that_import_gives(tmp_path, capsys) -> None:
    """A servo's log whose sign is reversed: the recording is fitted, and the line says what is odd."""
    recording = record(seconds=4.0, order=2)
    motor = recording.motor
    assert motor is not None
    reversed_log = MotorSignal(motor.t, -motor.command, -motor.angle)
    lab = write_folder(replace(recording, name="lab", motor=reversed_log), tmp_path / "lab")
    assert main(["identify", str(lab), "--out", str(tmp_path / "out")]) == 0
    assert "check: lab/motor.csv: angle_rad: the root turns -" in capsys.readouterr().err

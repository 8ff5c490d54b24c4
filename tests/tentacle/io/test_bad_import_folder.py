"""What is wrong in an import folder is named by file, row and field."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from tentacle.errors import InputError
from tentacle.io.import_folder import read_folder
from tests.tentacle.io.lab_folder import CAMERA, CONE, LOAD_CELL, MARKERS, MIDLINE, MOTOR, lab_folder

GAUGE = "[strain]\nroot = {s = 0.1, d = 0.01}"
AXIS = "[acceleration]\ntip = {s = 1, d = 0, axis = 'normal'}"
ACCELERATION = "t_s,tip_m_s2\n0,-9.8\n0.1,2\n"
STRAIN = "t_s,root_strain\n0,0.001\n0.1,0.002\n"


def good(**changes: str) -> dict[str, str]:
    return {"recording__toml": CONE, "midline__csv": MIDLINE, **changes}


BAD = {
    # name: (files, what the one line must contain)
    "no declaration": ({"midline__csv": MIDLINE}, "recording.toml: no such file"),
    "not toml": (good(recording__toml=CONE + "oops\n"), "recording.toml:7: not valid TOML"),
    "no specimen": (good(recording__toml=CAMERA), "recording.toml: specimen: missing"),
    "specimen no table": (good(recording__toml="specimen = 3"), "recording.toml: specimen: 3 is not a table"),
    "no length": (
        good(recording__toml=CONE.replace("length_m", "lenght_m")),
        "recording.toml:1: specimen.length_m: missing (there is lenght_m",
    ),
    "text": (
        good(recording__toml=CONE.replace("0.14", '"14 cm"')),
        "recording.toml:3: specimen.length_m: '14 cm' is no",
    ),
    "bool": (good(recording__toml=CONE.replace("0.14", "true")), "specimen.length_m: True is no number"),
    "nan": (
        good(recording__toml=CONE.replace("0.14", "nan")),
        "recording.toml:3: specimen.length_m: nan is out of range",
    ),
    "negative": (
        good(recording__toml=CONE.replace("0.14", "-0.14")),
        "length_m: -0.14 is out of range; expected a number",
    ),
    "millimetres": (good(recording__toml=CONE.replace("0.14", "140")), "length_m: 140 is out of range"),
    "g/cm3": (good(recording__toml=CONE.replace("1070", "1.07")), "recording.toml:6: specimen.density_kg_m3: 1.07"),
    "section": (good(recording__toml=CONE.replace('"cone"', '"con"')), "'con' is not known (did you mean cone?)"),
    "stiffness": (good(recording__toml=CONE + 'stiffness = "afine"'), "recording.toml:7: specimen.stiffness"),
    "key": (good(recording__toml=CONE + "tip_mas_kg = 1"), "tip_mas_kg: unknown key (did you mean tip_mass_kg?)"),
    "width of a cone": (
        good(recording__toml=CONE + "width_m = 1"),
        "recording.toml:7: specimen.width_m: does not belong",
    ),
    "payload": (good(recording__toml=CONE + "tip_mass_kg = -1"), "specimen.tip_mass_kg: -1 is out of range"),
    "clamp that pushes": (
        good(recording__toml=CONE + "clamp_length_m = -0.01"),
        "recording.toml:7: specimen.clamp_length_m: -0.01 is out of range; expected a number >= 0 and <= 0.14",
    ),
    "clamp longer than the arm": (
        good(recording__toml=CONE + "clamp_length_m = 0.2"),
        "recording.toml:7: specimen.clamp_length_m: 0.2 is out of range",
    ),
    "clamp of nan": (
        good(recording__toml=CONE + "clamp_length_m = { value = nan, sd = 0.01 }"),
        "recording.toml:7: specimen.clamp_length_m.value: nan is out of range",
    ),
    "shear against the load": (
        good(recording__toml=CONE + "shear_compliance = -1"),
        "recording.toml:7: specimen.shear_compliance: -1 is out of range; expected a number >= 0 and <= 10",
    ),
    "unknown table": (good(recording__toml=CONE + "[fluids]\nx=1"), "fluids: unknown key (did you mean fluid?)"),
    "fluid": (good(recording__toml=CONE + "[fluid]\ndensity_kg_m3 = -1"), "recording.toml:8: fluid.density_kg_m3: -1"),
    "degrees": (
        good(recording__toml=CONE + "[gravity]\nangle_rad = 90"),
        "gravity.angle_rad: 90 is out of range; expected a number >= -6.28319 and <= 6.28319; degrees?",
    ),
    "fps": (good(recording__toml=CONE + CAMERA.replace("60", "0")), "recording.toml:8: camera.fps: 0 is out of range"),
    "arm_px": (
        good(recording__toml=CONE + CAMERA.replace("[0, 1]", "[0, 2]")),
        "camera.arm_px: [0.0, 2.0] has length 2",
    ),
    "base_px": (
        good(recording__toml=CONE + CAMERA.replace("[320, 80]", "[320]")),
        "camera.base_px: [320] is not usable",
    ),
    "exposure": (good(recording__toml=CONE + CAMERA + "exposure_s = 1"), "camera.exposure_s: 1.0 is longer than"),
    "mirrored": (
        good(recording__toml=CONE + CAMERA + "mirrored = 1"),
        "camera.mirrored: 1 is not usable; expected true",
    ),
    "mode": (good(recording__toml=CONE + '[motor]\nmode = "torque"'), "motor.mode: 'torque' is not known"),
    "release": (good(recording__toml=CONE + "[release]\nt = 1"), "release.t_s: missing"),
    "marker s": (
        good(recording__toml=CONE + "[markers]\ntip = {s = 1.5, d = 0}", markers__csv=MARKERS),
        "markers.tip.s: 1.5 is out of range",
    ),
    "marker d": (
        good(recording__toml=CONE + "[markers]\ntip = {s = 1}", markers__csv=MARKERS),
        "markers.tip.d: missing",
    ),
    "marker undeclared": (good(markers__csv=MARKERS), "recording.toml: markers: missing, and there is markers.csv"),
    "marker without columns": (
        good(recording__toml=CONE + "[markers]\nend = {s = 1, d = 0}", markers__csv=MARKERS),
        "markers.csv:1: end, tip: markers.csv has tip, and [markers] of recording.toml has end; expected columns "
        "end_x_m and end_y_m, or no end in [markers]; tip = { s = ..., d = ... } in [markers], or no columns of tip",
    ),
    "marker with a column, undeclared": (
        good(
            recording__toml=CONE + "[markers]\ntip = {s = 1, d = 0}",
            markers__csv=MARKERS.replace("t_s,", "t_s,end_x_m,end_y_m,").replace("\n0", "\n0,0,0"),
        ),
        "markers.csv:1: end: markers.csv has end, tip, and [markers] of recording.toml has tip; expected end = {",
    ),
    "marker nan": (
        good(recording__toml=CONE + "[markers]\ntip = {s = 1, d = 0}", markers__csv=MARKERS.replace("0.02", "NaN")),
        "markers.csv:3: tip_x_m: 'NaN' is no finite number; expected a number, or an empty cell for what was not seen",
    ),
    "marker at a time that is none": (
        good(recording__toml=CONE + "[markers]\ntip = {s = 1, d = 0}", markers__csv=MARKERS.replace("0.1,", "NaN,")),
        "markers.csv:3: t_s: 'NaN' is no finite number; expected a number",
    ),
    "marker not declared": (
        good(
            recording__toml=CONE + "[markers]\ntip = {s = 1, d = 0}",
            markers__csv="t_s,tip_x_m,tip_y_m,q_x_m\n0,0,0,0\n",
        ),
        "markers.csv:1: q_x_m: unknown column",
    ),
    "markers without file": (
        good(recording__toml=CONE + "[markers]\ntip = {s = 1, d = 0}"),
        "markers.csv: no such file",
    ),
    "half a marker": (
        good(recording__toml=CONE + "[markers]\ntip = {s = 1, d = 0}", markers__csv=MARKERS.replace("0.02", "")),
        "markers.csv:3: tip_x_m: blank cell",
    ),
    "gauge beyond the arm": (
        good(recording__toml=CONE + "[strain]\nroot = {s = 0.01, d = 0.01, length_m = 0.02}", strain__csv=STRAIN),
        "strain.root.s: the gauge reaches from",
    ),
    "gauge on the midline": (
        good(recording__toml=CONE + "[strain]\nroot = {s = 0.1, d = 0}", strain__csv=STRAIN),
        "strain.root.d: a gauge on the midline is not stretched",
    ),
    "gauge undeclared": (good(strain__csv=STRAIN), "recording.toml: strain: missing, and there is strain.csv"),
    "gauge without file": (good(recording__toml=CONE + GAUGE), "strain.csv: no such file"),
    "gauge without column": (
        good(recording__toml=CONE + GAUGE, strain__csv=STRAIN.replace("root", "top")),
        "strain.csv:1: root_strain: column missing",
    ),
    "microstrain": (
        good(recording__toml=CONE + GAUGE, strain__csv=STRAIN.replace("0.002", "2000")),
        "strain.csv:3: root_strain: 2000 cannot be; expected a strain",
    ),
    "unknown axis": (
        good(recording__toml=CONE + AXIS.replace("normal", "x"), acceleration__csv=ACCELERATION),
        "acceleration.tip.axis: 'x'",
    ),
    "no axis": (
        good(recording__toml=CONE + "[acceleration]\ntip = {s = 1, d = 0}", acceleration__csv=ACCELERATION),
        "acceleration.tip.axis: missing",
    ),
    "accelerometer beyond the arm": (
        good(recording__toml=CONE + AXIS.replace("s = 1", "s = 1.2"), acceleration__csv=ACCELERATION),
        "acceleration.tip.s: 1.2",
    ),
    "accelerometer undeclared": (
        good(acceleration__csv=ACCELERATION),
        "recording.toml: acceleration: missing, and there is acceleration.csv; expected name = {s, d, axis}",
    ),
    "accelerometer without file": (good(recording__toml=CONE + AXIS), "acceleration.csv: no such file"),
    "accelerometer without column": (
        good(recording__toml=CONE + AXIS, acceleration__csv=ACCELERATION.replace("tip", "top")),
        "acceleration.csv:1: tip_m_s2: column missing",
    ),
    "counts of a converter": (
        good(recording__toml=CONE + AXIS, acceleration__csv=ACCELERATION.replace(",2", ",16384")),
        "acceleration.csv:3: tip_m_s2: 16384 cannot be; expected an acceleration in m/s^2",
    ),
    "acceleration of another clock": (
        good(recording__toml=CONE + AXIS, acceleration__csv="t_s,tip_m_s2\n1000,-9.8\n1000.1,2\n"),
        "from 1000 to 1000.1 s, and the arm is seen from",
    ),
    "no picture": ({"recording__toml": CONE}, "nothing shows the arm"),
    "empty csv": (good(motor__csv=""), "motor.csv: empty file"),
    "header only": (good(motor__csv="t_s,command_rad,angle_rad\n"), "motor.csv:1: no rows"),
    "comments only": (good(motor__csv="t_s,command_rad,angle_rad\n# nothing\n"), "motor.csv:1: no rows"),
    "wrong header": (
        good(motor__csv=MOTOR.replace("angle_rad", "angle_deg")),
        "angle_rad: column missing (there is angle_deg)",
    ),
    "twice": (good(motor__csv="t_s,t_s,command_rad,angle_rad\n1,1,1,1"), "motor.csv:1: t_s: column occurs twice"),
    "semicolons": (
        good(motor__csv=MOTOR.replace(",", ";")),
        "motor.csv:1: columns are separated by semicolons; expected commas",
    ),
    "nan cell": (good(motor__csv=MOTOR.replace("0.15", "nan")), "motor.csv:3: angle_rad: 'nan' is no finite number"),
    "inf cell": (good(load_cell__csv=LOAD_CELL.replace("0.02", "-inf")), "load_cell.csv:3: thrust_n: '-inf' is no"),
    "too large": (good(motor__csv=MOTOR.replace("0.02,", "1e999,")), "motor.csv:4: t_s: '1e999' is no finite number"),
    "two clocks": (
        good(motor__csv="t_s,command_rad,angle_rad\n1.7e9,0,0\n1.7000001e9,0,0\n"),
        "motor.csv: t_s: from 1.7e+09 to 1.7000001e+09 s, and the arm is seen from 0 to 0.1 s; expected times of one",
    ),
    "late release": (good(recording__toml=CONE + "[release]\nt_s = 5"), "release.t_s: 5 s is after the last frame"),
    "underscore": (good(motor__csv=MOTOR.replace("0.15", "1_5")), "motor.csv:3: angle_rad: '1_5' is no finite number"),
    "text cell": (good(motor__csv=MOTOR.replace("0.15", "off")), "motor.csv:3: angle_rad: 'off' is no finite number"),
    "blank cell": (good(motor__csv=MOTOR.replace("0.15", "")), "motor.csv:3: angle_rad: blank cell"),
    "short row": (good(motor__csv=MOTOR.replace(",0.15", "")), "motor.csv:3: 2 cells in this row; expected 3"),
    "long row": (good(motor__csv=MOTOR.replace("0.15", "0.15,7")), "motor.csv:3: 4 cells in this row; expected 3"),
    "cut off": (good(motor__csv=MOTOR[:-6]), "motor.csv:4: 2 cells in this row"),
    "back": (good(motor__csv=MOTOR.replace("0.02,", "0.005,")), "motor.csv:4: t_s: time goes back from 0.01 to 0.005"),
    "repeat": (good(motor__csv=MOTOR.replace("0.02,", "0.01,")), "motor.csv:4: t_s: time 0.01 repeats"),
    "back after a comment": (
        good(motor__csv="# log\n\n" + MOTOR.replace("0.02,", "# note\n0.005,")),
        "motor.csv:7: t_s: time goes back",
    ),
    "degrees in the log": (good(motor__csv=MOTOR.replace("0.15", "90")), "motor.csv:3: angle_rad: 90 cannot be"),
    "midline in mm": (
        good(midline__csv=MIDLINE.replace("0.13", "130")),
        "midline.csv:3: y_m: 130 cannot be; expected metres",
    ),
    "midline nan": (good(midline__csv=MIDLINE.replace("0.13", "NaN")), "midline.csv:3: y_m: 'NaN' is no finite number"),
    "midline column": (
        good(midline__csv=MIDLINE.replace("sigma_m", "sigma_mm")),
        "sigma_mm: unknown column (did you mean",
    ),
    "midline s": (good(midline__csv=MIDLINE.replace("0.1,1,", "0.1,1.2,")), "midline.csv:5: s: 1.2 is out of range"),
    "midline s falls": (
        good(midline__csv=MIDLINE.replace("0.1,1,", "0.1,0,")),
        "midline.csv:5: s: 0 after 0 in one frame",
    ),
    "midline s strays": (good(midline__csv=MIDLINE.replace("0.1,1,", "0.1,0.9,")), "midline.csv:5: s: 0.9 is none of"),
    "midline back": (good(midline__csv=MIDLINE.replace("0.1,0,", "-1,0,")), "midline.csv:4: t_s: time goes back"),
    "midline sigma": (good(midline__csv=MIDLINE.replace("0.13,1e-4", "0.13,0")), "midline.csv:3: sigma_m: 0 is out of"),
    "video no video": (good(recording__toml=CONE + CAMERA, video__mp4="no video"), "video.mp4: unreadable video"),
    "video undeclared": (good(video__mp4="x"), "video.mp4: unreadable video"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_line_that_names_file_row_and_field(name: str, tmp_path: Path) -> None:
    files, said = BAD[name]
    folder = lab_folder(tmp_path / "lab", **files)
    with pytest.raises(InputError) as caught:
        read_folder(folder)
    assert said in str(caught.value)
    assert str(folder) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_whatever_is_in_the_files_is_read_or_refused_in_one_line(tmp_path: Path) -> None:
    """Files with bytes deleted, changed and put in, at random but the same every time."""
    declared = CONE + CAMERA + "[release]\nt_s = 0.05\n[markers]\ntip = {s = 1, d = 0}\n"
    files = {"recording.toml": declared, "motor.csv": MOTOR, "midline.csv": MIDLINE, "markers.csv": MARKERS}
    folder = tmp_path / "lab"
    folder.mkdir()
    for name, text in files.items():
        (folder / name).write_text(text)
    rng = random.Random(11)
    pieces = [b"nan", b",", b"\n", b"\x00", b"\xff", b"1e999", b"[", b"=", b"{", b'"', b"-1", b"#", b"\r", b"_", b"0x1"]
    refused = []
    for _ in range(300):
        name = rng.choice(list(files))
        content = bytearray(files[name].encode())
        for _ in range(rng.randint(1, 3)):
            place = rng.randrange(len(content))
            content[place : place + rng.randint(0, 5)] = rng.choice(pieces)
        (folder / name).write_bytes(content)
        try:
            read_folder(folder)
        except InputError as error:
            refused.append(str(error))
        (folder / name).write_text(files[name])
    assert not any("\n" in line for line in refused)
    assert 200 < len(refused) < 300  # most changes are faults, and a few (in a comment's place, a digit) are none


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    folder = lab_folder(tmp_path / "lab", **good(motor__csv=MOTOR))
    (folder / "motor.csv").write_bytes(MOTOR.encode().replace(b"0.15", b"\xff\xfe"))
    with pytest.raises(InputError, match=r"motor\.csv:3: angle_rad"):
        read_folder(folder)
    (folder / "recording.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not UTF-8"):
        read_folder(folder)


@pytest.mark.parametrize(
    ("written", "complaint"),
    [
        ("{ value = 1070 }", "specimen.density_kg_m3.sd: missing"),
        ("{ value = 1070, sd = -1 }", "specimen.density_kg_m3.sd: -1 is out of range"),
        ("{ low = 1100, high = 1000 }", "is not below high"),
        ("{ low = 1, high = 1000 }", "specimen.density_kg_m3.low: 1 is out of range"),
        ("{ low = 1000, high = 1100, sd = 3 }", "specimen.density_kg_m3.sd: unknown key"),
    ],
)
def test_a_spread_that_is_none_is_named(tmp_path: Path, written: str, complaint: str) -> None:
    folder = lab_folder(tmp_path / "lab", recording__toml=CONE.replace("1070", written), midline__csv=MIDLINE)
    with pytest.raises(InputError) as error:
        read_folder(folder)
    assert complaint in error.value.line()

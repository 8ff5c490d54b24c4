"""The import folder: what is written is read back bit for bit."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.io.csv_table import read_csv, write_csv
from tentacle.io.import_folder import read_folder
from tentacle.io.write_folder import write_folder
from tentacle.recording import Camera, Declaration, Recording
from tentacle.signals import (
    AccelerationSignal,
    Accelerometer,
    FrameShapes,
    LoadCellSignal,
    Markers,
    Midline,
    MotorSignal,
    ShapeTrack,
    StrainGauge,
    StrainSignal,
    Video,
)
from tentacle.specimen import WATER, Cone, Gravity, Rectangle, Specimen
from tests.tentacle.io.lab_folder import CAMERA, CONE, MARKERS, lab_folder

AXES = (Accelerometer(1.0, -1 / 300, "tangent"), Accelerometer(2 / 3, 0.0, "normal", 0.02))
GAUGES = (StrainGauge(1 / 3, 0.01, 0.007, 2e-5), StrainGauge(0.9, -1.0))


def random_recording(video: Path | None = None) -> Recording:
    """Every field used, numbers with all their digits, some points missing."""
    rng = np.random.default_rng(3)
    t = np.cumsum(rng.uniform(0.01, 0.02, 50))
    xy, sigma = rng.normal(0, 0.05, (50, 7, 2)), rng.uniform(1e-5, 1e-4, (50, 7))
    xy[4, 2] = np.nan
    sigma[4, 2] = np.nan
    marker_xy = rng.normal(0, 0.05, (50, 2, 2))
    marker_xy[9, 1] = np.nan
    strain = rng.normal(0, 0.01, (50, 2))
    strain[3, 0] = np.nan
    acceleration = rng.normal(0, 10.0, (50, 2))
    acceleration[7, 1] = np.nan
    return Recording(
        name="a random run",
        declaration=Declaration(
            specimen=Specimen(Cone(0.0125 * np.pi / 3, 1e-3), 0.14, 1070.1, 0.003, "affine"),
            fluid=WATER,
            gravity=Gravity(0.1 + 0.2, 9.81),
            camera=Camera(59.94, 1 / 3000, (320.1, 80.7), (np.sin(0.3), np.cos(0.3)), 1 / 500, True),
            motor_mode="servo",
            release_t=0.1 + 0.2,
        ),
        motor=MotorSignal(t, rng.normal(size=50), rng.normal(size=50)),
        load_cell=LoadCellSignal(t[::5].copy(), rng.normal(size=10)),
        midline=Midline(t, np.linspace(0, 1, 7), xy, sigma),
        markers=Markers(t, ("tip", "Tip-2"), np.array([1.0, 1 / 3]), np.array([0.0, -0.015]), marker_xy),
        strain=StrainSignal(t, ("root", "g-2"), GAUGES, strain),
        acceleration=AccelerationSignal(t, ("tip", "a-2"), AXES, acceleration),
        video=None if video is None else Video(video),
        notes={"by": "hand", "light": 'a "bad" one, 3/4'},
    )


def assert_equal_recordings(left: Recording, right: Recording) -> None:
    assert left.name == right.name
    assert left.declaration == right.declaration
    assert left.notes == right.notes
    for name in ("motor", "load_cell", "midline", "markers", "strain", "acceleration", "shape"):
        a, b = getattr(left, name), getattr(right, name)
        assert (a is None) == (b is None), name
        if a is None:
            continue
        assert_equal_fields(a, b, name)


def assert_equal_fields(a: object, b: object, name: str) -> None:
    for field, value in vars(a).items():
        if isinstance(value, np.ndarray):
            np.testing.assert_array_equal(value, getattr(b, field), err_msg=f"{name}.{field}", strict=True)
        elif isinstance(value, FrameShapes):
            assert_equal_fields(value, getattr(b, field), f"{name}.{field}")
        else:
            assert value == getattr(b, field), f"{name}.{field}"


def test_a_written_folder_is_read_back_bit_for_bit(tmp_path: Path) -> None:
    recording = random_recording()
    assert_equal_recordings(read_folder(write_folder(recording, tmp_path / "run")), recording)


def test_a_beam_held_horizontally_with_nothing_optional(tmp_path: Path) -> None:
    markers = Markers(np.array([0.0, 0.1]), ("tip",), np.ones(1), np.zeros(1), np.full((2, 1, 2), 0.05))
    beam = Specimen(Rectangle(0.03, 0.03), 0.1, 1070.0)
    recording = Recording("beam", Declaration(beam, gravity=Gravity(np.pi / 2)), markers=markers)
    assert_equal_recordings(read_folder(write_folder(recording, tmp_path / "beam")), recording)


def test_frames_travel_with_the_folder(tmp_path: Path, png_frames: Path) -> None:
    recording = random_recording(png_frames)
    again = read_folder(write_folder(recording, tmp_path / "run"))
    assert again.video is not None
    assert [f.read_bytes() for f in sorted(again.video.path.iterdir())] == [
        f.read_bytes() for f in sorted(png_frames.iterdir())
    ]


def test_nothing_is_left_behind_when_writing_fails(tmp_path: Path) -> None:
    recording = random_recording(tmp_path / "no_such_video.mp4")
    with pytest.raises(OSError, match="no_such_video"):
        write_folder(recording, tmp_path / "run")
    assert list(tmp_path.iterdir()) == []


def test_a_taken_path_and_a_shape_track_are_refused(tmp_path: Path) -> None:
    recording = random_recording()
    write_folder(recording, tmp_path / "run")
    with pytest.raises(InputError, match="is there already"):
        write_folder(recording, tmp_path / "run")
    one, none = np.zeros(1), np.zeros((1, 1, 1))
    shape = ShapeTrack(one, np.zeros((1, 1)), none, np.ones(1, bool), ("",), 1.0, 0.0, np.zeros(2))
    with pytest.raises(InputError, match="shape"):
        write_folder(replace(recording, shape=shape), tmp_path / "other")


def test_real_world_variety_is_read(tmp_path: Path) -> None:
    frame = "0,0,0,0\r\n,,0,0.5\r\n0.01,0.13,0,1\r\n"
    midline = "\ufeff# from our tracker\r\nx_m,y_m,t_s,s\r\n" + frame + "\r\n# gap\r\n0,0,0.1,0\r\n0,0.1,0.1,1\r\n"
    motor = "current_a,t_s,angle_rad,command_rad\n1,0,0.1,0\n1,0.1,0.2,0 # slow\n"
    folder = lab_folder(
        tmp_path / "lab", recording__toml="\ufeff" + CONE.replace("\n", "\r\n"), midline__csv=midline, motor__csv=motor
    )
    recording = read_folder(folder)
    assert recording.midline is not None
    assert recording.motor is not None
    nan = np.nan
    np.testing.assert_array_equal(recording.midline.s, [0, 0.5, 1])
    np.testing.assert_array_equal(
        recording.midline.xy, [[[0, 0], [nan, nan], [0.01, 0.13]], [[0, 0], [nan, nan], [0, 0.1]]]
    )
    assert np.isnan(recording.midline.sigma).all()
    np.testing.assert_array_equal(recording.motor.angle, [0.1, 0.2])
    assert recording.declaration.fluid.density == 0.0
    assert recording.load_cell is None


def test_frames_with_a_gap_or_cut_off_are_refused(tmp_path: Path, png_frames: Path) -> None:
    folder = lab_folder(tmp_path / "lab", recording__toml=CONE + CAMERA)
    shutil.copytree(png_frames, folder / "frames")
    assert read_folder(folder).video is not None
    whole = (folder / "frames" / "00001.png").read_bytes()
    (folder / "frames" / "00001.png").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match=r"00001\.png: the image is cut off"):
        read_folder(folder)
    (folder / "frames" / "00001.png").unlink()
    with pytest.raises(InputError, match=r"00001\.png: missing"):
        read_folder(folder)


def test_a_video_needs_a_camera(tmp_path: Path, png_frames: Path) -> None:
    folder = lab_folder(tmp_path / "lab", recording__toml=CONE)
    shutil.copytree(png_frames, folder / "frames")
    with pytest.raises(InputError, match="camera: missing"):
        read_folder(folder)


def test_a_missing_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        read_folder(tmp_path / "nowhere")


def test_a_long_csv_keeps_every_digit(tmp_path: Path) -> None:
    """39 s at 60 fps with 41 points."""
    rng = np.random.default_rng(1)
    columns = {name: rng.normal(size=95_940) for name in ("t_s", "s", "x_m", "y_m", "sigma_m")}
    columns["x_m"][100] = np.nan
    file = tmp_path / "midline.csv"
    write_csv(file, columns)
    table = read_csv(file, list(columns), blank_allowed=True)
    for name, values in columns.items():
        np.testing.assert_array_equal(table[name], values)


def test_uncertain_numbers_are_read_with_their_means_and_written_back(tmp_path: Path) -> None:
    cone = CONE.replace("1070", "{ value = 1050, sd = 40 }").replace("0.14", "{ low = 0.138, high = 0.142 }")
    gravity = "[gravity]\nangle_rad = { value = 0.1, sd = 0.02 }\n"
    cone += "clamp_length_m = { value = 0.002, sd = 0.001 }\nshear_compliance = { value = 1, sd = 0.5 }\n"
    text = cone + gravity + "[markers]\ntip = { s = { value = 0.9, sd = 0.01 }, d = 0 }\n"
    recording = read_folder(lab_folder(tmp_path / "lab", recording__toml=text, markers__csv=MARKERS))
    declaration = recording.declaration
    specimen = declaration.specimen
    assert (specimen.density, specimen.length, specimen.clamp_length) == (1050.0, 0.14, 0.002)
    assert recording.markers is not None
    assert recording.markers.s[0] == 0.9
    fields = {number.field: number for number in declaration.uncertain}
    names = ("density_kg_m3", "length_m", "clamp_length_m", "shear_compliance")
    of_specimen = {f"specimen.{name}" for name in names}
    assert set(fields) == of_specimen | {"gravity.angle_rad", "markers.tip.s"}
    assert fields["specimen.density_kg_m3"].sd == 40.0
    assert fields["specimen.length_m"].bounds == (0.138, 0.142)
    assert fields["specimen.clamp_length_m"].bounds == (0.0, 0.008)  # no clamp gives less than a rigid one
    assert fields["specimen.shear_compliance"].bounds == (0.0, 4.0)
    assert_equal_recordings(read_folder(write_folder(recording, tmp_path / "again")), recording)

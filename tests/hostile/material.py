"""Sound inputs of every kind, small, made once: what the cases then damage."""

from __future__ import annotations

import shutil
from itertools import pairwise
from pathlib import Path

import numpy as np

from mujoco_ref.export.write import write_mjcf
from rig.run_file import read_run, to_recording
from tentacle.io.declaration_file import RecordingFile
from tentacle.io.model_file import read_model
from tentacle.io.recording_rrd import write_rrd
from tentacle.io.write_folder import write_folder
from tentacle.recording import Camera, Declaration, Recording
from tentacle.signals import (
    AccelerationSignal,
    Accelerometer,
    LoadCellSignal,
    Markers,
    Midline,
    MotorSignal,
    StrainGauge,
    StrainSignal,
    Video,
)
from tentacle.specimen import WATER, Cone, Specimen

SPECIMEN = Specimen(Cone(0.0125, 0.003), 0.14, 1070.0)
CAMERA = Camera(20.0, 0.0008, (80.0, 20.0), (0.0, 1.0), 0.004)
SECONDS = 3.0
TEXTS = {
    "model.toml": """order = 2
[specimen]
section = "cone"
base_radius_m = 0.0125
tip_radius_m = 0.003
length_m = 0.14
density_kg_m3 = 1070.0
[fluid]
density_kg_m3 = 1000.0
[gravity]
angle_rad = 0.0
[effects.elasticity]
E = {value = 2e5, low = 1e5, high = 4e5, unit = "Pa"}
[effects.damping]
eta = {value = 2e3, low = 0.0, high = 1e4, unit = "Pa s"}
[effects.drag]
C_perp = {value = 1.1, low = 0.0, high = 3.0, unit = "1"}
""",
    "waveform.toml": """[waveform]
kind = "sine"
amplitude_rad = 0.3
frequency_hz = 1.0
ramp_s = 0.5
""",
    "samples.toml": """[waveform]
kind = "samples"
t_s = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2]
angle_rad = [0.0, 0.1, 0.2, 0.1, 0.0, -0.1, 0.0]
""",
    "rig.toml": """port = "nowhere"
[limits]
min_angle_rad = -0.8
max_angle_rad = 0.8
max_speed_rad_s = 8.0
max_current_a = 0.9
[servo]
centre_us = 1500.0
us_per_rad = 636.6
[settle]
threshold_n = 0.002
samples = 100
timeout_s = 60.0
[load_cell]
offset_counts = 52000.0
counts_per_newton = 180000.0
[camera]
source = "emulated"
offset_s = 0.03
offset_sigma_s = 0.001
[recording.specimen]
section = "cone"
base_radius_m = 0.0125
tip_radius_m = 0.003
length_m = 0.14
density_kg_m3 = 1070.0
[recording.camera]
fps = 30.0
m_per_px = 0.0008
base_px = [160.0, 24.0]
arm_px = [0.0, 1.0]
""",
    "campaign.toml": """name = "sweep"
[[run]]
name = "slow"
duration_s = 4.0
repeat = 2
[run.waveform]
kind = "sine"
amplitude_rad = 0.3
frequency_hz = 0.5
ramp_s = 0.5
[[run]]
name = "rest"
duration_s = 2.0
[run.waveform]
kind = "rest"
""",
    "limits.toml": """[limits]
angle_rad = 0.8
speed_rad_s = 5.0
acceleration_rad_s2 = 100.0
torque_n_m = 0.5
bandwidth_hz = 4.0
lowest_frequency_hz = 0.3
highest_frequency_hz = 2.0
""",
    "calibration.toml": """made = "20 trials"
[effect]
trials = 20
stated = [0.2, 0.6, 0.95]
right = [0.3, 0.7, 0.9]
""",
    "effect.toml": """name = "pull"
title = "Pull at the tip"
source = "a spring"
[law]
acts = "tip"
force_x = "F * (place - x) / reference"
[constants]
reference = { value = 0.05, unit = "m" }
[parameters.F]
unit = "N"
nominal = 0.002
bounds = [-0.5, 0.5]
words = "pull"
[parameters.place]
unit = "m"
nominal = 0.06
bounds = [-0.6, 0.6]
words = "where"
""",
    "lens.toml": """[lens]
centre_px = [80.0, 60.0]
reference_px = 100.0
k1 = 0.01
k2 = 0.0
m_per_px = 0.0008
""",
}


def make_material(root: Path) -> Path:
    """Writes one sound input of each kind into root."""
    root.mkdir(parents=True, exist_ok=True)
    for name, text in TEXTS.items():
        (root / name).write_text(text)
    measured = measured_recording()
    write_folder(measured, root / "folder")
    write_rrd(measured, root / "whole.rrd")
    _film(root / "film.mp4")
    filmed = Recording("film", Declaration(SPECIMEN, WATER, camera=CAMERA), video=Video(root / "film.mp4"))
    write_folder(filmed, root / "film")
    write_rrd(filmed, root / "film.rrd")
    _frames(root / "frames")
    write_folder(Recording("stills", filmed.declaration, video=Video(root / "frames")), root / "stills")
    write_rrd(Recording("stills", filmed.declaration, video=Video(root / "frames")), root / "stills.rrd")
    _log(root / "log.csv")
    (root / "speeds.csv").write_text("arm,motion,speed_m_s\n1,1,0.01\n1,2,0.02\n2,1,0.015\n2,2,0.03\n")
    _run(root / "run.rrd")
    write_folder(to_recording(read_run(root / "run.rrd")), root / "run_as_folder")
    (root / "library").mkdir()
    for name in ("whole.rrd", "run.rrd"):
        shutil.copy(root / name, root / "library" / name)
    write_mjcf(read_model(root / "model.toml"), root / "exported", 4)
    shutil.copy(root / "exported" / "arm.xml", root / "arm.xml")
    return root


def measured_recording() -> Recording:
    """A swaying arm: motor, load cell, midline and two markers."""
    t = np.arange(0.0, SECONDS, 0.05)
    s = np.linspace(0.0, 1.0, 9)
    angle = 0.3 * np.sin(2 * np.pi * t)
    phi = angle[:, None] + 0.4 * np.sin(2 * np.pi * t - 0.5)[:, None] * s
    step = SPECIMEN.length * np.diff(s, prepend=0.0)
    xy = np.stack([np.cumsum(np.sin(phi) * step, axis=1), np.cumsum(np.cos(phi) * step, axis=1)], axis=-1)
    fine = np.arange(0.0, SECONDS, 0.01)
    swing = 0.3 * np.sin(2 * np.pi * fine)
    return Recording(
        "swaying",
        Declaration(SPECIMEN, WATER),
        MotorSignal(fine, swing, swing),
        LoadCellSignal(fine, 0.02 * np.sin(4 * np.pi * fine)),
        Midline(t, s, xy, np.full(xy.shape[:2], 2e-4)),
        Markers(t, ("middle", "tip"), np.array([0.5, 1.0]), np.zeros(2), xy[:, [4, 8]].copy()),
        strain=StrainSignal(fine, ("root",), (StrainGauge(0.2, 0.01),), 0.03 * np.sin(2 * np.pi * fine - 0.5)[:, None]),
        acceleration=AccelerationSignal(fine, ("tip",), (Accelerometer(1.0, 0.0, "normal"),), 3.0 * swing[:, None]),
    )


def _pictures() -> list[np.ndarray]:
    import cv2

    recording, pictures = measured_recording(), []
    assert recording.midline is not None
    for xy in recording.midline.xy[:20]:
        picture = np.full((240, 160, 3), 220, np.uint8)
        px = np.round(CAMERA.to_pixels(xy)).astype(np.int32)
        for k, (one, two) in enumerate(pairwise(px)):
            cv2.line(picture, one.tolist(), two.tolist(), (30, 30, 30), 28 - 3 * k)
        pictures.append(picture)
    return pictures


def _film(file: Path) -> None:
    import av

    with av.open(str(file), "w") as container:
        stream = container.add_stream("libx264", rate=20)
        stream.width, stream.height, stream.pix_fmt = 160, 240, "yuv420p"
        for picture in _pictures():
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="bgr24")))
        container.mux(stream.encode(None))


def _frames(folder: Path) -> None:
    import cv2

    folder.mkdir()
    for number, picture in enumerate(_pictures()[:4]):
        cv2.imwrite(str(folder / f"{number:05d}.png"), picture)


def _log(file: Path) -> None:
    t = np.arange(0.0, 3.0, 0.0107)
    grams = 5.0 * np.sin(t)
    rows = [f"{a},{round(52000 + 1765 * g)},{g}" for a, g in zip(t.tolist(), grams.tolist(), strict=True)]
    file.write_text("timestamp_s,thrust_raw,thrust_gf\n" + "\n".join(rows) + "\n")


def _run(file: Path) -> None:
    """A rig's own recording, from samples as a board sends them."""
    import cv2

    from rig.camera import CameraFrame
    from rig.clock import ClockFit
    from rig.protocol import BoardEvent, EventCode, LoadSample, ServoSample
    from rig.recorder import Recorder
    from rig.setup_file import LoadCellCalibration
    from tentacle.io.declaration_file import declaration_tables

    cell = LoadCellCalibration(52000.0, 180000.0)
    tables = declaration_tables(RecordingFile(Declaration(SPECIMEN, WATER, camera=CAMERA)).declaration)
    start = {
        "name": "run", "started_utc": "2026-01-01T00:00:00.000+00:00", "waveform": {"kind": "rest"}, "lead_s": 0.0,
        "duration_s": 2.0, "period_s": 0.02, "board": None, "rig": {}, "recording": tables,
        "load_cell": {"offset_counts": cell.offset, "counts_per_newton": cell.slope, "rms_n": 0.0}, "camera": None,
    }  # fmt: skip
    with Recorder(file, start, cell.to_newtons) as recorder:
        recorder.clock(ClockFit(100.0, 3.0, 0.0, 1e-5, 1e-4))
        recorder.begin(3_000_000)
        number = 0
        for k in range(100):
            us = 3_000_000 + 20_000 * k
            if k == 0:
                recorder.samples([BoardEvent(number, us, EventCode.STARTED, 0)])
                number += 1
            recorder.samples([ServoSample(number, us, 1000 * k, 1000 * k, 1500 + k, 100)])
            recorder.samples([LoadSample(number + 1, us + 5000, 52000 + 10 * k)])
            number += 2
            if k % 5 == 0:
                _, jpeg = cv2.imencode(".jpg", _pictures()[k // 5])
                recorder.frames([CameraFrame(100.0 + 0.02 * k, jpeg.tobytes(), np.zeros((12, 16)))])
            if k % 20 == 0:
                recorder.flush()
        recorder.samples([BoardEvent(number, 5_000_000, EventCode.COMPLETE, 0)])
        stop = {"words": "", "start_us": 3_000_000, "ended_utc": "", "counters": {}, "clock": None, "camera": None,
                "rest_n": 0.0}  # fmt: skip
        recorder.stop("complete", stop)

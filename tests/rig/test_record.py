"""Recording: whole runs, crashed runs, runs on a full disk, stalled cameras; all of them readable and honest."""

from __future__ import annotations

import shutil
import subprocess
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks._rig_scene import DECLARED, TABLE, WAVE, killed_while_recording, setup_for
from rig.board import Board
from rig.camera import CameraThread
from rig.connection import connected, opened_camera
from rig.emulated_camera import EmulatedOptics, EmulatedSource
from rig.emulator import Emulator
from rig.motion import RigMotion, rig_motion
from rig.record import Attendance, RunResult, add_film, record_run
from rig.recorder import Recorder
from rig.run_file import read_run, to_recording
from rig.settle import SettleRule
from rig.setup_file import CameraSettings, RigSetup, read_setup, write_setup
from rig.stop_file import reserve, stop_file
from tentacle.errors import InputError
from tentacle.io.recording_from_rrd import read_rrd


@pytest.fixture
def setup(emulator: Emulator) -> RigSetup:
    return setup_for(emulator)


def test_rig_toml_comes_back_as_it_was(setup: RigSetup, tmp_path: Path) -> None:
    setup = replace(setup, camera=CameraSettings("0", 0.04, 0.001), rate=2.0)
    write_setup(setup, tmp_path / "rig.toml")
    assert read_setup(tmp_path / "rig.toml") == setup


def test_rig_toml_without_limits_is_refused(setup: RigSetup, tmp_path: Path) -> None:
    file = tmp_path / "rig.toml"
    write_setup(setup, file)
    text = file.read_text()
    file.write_text(text.replace("max_speed_rad_s = 8.0\n", ""))
    with pytest.raises(InputError, match=r"rig.toml.*limits\.max_speed_rad_s: missing"):
        read_setup(file)
    file.write_text(text.replace("max_speed_rad_s = 8.0", "max_speed_rad_s = 1.0"))
    with pytest.raises(InputError, match="silent host"):
        read_setup(file)


def test_a_run_with_a_camera_becomes_a_recording(setup: RigSetup, tmp_path: Path) -> None:
    setup = replace(setup, camera=CameraSettings("emulated"))
    path = tmp_path / "run.rrd"
    with connected(setup) as board, opened_camera(setup, board.time) as camera:
        result = record_run(
            setup, board, camera, rig_motion(WAVE, 2.0, setup.limits, TABLE), path, Attendance(name="swim")
        )
    assert result.outcome == "complete"
    assert result.lost == 0
    run = read_run(path)
    assert run.outcome == "complete"
    camera_record = run.stop["camera"] if run.stop else {}
    # Six flashes at 30 frames a second: about 1.8 ms (tests of the estimate); the bound is four of those.
    assert camera_record["offset_s"] == pytest.approx(EmulatedOptics.of(DECLARED).offset, abs=7.2e-3)
    recording = to_recording(run, video=tmp_path / "video.mp4")
    assert recording.name == "swim"
    assert recording.declaration == DECLARED
    assert recording.motor is not None
    assert recording.load_cell is not None
    inside = (recording.motor.t > 0) & (recording.motor.t < 2.0)
    np.testing.assert_allclose(recording.motor.command[inside], WAVE(recording.motor.t[inside])[0], atol=1.1e-3)
    import av

    with av.open(str(tmp_path / "video.mp4")) as video:
        times = [float(frame.time) for frame in video.decode(video=0) if frame.time is not None]
    assert np.median(np.diff(times)) == pytest.approx(1 / 30, abs=2e-3)  # whole milliseconds and the camera's jitter
    assert 0 <= times[0] < 0.1


def test_the_file_is_a_recording_as_it_stands(setup: RigSetup, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    setup = replace(setup, camera=CameraSettings("emulated"))
    path, killed = tmp_path / "run.rrd", tmp_path / "killed"

    def film(recorder: Recorder, file: Path, stop: dict[str, Any]) -> None:
        add_film(recorder, file, stop)
        killed.mkdir()
        for name in (path.name, stop_file(path).name):  # what a host that dies here leaves
            shutil.copy(tmp_path / name, killed / name)

    monkeypatch.setattr("rig.record.add_film", film)
    with connected(setup) as board, opened_camera(setup, board.time) as camera:
        record_run(setup, board, camera, rig_motion(WAVE, 1.0, setup.limits, TABLE), path, Attendance(name="swim"))
    recording = read_rrd(path)
    assert recording.name == "swim"
    assert recording.notes["outcome"] == "complete"
    assert "cut_off" not in recording.notes
    assert recording.video is not None
    assert recording.motor is not None
    whole = to_recording(read_run(path)).motor
    assert whole is not None
    np.testing.assert_allclose(recording.motor.t, whole.t[-len(recording.motor.t) :])
    assert read_run(killed / path.name).outcome == "complete"
    assert sorted(file.name for file in tmp_path.iterdir() if file.is_file()) == [path.name]


def test_killed_host_leaves_a_readable_file_and_the_arm_at_neutral(emulator: Emulator, tmp_path: Path) -> None:
    path, neutral, killed = killed_while_recording(emulator, tmp_path, 1.7)
    assert neutral < 0.5
    run = read_run(path)
    assert run.outcome == "crashed"
    assert killed - run.load_t[-1] < 0.3
    left = path.with_name(f".{path.name}.reserve")
    assert left.exists()
    reserve(path.with_name("next.rrd"))  # the room of a killed process is given back; one's own is kept
    reserve(path.with_name("third.rrd"))
    assert not left.exists()
    assert len(list(path.parent.glob(".*.reserve"))) == 2
    recording = read_rrd(path)
    assert recording.notes["outcome"] == "crashed"
    planned = f"of {run.start['duration_s']:.2f} s are missing"  # both readers tell of the same length
    assert run.missing.endswith(planned)
    assert recording.notes["cut_off"].endswith(planned)
    assert recording.motor is not None
    inside = (recording.motor.t > 0.1) & (recording.motor.t < 1.2)
    # Time 0 stands in the file from the start of the run on; chords of the motion: 1e-3 rad.
    np.testing.assert_allclose(recording.motor.command[inside], WAVE(recording.motor.t[inside])[0], atol=1.1e-3)


def test_a_disk_that_fills_ends_the_run_safely(setup: RigSetup, emulator: Emulator, tmp_path: Path) -> None:
    begun = time.monotonic()
    path = tmp_path / "run.rrd"
    with connected(setup) as board:
        result = record_run(
            setup,
            board,
            None,
            rig_motion(WAVE, 20.0, setup.limits, TABLE),
            path,
            Attendance(name="full", free_bytes=lambda _: 0 if time.monotonic() - begun > 3.0 else 10**9),
        )
        time.sleep(0.3)
        assert emulator.truth().pulse_us == 1500
    assert result.outcome == "disk"
    assert read_run(path).outcome == "disk"


def test_a_load_cell_that_is_saturated_for_half_of_a_run_is_no_complete_run(
    setup: RigSetup, emulator: Emulator, tmp_path: Path
) -> None:
    def hang(phase: str, share: float) -> None:
        if phase == "running":
            emulator.say("load", 100.0 if 0.3 < share < 0.8 else 0.0)  # N; 47 N are the end of 24 bits

    path = tmp_path / "run.rrd"
    with connected(setup) as board:
        motion = rig_motion(WAVE, 4.0, setup.limits, TABLE)
        result = record_run(setup, board, None, motion, path, Attendance(name="saturated", progress=hang))
    assert result.outcome == read_run(path).outcome == "load_cell"
    assert "the load cell gave no reading for" in result.words
    assert np.isnan(result.mean_thrust)


def test_a_disk_of_a_few_megabytes_that_is_full_ends_the_run_safely(
    setup: RigSetup, emulator: Emulator, tmp_path: Path
) -> None:
    """A true file system: what fails is the write itself, whatever the free space is said to be."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", disk], capture_output=True, check=False)
    if mounted.returncode != 0:
        pytest.skip("nothing may be mounted here")
    try:
        (disk / "ballast").write_bytes(bytes(3_400_000))
        setup = replace(setup, camera=CameraSettings("emulated", 0.05, 0.001))
        path = disk / "run.rrd"
        with connected(setup) as board, opened_camera(setup, board.time) as camera:
            motion = rig_motion(WAVE, 20.0, setup.limits, TABLE)
            attendance = Attendance(name="full", free_bytes=lambda _: 10**9)
            result = record_run(setup, board, camera, motion, path, attendance)
            time.sleep(0.3)
            assert emulator.truth().pulse_us == 1500
        assert result.outcome == "disk"
        (disk / "ballast").unlink()
        assert len(read_run(path).load_t) > 100  # what was on the disk is readable
    finally:
        subprocess.run(["umount", disk], check=True)


def test_a_stalled_camera_is_written_down_and_the_rest_is_whole(
    setup: RigSetup, emulator: Emulator, tmp_path: Path
) -> None:
    setup = replace(setup, camera=CameraSettings("emulated", 0.05, 0.001))
    optics = replace(EmulatedOptics.of(DECLARED), stall=(5.0, 6.5))
    path = tmp_path / "run.rrd"
    with connected(setup) as board:
        camera = CameraThread(lambda: EmulatedSource(emulator.trace, optics, board.time), board.time)
        result = record_run(
            setup, board, camera, rig_motion(WAVE, 4.0, setup.limits, TABLE), path, Attendance(name="stall")
        )
        camera.close()
    run = read_run(path)
    assert result.outcome == "complete"
    assert run.stop is not None
    ((begin, end),) = run.stop["camera"]["gaps_host_s"]
    assert end - begin > 1.5  # from the last frame before it to the first after
    assert result.lost == 0


def test_water_that_does_not_settle_ends_before_anything_moves(setup: RigSetup, tmp_path: Path) -> None:
    setup = replace(setup, settle=SettleRule(threshold=1e-5, samples=60, timeout=1.5))  # below the cell's own noise
    with connected(setup) as board:
        result = record_run(
            setup,
            board,
            None,
            rig_motion(WAVE, 2.0, setup.limits, TABLE),
            tmp_path / "run.rrd",
            Attendance(name="restless"),
        )
    assert result.outcome == "not_settled"
    run = read_run(tmp_path / "run.rrd")
    assert np.all(run.command == 0.0)


def test_a_taken_path_is_refused_before_anything_moves(setup: RigSetup, tmp_path: Path) -> None:
    path = tmp_path / "run.rrd"
    path.write_bytes(b"mine")
    with connected(setup) as board, pytest.raises(InputError, match="is there already"):
        record_run(setup, board, None, rig_motion(WAVE, 2.0, setup.limits, TABLE), path, Attendance(name="again"))
    assert path.read_bytes() == b"mine"


def test_what_is_no_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_run(tmp_path / "none.rrd")
    (tmp_path / "text.rrd").write_text("no recording")
    with pytest.raises(InputError):
        read_run(tmp_path / "text.rrd")


def test_a_replayed_run_is_the_run(setup: RigSetup, tmp_path: Path) -> None:
    from rig.replay import drive_rig

    with connected(setup) as board:
        record_run(
            setup,
            board,
            None,
            rig_motion(WAVE, 2.0, setup.limits, TABLE),
            tmp_path / "run.rrd",
            Attendance(name="first"),
        )
        result, difference = drive_rig(tmp_path / "run.rrd", setup, board, tmp_path / "again.rrd")
    assert result.outcome == "complete"
    assert difference is not None
    assert difference.seconds > 1.9
    # Chords of the motion 20 ms apart, twice: each up to (2 pi)^2 0.5 0.02^2 / 8 = 1e-3 rad; the thrust's noise is
    # 0.33 mN.
    assert difference.command < 2e-3
    assert difference.angle < 5e-3
    assert difference.thrust is not None
    assert difference.thrust < 2e-3


def test_a_replay_that_a_fault_cut_short_is_a_fault_and_no_bad_input(
    setup: RigSetup, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the board's watchdog bites in the first second, that is said, and not that the recording is too short."""
    from rig.replay import drive_rig

    def cut(setup: RigSetup, board: Board, camera: None, _: RigMotion, path: Path, __: Attendance) -> RunResult:
        done = record_run(
            setup, board, camera, rig_motion(WAVE, 0.5, setup.limits, TABLE), path, Attendance(name="cut")
        )
        return replace(done, outcome="watchdog")

    with connected(setup) as board:
        record_run(
            setup,
            board,
            None,
            rig_motion(WAVE, 2.0, setup.limits, TABLE),
            tmp_path / "run.rrd",
            Attendance(name="first"),
        )
        monkeypatch.setattr("rig.replay.record_run", cut)
        result, difference = drive_rig(tmp_path / "run.rrd", setup, board, tmp_path / "again.rrd")
    assert (result.outcome, difference) == ("watchdog", None)

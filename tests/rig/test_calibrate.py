"""Calibration: lines through real and made readings, and the camera's delay."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks._rig_optimise import DECLARED as SOFT
from benchmarks._rig_scene import CAMERA, DECLARED, setup_for
from rig.arm_plant import ArmPlant
from rig.bench_log import LogColumns, calibration_of, load_cell_signal, read_bench_log
from rig.calibrate import camera_scale, fit_line, load_cell_calibration, read_cell, servo_calibration
from rig.camera_offset import CameraOffset, combined, estimate_offset, lit_frames
from rig.emulated_camera import EmulatedOptics, draw_picture
from rig.emulator import Emulator
from rig.fault import Fault
from rig.play import arm_board
from rig.safety import ServoCalibration
from rig.servo_tap import TAP_FREQUENCIES, TAP_SWING, delay, root_angle
from rig.setup_file import CameraSettings, read_setup, write_setup
from tentacle.cli import main
from tentacle.errors import InputError
from tentacle.specimen import STANDARD_GRAVITY
from tentacle.waveform import Multisine

DATA = Path(os.environ.get("TENTACLE_DATA", Path(__file__).parents[2].parent / "shared" / "data")) / "thrust_bench"
needs_data = pytest.mark.skipif(not DATA.is_dir(), reason="no thrust_bench data (tentacle data says where it is)")


def test_line_through_readings_with_an_outlier() -> None:
    source = np.random.default_rng(2)
    newtons = np.linspace(0, 5, 12)
    counts = 52000 + 180000 * newtons + source.normal(0, 60, 12)
    counts[4] += 40000  # someone touched the bench
    fit = fit_line(newtons, counts)
    assert fit.outliers == 1
    assert abs(fit.slope - 180000) < 4 * fit.slope_sigma
    assert abs(fit.offset - 52000) < 4 * fit.offset_sigma
    assert fit.slope_sigma == pytest.approx(60 / np.sqrt(np.sum((newtons - newtons.mean()) ** 2)), rel=0.6)
    assert fit.rms < 1e-3  # 60 counts are 0.33 mN


def test_readings_that_do_not_follow_the_loads_are_refused() -> None:
    with pytest.raises(InputError, match="no line"):
        fit_line(np.zeros(5), np.arange(5.0))
    with pytest.raises(InputError, match="do not follow"):
        fit_line(np.arange(8.0), np.random.default_rng(3).normal(0, 1, 8))


def test_servo_and_scale() -> None:
    pulses_are = ServoCalibration(1500.0, 636.6)
    commanded = np.array([-0.6, -0.3, 0.0, 0.3, 0.6])
    measured = (1500.0 + 636.6 * commanded - 1480.0) / 650.0  # the horn sits 20 us off, the slope differs
    found = servo_calibration(commanded, measured, pulses_are)
    assert found.centre_us == pytest.approx(1480.0)
    assert found.us_per_rad == pytest.approx(650.0)
    assert camera_scale((10, 20), (10, 220), 0.1) == pytest.approx(5e-4)
    with pytest.raises(InputError):
        camera_scale((10, 20), (11, 20), 0.1)


@needs_data
@pytest.mark.parametrize("name", ["datura-2.5", "datura-3.0", "datura-3.5", "datura-4.9", "robo-2.5", "robo-3"])
def test_real_hx711_counts_and_their_grams_are_one_line(name: str) -> None:
    log = read_bench_log(DATA / f"{name}.csv")
    fit = calibration_of(log)
    # The bench rounds grams to 0.001 gf (9.8 uN): residuals within half of that; one gain for every run of this cell.
    assert np.abs(fit.residuals).max() < 0.6e-3 * 1e-3 * STANDARD_GRAVITY
    assert fit.slope == pytest.approx(70286.2, abs=0.5)
    low, high = log.jitter
    assert 0.05 < low < 0.09 < high < 0.15  # the source's own words: 10 Hz with 60 to 150 ms between readings
    signal = load_cell_signal(log, load_cell_calibration(fit))
    assert log.force is not None
    np.testing.assert_allclose(signal.thrust, log.force, atol=1e-5)


@needs_data
def test_bad_rows_are_named(tmp_path: Path) -> None:
    lines = (DATA / "robo-3.csv").read_text().splitlines()
    file = tmp_path / "log.csv"
    file.write_text("\n".join([*lines[:5], lines[3], *lines[6:]]))
    with pytest.raises(InputError, match=r"log.csv:6: timestamp_s"):
        read_bench_log(file)
    file.write_text("\n".join([*lines[:5], lines[5].replace("-534", "-99999534"), *lines[6:]]))
    with pytest.raises(InputError, match=r"log.csv:6: thrust_raw.*HX711"):
        read_bench_log(file)
    file.write_text("t,c\n0,1\n1,2\n2,5\n")
    log = read_bench_log(file, LogColumns("t", "c", "none"))
    with pytest.raises(InputError, match="no calibrated force"):
        calibration_of(log)


def test_camera_offset_from_flashes() -> None:
    errors, scaled = [], []
    for seed in range(12):
        source = np.random.default_rng(seed)
        on = np.cumsum(0.12 + source.uniform(0.3, 0.5, 24))
        off = on + 0.12
        begun = np.arange(0, on[-1] + 1, 1 / 30) + source.uniform(0, 0.03)
        lit = np.clip(np.minimum(begun[:, None] + 0.01, off) - np.maximum(begun[:, None], on), 0, None).sum(1) > 0.005
        arrives = begun + 0.055 + source.normal(0, 0.0015, begun.size)
        found = estimate_offset(arrives, lit, on, off)
        errors.append(found.offset - 0.050)  # 0.055 after the exposure opened, 0.050 after its middle
        scaled.append(errors[-1] / found.sigma)
    assert np.abs(errors).max() < 3e-3
    assert abs(np.mean(errors)) < 4 * 0.8e-3 / np.sqrt(12)
    assert 0.5 < np.std(scaled) < 1.7  # the stated sigma is the spread


def test_no_flash_in_sight_is_said() -> None:
    dark = 120 + np.random.default_rng(1).normal(0, 1, (60, 12, 16))
    with pytest.raises(Fault, match="no flash"):
        lit_frames(dark, np.arange(60) / 30, np.array([0.5, 1.2]), np.array([0.62, 1.32]))
    with pytest.raises(Fault, match="edges"):
        estimate_offset(np.arange(10) / 30, np.zeros(10, dtype=bool), np.array([]), np.array([]))


def test_an_arm_that_swings_is_not_taken_for_the_lamp() -> None:
    source = np.random.default_rng(2)
    on = 1.0 + np.cumsum(0.12 + source.uniform(0.3, 0.5, 6))
    arrives = np.arange(0, 5, 1 / 30)
    pictures = 120 + source.normal(0, 1, (arrives.size, 12, 16))
    pictures[:, 3:9, 4:12] += np.where(np.sin(2 * np.pi * 1.1 * arrives) > 0, 160, 0)[:, None, None]  # darker, brighter
    true = ((arrives[:, None] - 0.05 >= on) & (arrives[:, None] - 0.05 < on + 0.12)).any(axis=1)
    pictures[true, 0, 15] += 60
    np.testing.assert_array_equal(lit_frames(pictures, arrives, on, on + 0.12), true)


def test_camera_delay_from_servo_taps() -> None:
    source = np.random.default_rng(5)
    times = np.arange(0, 8, 0.02) + 100.0
    motion = np.sum([0.1 * np.sin(2 * np.pi * f * (times - 100)) for f in TAP_FREQUENCIES], axis=0)
    frames = np.arange(0.3, 8, 1 / 30) + 100.0
    late = 0.049
    seen = 0.03 - 0.98 * np.interp(frames - late, times, motion) + source.normal(0, 0.01, frames.size)  # mirrored, too
    seen[::17] = np.nan  # frames that were rejected
    found = delay(frames, seen, times, motion)
    assert found.sigma < 2e-3
    assert abs(found.offset - late) < 2 * found.sigma
    with pytest.raises(Fault, match="not seen to follow"):
        delay(frames, source.normal(0, 0.05, frames.size), times, motion)
    with pytest.raises(Fault, match="frames"):
        delay(frames[:20], seen[:20], times, motion)


def test_the_root_of_a_soft_arm_tells_the_delay() -> None:
    """The MuJoCo arm, its lag and its bend known: the delay is the camera's alone, within 3 ms."""
    taps, plant, late = Multisine((TAP_SWING,) * 3, TAP_FREQUENCIES, (0.0,) * 3), ArmPlant(SOFT, {}), 0.049
    optics, s = EmulatedOptics.of(DECLARED), np.linspace(0.0, 1.0, 24)
    times = np.arange(0.0, 6.0, 0.01)
    servo, frames, seen = [], [], []
    for t in times:
        plant.advance(t, float(taps(t)[0]), True)
        servo.append(plant.servo_angle)
        if t >= len(frames) / 20:
            image = draw_picture(plant.midline(s), 0.0, optics)
            frames.append(t + late)
            seen.append(root_angle(image, DECLARED, root_angle(image, DECLARED)))
    found = delay(np.array(frames), np.array(seen), times, np.array(servo))
    assert abs(found.offset - late) < 3e-3


def test_servo_taps_of_the_emulated_rig(emulator: Emulator, tmp_path: Path) -> None:
    """Two stiff links with a spring between them: the outer one bends behind the servo, and must not count."""
    file = tmp_path / "rig.toml"
    write_setup(setup_for(emulator, camera=CameraSettings("emulated")), file)
    tap = ["rig", "calibrate", "camera-offset", str(file), "--tap"]
    assert any(main(tap) == 0 for _ in range(3))  # a computer too busy to speak for 0.25 s is sent away: once more
    found = read_setup(file).camera
    assert found is not None
    words = ["--points", "100", "40", "225", "40", "--metres", "0.1"]
    assert main(["rig", "calibrate", "camera-scale", str(file), *words]) == 0
    assert read_setup(file).recording.declaration.camera == replace(CAMERA, metres_per_px=0.1 / 125)
    assert found.offset == pytest.approx(EmulatedOptics.of(DECLARED).offset, abs=3e-3)


def test_no_arm_in_sight_has_no_root() -> None:
    assert np.isnan(root_angle(np.full((240, 320), 200, dtype=np.uint8), DECLARED))


def test_two_estimates_that_agree_are_weighed_and_others_not() -> None:
    now = CameraOffset(0.050, 0.002, 12)
    assert combined(now, CameraOffset(0.052, 0.002, 48)).offset == pytest.approx(0.051)
    assert combined(now, CameraOffset(0.080, 0.001, 48)) == now
    assert combined(now, None) == now


def test_cell_of_the_emulated_rig_is_read(board, limits, servo) -> None:
    arm_board(board, limits, servo)
    reading = read_cell(board, 1.0)
    assert reading.mean == pytest.approx(52000, abs=4 * 60 / np.sqrt(reading.count))
    assert reading.deviation == pytest.approx(60, rel=0.4)
    assert reading.rate == pytest.approx(93.5, rel=0.03)

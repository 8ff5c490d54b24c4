"""Calibration: counts to newtons from known loads, pulses to angles, pixels to metres, and the camera's delay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rig import command_bodies
from rig.board import Board
from rig.camera import CameraThread
from rig.camera_offset import CameraOffset
from rig.camera_watch import FLASH_EVERY, FLASH_MS, Flashes
from rig.fault import Fault
from rig.protocol import BoardEvent, LoadSample, Type
from rig.safety import ServoCalibration
from rig.setup_file import LoadCellCalibration
from tentacle.errors import InputError
from tentacle.signals import Array

WORST_RMS = 0.03  # of the range; a load cell of the cheapest kind is within 0.1 %


@dataclass(frozen=True)
class LineFit:
    """value = (reading - offset) / slope, with standard deviations; residuals (N,) and rms in the value's unit.

    outliers: number of points left out, beyond 6 robust standard deviations.
    """

    offset: float
    slope: float
    offset_sigma: float
    slope_sigma: float
    residuals: Array
    rms: float
    outliers: int


def fit_line(values: Array, readings: Array) -> LineFit:
    """The line reading = offset + slope value through points (N,), by least squares with gross outliers out.

    InputError with fewer than two different values, or a slope of no significance.
    """
    values, readings = np.asarray(values, dtype=float), np.asarray(readings, dtype=float)
    if values.size < 2 or np.ptp(values) == 0:
        raise InputError(f"{values.size} points at one value give no line", expected="at least two different loads")
    keep = np.ones(values.size, dtype=bool)
    offset = slope = 0.0
    for _ in range(20):
        slope, offset = np.polyfit(values[keep], readings[keep], 1)
        misfit = np.abs(readings - offset - slope * values)
        spread = 1.4826 * float(np.median(misfit[keep]))
        fresh = misfit <= max(6.0 * spread, 1e-9 * float(np.abs(readings).max()))
        if (fresh == keep).all() or fresh.sum() < 2:
            break
        keep = fresh
    residual = readings[keep] - offset - slope * values[keep]
    degrees = max(int(keep.sum()) - 2, 1)
    variance = float(residual @ residual) / degrees
    centred = values[keep] - values[keep].mean()
    slope_sigma = float(np.sqrt(variance / (centred @ centred)))
    offset_sigma = float(np.sqrt(variance * (1 / keep.sum() + values[keep].mean() ** 2 / (centred @ centred))))
    if not abs(slope) > 3 * slope_sigma:
        raise InputError(f"the readings do not follow the loads (slope {slope:.4g} +- {slope_sigma:.2g})")
    in_units = (readings - offset) / slope - values
    rms = float(np.sqrt(np.mean(in_units[keep] ** 2)))
    if rms > WORST_RMS * np.ptp(values[keep]):
        raise InputError(
            f"the readings stray from a line by {100 * rms / np.ptp(values[keep]):.0f} % of the range",
            expected=f"at most {100 * WORST_RMS:g} %: did it come to rest at each, and was each put on?",
        )
    return LineFit(float(offset), float(slope), offset_sigma, slope_sigma, in_units, rms, int((~keep).sum()))


def load_cell_calibration(fit: LineFit) -> LoadCellCalibration:
    """A line of counts over newtons as rig.toml keeps it."""
    return LoadCellCalibration(fit.offset, fit.slope, fit.rms)


def servo_calibration(commanded: Array, measured: Array, servo: ServoCalibration) -> ServoCalibration:
    """A better servo calibration from angles commanded with `servo` and angles measured (N,) [rad]."""
    pulses = servo.centre_us + servo.us_per_rad * np.asarray(commanded, dtype=float)
    fit = fit_line(measured, pulses)
    return ServoCalibration(fit.offset, fit.slope)


def camera_scale(first_px: Sequence[float], second_px: Sequence[float], metres: float) -> float:
    """m/px from two image points a known distance apart, in the arm's plane and in the water."""
    pixels = float(np.hypot(second_px[0] - first_px[0], second_px[1] - first_px[1]))
    if pixels < 10 or not metres > 0:
        raise InputError(f"{pixels:.1f} px for {metres:g} m", field="scale", expected="points at least 10 px apart")
    return metres / pixels


@dataclass(frozen=True)
class Reading:
    """The load cell at rest: mean and standard deviation [counts] of `count` conversions, and their rate [1/s]."""

    mean: float
    deviation: float
    count: int
    rate: float


def read_cell(board: Board, seconds: float) -> Reading:
    """Reads the load cell for so many host-time seconds; Fault("load_cell") where it gives nothing."""
    board.take()
    until = board.time.now() + seconds
    samples: list[LoadSample] = []
    while board.time.now() < until:
        board.service()
        samples += [s for s in board.take() if isinstance(s, LoadSample)]
    if len(samples) < 3:
        raise Fault("load_cell", f"the load cell gave {len(samples)} readings in {seconds:g} s: is the HX711 wired?")
    counts = np.array([s.counts for s in samples], dtype=float)
    spacing = np.median(np.diff([s.board_us for s in samples]))
    return Reading(float(counts.mean()), float(counts.std(ddof=1)), len(samples), 1e6 / float(spacing))


def camera_offset(board: Board, camera: CameraThread, flashes: int = 16, seed: int = 1) -> CameraOffset:
    """Flashes the LED and finds the camera's delay; Fault("camera") where no flash is seen."""
    spacing = np.random.default_rng(seed)
    camera.take()
    board.take()
    seen = Flashes()

    def listen(seconds: float) -> None:
        until = board.time.now() + seconds
        while board.time.now() < until:
            board.service()
            seen.add_frames(camera.take())
            for sample in board.take():
                if isinstance(sample, BoardEvent):
                    seen.add_event(sample)

    listen(0.3)
    for _ in range(flashes):
        board.command(Type.FLASH, command_bodies.flash(FLASH_MS))
        listen(1e-3 * FLASH_MS + float(spacing.uniform(*FLASH_EVERY)))
    listen(0.6)
    return seen.offset(board.clock.fit())

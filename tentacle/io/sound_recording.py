"""Checks of every recording from any source: times that rise, SI units, consistent sizes.

Tables of an import folder are checked row by row before this (tentacle.io.import_folder), so that the message has a
line number.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.io.acceleration_file import AN_ACCELERATION, LARGEST_ACCELERATION
from tentacle.io.strain_file import A_STRAIN, largest_strain
from tentacle.place_slips import FARTHEST, factor_words
from tentacle.recording import Declaration, Recording
from tentacle.signals import AccelerationSignal, Array, BaseTravel, Markers, Midline, ShapeTrack, StrainSignal

LARGEST_ANGLE = 4 * math.pi  # rad; a servo turns less, so more is degrees by mistake
LARGEST_DISTANCE = 3.0  # arm lengths; farther from the clamp is millimetres by mistake
LARGEST_THRUST = 1000.0  # N; more is counts or grams by mistake
LONGEST_TRAVEL = 100.0  # m of a moving base; more is millimetres by mistake
LONGEST_SPAN = 86400.0  # s; a longer span is a clock that jumped
LEAST_STEP = 1e-6  # s between samples on the average; a shorter one is a time in other units
MOST_POINTS = 10_000  # of a midline, and markers


def reach_of(declaration: Declaration, travel: BaseTravel | None) -> float:
    """Largest distance [m] of a point of the arm from the origin."""
    own = LARGEST_DISTANCE * declaration.specimen.length
    if travel is None or declaration.seen_from == "base":
        return own
    return own + float(np.abs(travel.xy).max(initial=0.0))


def reach_words(xy: Array, reach: float) -> str:
    """What is expected of points (..., 2) [m] that may lie beyond `reach` [m], with the factor by which their scale
    seems wrong: the farthest point of an arm lies about its length from the clamp.
    """
    distances = np.hypot(xy[..., 0], xy[..., 1])
    distances = distances[np.isfinite(distances)]
    farthest = float(np.quantile(distances, FARTHEST)) if distances.size else 0.0
    factor = factor_words(LARGEST_DISTANCE * farthest / reach) if farthest > reach else ""
    return f"metres, within {reach:g} m of the clamp{factor}"


def check_recording(recording: Recording, file: Path) -> Recording:
    """The recording; InputError at the first impossible value."""
    reach = reach_of(recording.declaration, recording.travel)
    motor, load_cell = recording.motor, recording.load_cell
    if motor is not None:
        _check_times("motor", motor.t, file)
        for name, angle in (("motor.command_rad", motor.command), ("motor.angle_rad", motor.angle)):
            _check_series(name, angle, motor.t, LARGEST_ANGLE, "angles in rad", file)
    if load_cell is not None:
        _check_times("load_cell", load_cell.t, file)
        _check_series("load_cell.thrust_n", load_cell.thrust, load_cell.t, LARGEST_THRUST, "forces in N", file)
    if recording.travel is not None:
        _check_travel(recording, recording.travel, file)
    if recording.midline is not None:
        _check_midline(recording.midline, reach, file)
    if recording.markers is not None:
        _check_markers(recording.markers, reach, file)
    if recording.strain is not None:
        _check_strain(recording.strain, recording.declaration.specimen.length, file)
    if recording.acceleration is not None:
        _check_acceleration(recording.acceleration, file)
    if recording.shape is not None:
        _check_shape(recording.shape, file)
    _check_clocks(recording, file)
    return recording


def _check_travel(recording: Recording, travel: BaseTravel, file: Path) -> None:
    _check_times("base", travel.t, file)
    expected = f"metres, within {LONGEST_TRAVEL:g} m"
    _check_series("base.x_m", travel.xy[:, 0], travel.t, LONGEST_TRAVEL, expected, file)
    _check_series("base.y_m", travel.xy[:, 1], travel.t, LONGEST_TRAVEL, expected, file)
    if recording.video is not None and recording.declaration.seen_from == "ground":
        raise InputError(
            "a film of a base that travels through the picture is not tracked",
            file=file,
            field="base.seen_from",
            expected='"base", a camera that travels with it, or a midline or markers',
        )


def _check_times(name: str, t: Array, file: Path) -> None:
    if not len(t):
        raise InputError("no sample", file=file, field=name, expected="at least one")
    if not np.isfinite(t).all():
        raise InputError("a time is no finite number", file=file, field=f"{name}.t_s", expected="seconds")
    falls = np.diff(t) <= 0
    if falls.any():
        k = int(np.argmax(falls))
        raise InputError(
            f"time {t[k + 1]:.9g} after {t[k]:.9g}", file=file, field=f"{name}.t_s", expected="times that rise"
        )
    if t[-1] - t[0] > LONGEST_SPAN:
        raise InputError(
            f"from {t[0]:.9g} to {t[-1]:.9g} s: a clock that jumped?", file=file, field=f"{name}.t_s",
            expected=f"a recording of at most {LONGEST_SPAN:g} s",
        )  # fmt: skip
    require_steps(t, f"{name}.t_s", file)


def require_steps(t: Array, field: str, file: Path) -> None:
    """InputError where times (N,) [s] lie closer together than any of these signals is sampled."""
    if len(t) > 1 and t[-1] - t[0] < LEAST_STEP * (len(t) - 1):
        raise InputError(
            f"{len(t)} samples within {t[-1] - t[0]:.3g} s", file=file, field=field, expected="times in seconds"
        )


def _check_series(name: str, values: Array, t: Array, limit: float, expected: str, file: Path) -> None:
    if values.shape != t.shape:
        raise InputError(f"{values.shape} values at {len(t)} times", file=file, field=name, expected="one a time")
    _check_within(name, values, limit, expected, file)
    if np.isnan(values).any():
        raise InputError("a value is no number", file=file, field=name, expected=expected)


def _check_within(name: str, values: Array, limit: float, expected: str, file: Path) -> None:
    """InputError at the first value that is over the limit or infinite; NaN is: not seen."""
    over = np.abs(values) > limit
    if over.any():
        found = float(values.ravel()[int(np.argmax(over))])
        raise InputError(f"{found:g} cannot be", file=file, field=name, expected=expected)


def _check_points(name: str, xy: Array, shape: tuple[int, ...], reach: float, file: Path) -> None:
    if xy.shape != shape:
        raise InputError(f"{xy.shape} values", file=file, field=name, expected=f"{shape}")
    _check_within(name, xy, reach, reach_words(xy, reach), file)
    if (np.isnan(xy[..., 0]) != np.isnan(xy[..., 1])).any():
        raise InputError("one of x and y is missing", file=file, field=name, expected="both, or neither")


def _check_midline(midline: Midline, reach: float, file: Path) -> None:
    _check_times("midline", midline.t, file)
    s = midline.s
    if not 1 <= len(s) <= MOST_POINTS or not (
        np.isfinite(s).all() and (np.diff(s) > 0).all() and s[0] >= 0 >= s[-1] - 1
    ):
        raise InputError("not usable", file=file, field="midline.s", expected="numbers that rise, within 0 to 1")
    _check_points("midline", midline.xy, (len(midline.t), len(s), 2), reach, file)
    if midline.sigma.shape != midline.xy.shape[:2]:
        raise InputError(f"{midline.sigma.shape} values", file=file, field="midline.sigma_m", expected="one a point")
    if (midline.sigma <= 0).any():
        found = float(midline.sigma[midline.sigma <= 0][0])
        raise InputError(f"{found:g} is out of range", file=file, field="midline.sigma_m", expected="a number > 0")
    _check_within("midline.sigma_m", midline.sigma, reach, "metres", file)


def _check_markers(markers: Markers, reach: float, file: Path) -> None:
    _check_times("markers", markers.t, file)
    _check_points("markers", markers.xy, (len(markers.t), len(markers.names), 2), reach, file)


def _check_strain(strain: StrainSignal, length: float, file: Path) -> None:
    _check_times("strain", strain.t, file)
    _check_size("strain", strain.values, (len(strain.t), len(strain.gauges)), file)
    for k, (name, gauge) in enumerate(zip(strain.names, strain.gauges, strict=True)):
        most = largest_strain(gauge, length)
        _check_within(f"strain.{name}", strain.values[:, k], most, A_STRAIN, file)


def _check_acceleration(acceleration: AccelerationSignal, file: Path) -> None:
    _check_times("acceleration", acceleration.t, file)
    _check_size("acceleration", acceleration.values, (len(acceleration.t), len(acceleration.accelerometers)), file)
    for name, values in zip(acceleration.names, acceleration.values.T, strict=True):
        _check_within(f"acceleration.{name}", values, LARGEST_ACCELERATION, AN_ACCELERATION, file)


def _check_size(name: str, values: Array, shape: tuple[int, int], file: Path) -> None:
    if values.shape != shape:
        raise InputError(f"{values.shape} values", file=file, field=name, expected=f"{shape}")


def _check_shape(shape: ShapeTrack, file: Path) -> None:
    _check_times("shape", shape.t, file)
    for values in (shape, shape.measured()):
        _check_coefficients(values, file)


def _check_coefficients(shape: ShapeTrack, file: Path) -> None:
    count, order = shape.coefficients.shape
    fits = (
        count == len(shape.t) == len(shape.accepted) == len(shape.reason)
        and shape.covariance.shape == (count, order, order)
        and shape.base_shift.shape == (2,)
    )
    if not fits:
        raise InputError("its parts differ in size", file=file, field="shape", expected="one row a frame")
    accepted = shape.coefficients[shape.accepted], shape.covariance[shape.accepted]
    if not all(np.isfinite(values).all() for values in accepted):
        raise InputError("an accepted frame holds no finite number", file=file, field="shape", expected="numbers")


def _check_clocks(recording: Recording, file: Path) -> None:
    """InputError where signals have no time in common (one counts from 1970, say), or the release is after them all."""
    pictures = recording.midline or recording.markers
    if pictures is None:
        return
    start, stop = float(pictures.t[0]), float(pictures.t[-1])
    for name, signal in recording.logs.items():
        if signal.t[-1] < start or signal.t[0] > stop:
            raise InputError(
                f"from {signal.t[0]:.9g} to {signal.t[-1]:.9g} s, and the arm is seen from {start:.9g} to {stop:.9g} s",
                file=file / f"{name}.csv" if file.is_dir() else file,
                field="t_s" if file.is_dir() else f"{name}.t_s",
                expected="times of one clock",
            )
    release = recording.declaration.release_t
    if release is not None and release >= stop:
        raise InputError(
            f"{release:g} s is after the last frame ({stop:g} s)",
            file=file / "recording.toml" if file.is_dir() else file,
            field="release.t_s",
            expected="a time in the recording",
        )

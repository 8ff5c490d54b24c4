"""Slips of unit, sign, axis and place of sensors on the arm, by what the pictures say that they should read.

    f = (r'' - g) . axis,    strain = d phi' / L,        r, phi at the sensor's place as the pictures show them

A sensor's zero is unknown, but no zero is as large as half of gravity unless somebody took gravity out. So the mean of
an accelerometer tells its sign, its axis and, together with how it varies, its unit. The mean is blind where the axis
lies across gravity; the variation is blind where the arm hardly moves. A blind test says nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from tentacle.base_motion import Travel
from tentacle.recording import Recording
from tentacle.seen_arm import FEWEST_FRAMES, SeenArm, seen_arm
from tentacle.signals import RAREST_READING, AccelerationSignal, Accelerometer, Array, StrainSignal
from tentacle.slip import Slip
from tentacle.specimen import STANDARD_GRAVITY, Specimen

FARTHEST = (5.0, 0.25)  # half thicknesses, arm's lengths: no sensor on an arm lies beyond the larger one
DIFFERENCE_TIME = 0.06  # s between the pictures of a second difference: 1 mm of noise is .7 m/s^2
HALF, QUARTER = 0.5, 0.25  # of gravity, or of what an axis should read
IN_G = 0.04  # of what it should read: how near a reading in g lies to its share
ALIKE = 0.9  # correlation of readings and pictures from which their ratio tells something
ROUGHLY = 0.5  # the same of a strain, whose bounds are wide
AS_LARGE = (0.5, 2.0)  # the ratio of a sound accelerometer: pictures and straight lines err by less
AS_IN_G = (5.0, 20.0)
AS_STRAINED = (0.25, 4.0)  # a stiff gauge on soft silicone, and chords, change a strain by less
IMPOSSIBLE = 30.0  # times: another unit, of the strain or of d
HANGS = 0.3  # rad: of gravity's angle, and of the servo on average


@dataclass(frozen=True)
class Compared:
    """What an axis should read by the pictures, and what it reads, on average [m/s^2]; ratio: what it should read over
    what it reads, of the variations (None: not known). at_ends: the smaller of what it reads in the first and in the
    last tenth of the run, without sign.
    """

    wanted: float
    read: float
    ratio: float | None
    at_ends: float

    @property
    def tared(self) -> bool:
        """Whether it may have been set to zero at rest, so that its mean is that of a change."""
        return self.at_ends < HALF * abs(self.read)

    def within(self, bounds: tuple[float, float]) -> bool:
        """Whether the ratio is known and lies there."""
        return self.ratio is not None and bounds[0] < self.ratio < bounds[1]

    def words(self, axis: str) -> str:
        """Both numbers."""
        varies = "" if self.ratio is None else f"; the pictures vary {self.ratio:.3g} times as much as it does"
        given = f"motion and gravity give {self.wanted:.3g} along the {axis}"
        return f"reads {self.read:.3g} m/s^2 on average, {given}{varies}"


def sensor_slips(recording: Recording, travel: Travel | None) -> list[Slip | None]:
    """Slips of the recording's sensors; points are counted from the base, whose path is travel."""
    strain, acceleration, specimen = recording.strain, recording.acceleration, recording.declaration.specimen
    found: list[Slip | None] = []
    arm = None if strain is None and acceleration is None else seen_arm(recording)
    if strain is not None:
        silent = _silent(recording, strain, "strain")
        found += silent
        for k, (name, gauge) in enumerate(zip(strain.names, strain.gauges, strict=True)):
            if abs(gauge.d) != 1.0:  # 1 m: a sensor of curvature
                found.append(_far(specimen, f"strain.{name}.d", gauge.d, certain=False))
            if arm is not None and silent[k] is None:
                found.append(_strain_slip(arm, strain, k, specimen.length))
    if acceleration is not None:
        plain = _silent(recording, acceleration, "acceleration")
        plain += [_rate_slip(acceleration, k) for k in range(len(acceleration.names)) if plain[k] is None]
        for name, one in zip(acceleration.names, acceleration.accelerometers, strict=True):
            plain.append(_far(specimen, f"acceleration.{name}.d", one.d, certain=True))
        readable = all(slip is None for slip in plain)
        found += plain + (_acceleration_slips(recording, acceleration, arm, travel) if readable else [])
    return found


def _silent(recording: Recording, signal: StrainSignal | AccelerationSignal, name: str) -> list[Slip | None]:
    """For each sensor, whether it has no reading while the arm is seen."""
    pictures = recording.midline or recording.markers
    start, stop = (-np.inf, np.inf) if pictures is None else (pictures.t[0], pictures.t[-1])
    unit = "m_s2" if name == "acceleration" else "strain"
    found: list[Slip | None] = []
    for sensor, values in zip(signal.names, signal.values.T, strict=True):
        there = np.isfinite(values)
        if (there & (signal.t >= start) & (signal.t <= stop)).any():
            found.append(None)
            continue
        seen = "no reading while the arm is seen" if there.any() else f"blank in all of {len(there)} rows"
        found.append(Slip(f"{name}.csv", f"{sensor}_{unit}", seen, "readings on the pictures' clock", True))
    return found


def _far(specimen: Specimen, field: str, d: float, *, certain: bool) -> Slip | None:
    thickest = float(np.max(specimen.section.half_thickness(np.array([0.0, 1.0]))))
    most = max(FARTHEST[0] * thickest, FARTHEST[1] * specimen.length)
    if abs(d) <= most:
        return None
    seen = f"{d:g} m from the midline, of an arm that is {2e3 * thickest:.3g} mm thick at most"
    remedy = f"metres along the normal, within {most:.3g} (are these millimetres, or a place along the arm?)"
    return Slip("recording.toml", field, seen, remedy, certain)


def _rate_slip(acceleration: AccelerationSignal, k: int) -> Slip | None:
    t = acceleration.t[np.isfinite(acceleration.values[:, k])]
    interval = float(np.median(np.diff(t))) if len(t) > 1 else 0.0
    if interval <= RAREST_READING:
        return None
    seen = f"a reading every {interval:.3g} s ({1.0 / interval:.3g} Hz)"
    field = f"t_s, {acceleration.names[k]}_m_s2"
    remedy = f"one every {RAREST_READING:g} s at least: 50 Hz or more"
    return Slip("acceleration.csv", field, seen, remedy, True)


def _strain_slip(arm: SeenArm, strain: StrainSignal, k: int, length: float) -> Slip | None:
    gauge, values = strain.gauges[k], strain.values[:, k]
    there = np.isfinite(values)
    t = strain.t[there]
    within = (arm.t >= t[0]) & (arm.t <= t[-1])
    wanted, read = gauge.d / length * arm.bend(gauge.s)[within], np.interp(arm.t[within], t, values[there])
    ratio = _ratio(wanted, read, ROUGHLY)
    if ratio is None or AS_STRAINED[0] < ratio < AS_STRAINED[1]:
        return None
    seen = f"d times the curvature that the pictures show varies {ratio:.3g} times as much"
    field = f"{strain.names[k]}_strain"
    if -AS_STRAINED[1] < ratio < -AS_STRAINED[0]:
        remedy = "stretched is positive (its sign, or that of d, or that of the pictures' x?)"
        return Slip("strain.csv", field, seen, remedy, False)
    remedy = "a strain, 0.001 for 1000 microstrain, and its d in metres (another unit?)"
    return Slip("strain.csv", field, seen, remedy, not 1.0 / IMPOSSIBLE < abs(ratio) < IMPOSSIBLE)


def _acceleration_slips(
    recording: Recording, acceleration: AccelerationSignal, arm: SeenArm | None, travel: Travel | None
) -> list[Slip | None]:
    gravity = recording.declaration.gravity.magnitude
    compared: list[Compared | None] = []
    for one, values in zip(acceleration.accelerometers, acceleration.values.T, strict=True):
        there = np.isfinite(values)
        if arm is None:
            compared.append(_hanging(recording, one, values[there]))
        else:
            compared.append(_beside_pictures(recording, arm, travel, (one, acceleration.t[there], values[there])))
    axes = list(zip(acceleration.names, acceleration.accelerometers, compared, strict=True))
    for name, one, seen in axes:
        for other, partner, beside in axes:
            if (one.axis, partner.axis) != ("normal", "tangent") or (one.s, one.d) != (partner.s, partner.d):
                continue
            if seen is not None and beside is not None and _exchanged(seen, beside, gravity):
                words = f"{seen.words('normal')}; {other} {beside.words('tangent')}"
                remedy = f"the axis as it lies (those of {name} and {other} exchanged?)"
                return [Slip("recording.toml", f"acceleration.{name}.axis", words, remedy, True)]
    known = [seen for seen in compared if seen is not None]
    in_g = any(seen.within(AS_IN_G) for seen in known) and not any(seen.within(AS_LARGE) for seen in known)
    return [None if seen is None else _axis_slip((name, one.axis), seen, gravity, in_g) for name, one, seen in axes]


def _exchanged(normal: Compared, tangent: Compared, gravity: float) -> bool:
    """Whether each reads what the other should, up to signs, and not what it should itself."""
    apart = abs(abs(normal.wanted) - abs(tangent.wanted)) > HALF * gravity
    wrong = all(abs(one.read - one.wanted) > HALF * gravity for one in (normal, tangent))
    misses = (abs(normal.read) - abs(tangent.wanted), abs(tangent.read) - abs(normal.wanted))
    tared = max(normal, tangent, key=lambda one: abs(one.read)).tared
    return apart and wrong and not tared and max(map(abs, misses)) < QUARTER * gravity


def _axis_slip(axis: tuple[str, str], seen: Compared, gravity: float, in_g: bool) -> Slip | None:
    """What the mean says, and what the variation says where the mean says nothing; axis: its name and what it is.

    in_g: whether axes vary as readings in g do, and none as one in m/s^2.
    """
    file, field, words = "acceleration.csv", f"{axis[0]}_m_s2", seen.words(axis[1])
    sign = "the specific force, acceleration minus gravity (its sign, or gravity.angle_rad?)"
    unit = "m/s^2 (are these g? then multiply by 9.80665)"
    if abs(seen.wanted) > HALF * gravity > 0.0:
        if abs(seen.read + seen.wanted) < QUARTER * abs(seen.wanted):
            return Slip(file, field, words, sign, not seen.within(AS_LARGE) and not seen.tared)
        if abs(seen.read - seen.wanted / STANDARD_GRAVITY) < IN_G * abs(seen.wanted) and not seen.within(AS_LARGE):
            return Slip(file, field, words, unit, in_g)
    if abs(seen.read - seen.wanted) > HALF * gravity > 0.0:
        remedy = "the specific force along its axis (another axis, another gravity.angle_rad, or gravity taken out?)"
        return Slip(file, field, words, remedy, False)
    if seen.within(AS_IN_G):
        return Slip(file, field, words, unit, False)
    if seen.within((-AS_LARGE[1], -AS_LARGE[0])):
        return Slip(file, field, words, "the sign of its axis (or that of the pictures' x)", False)
    return None


def _hanging(recording: Recording, one: Accelerometer, values: Array) -> Compared | None:
    """Of an arm in a film that is not tracked: what an arm reads that hangs; None where it may not hang."""
    declaration, motor = recording.declaration, recording.motor
    leans = abs(declaration.gravity.angle) > HANGS or (motor is not None and abs(float(motor.angle.mean())) > HANGS)
    if leans or declaration.fluid.density >= declaration.specimen.density or len(values) < FEWEST_FRAMES:
        return None
    wanted = 0.0 if one.axis == "normal" else -declaration.gravity.magnitude
    return Compared(wanted, float(values.mean()), None, _at_ends(values))


def _beside_pictures(
    recording: Recording, arm: SeenArm, travel: Travel | None, read: tuple[Accelerometer, Array, Array]
) -> Compared | None:
    """What an axis should read by the pictures; read: the axis, its times (N,) and readings (N,).

    A second difference over h is the acceleration's mean over 2 h with triangular weights. So is what is compared.
    """
    one, times, values = read
    step = max(1, round(DIFFERENCE_TIME / float(np.median(np.diff(arm.t)))))
    middle = slice(step, -step)
    if len(arm.t) < 2 * step + FEWEST_FRAMES or len(times) < FEWEST_FRAMES:
        return None
    before, t, after = arm.t[: -2 * step], arm.t[middle], arm.t[2 * step :]
    h = 0.5 * (after - before)
    keep = _even(before, t, after) & _covered(times, t, h)
    if keep.sum() < FEWEST_FRAMES:
        return None
    place = arm.place(one.s)
    moved = (place[2 * step :] - 2.0 * place[middle] + place[: -2 * step]) / h[:, None] ** 2
    gravity = recording.declaration.gravity
    moved -= gravity.magnitude * np.array([np.sin(gravity.angle), np.cos(gravity.angle)])
    if travel is not None:
        moved += travel(t)[4:6].T
    phi = arm.direction(one.s)[middle]
    if one.axis == "normal":
        axis = np.stack([np.cos(phi), np.sin(phi)], axis=1)
    else:
        axis = np.stack([-np.sin(phi), np.cos(phi)], axis=1)
    twice = CubicSpline(times, values).antiderivative(2)
    mean = ((twice(t + h) - 2.0 * twice(t) + twice(t - h)) / h**2)[keep]
    wanted = np.sum(moved * axis, axis=1)[keep]
    return Compared(float(wanted.mean()), float(mean.mean()), _ratio(wanted, mean), _at_ends(mean))


def _at_ends(values: Array) -> float:
    tenth = max(1, len(values) // 10)
    return min(abs(float(values[:tenth].mean())), abs(float(values[-tenth:].mean())))


def _even(before: Array, t: Array, after: Array) -> NDArray[np.bool_]:
    """Where the three pictures of a difference stand evenly and near each other."""
    h = 0.5 * (after - before)
    return (np.abs(t - before - h) < 0.1 * h) & (h < 4.0 * DIFFERENCE_TIME)


def _covered(times: Array, t: Array, h: Array) -> NDArray[np.bool_]:
    """Where readings stand all around t (T,), within h (T,)."""
    longest = np.append(np.diff(times), 0.0)
    first, last = np.searchsorted(times, t - h, side="right") - 1, np.searchsorted(times, t + h)
    inside = (first >= 0) & (last < len(times))
    gap = 3.0 * float(np.median(np.diff(times)))
    jumps = np.append(0, np.cumsum(longest > gap))
    return inside & (jumps[np.clip(last, 0, len(times))] == jumps[np.clip(first, 0, len(times))])


def _ratio(wanted: Array, read: Array, alike: float = ALIKE) -> float | None:
    """How many times as much `wanted` varies as `read`, where both vary alike or opposite; None where not.

    The pictures' noise is in `wanted` alone, so that it does not bias the ratio.
    """
    if len(wanted) < FEWEST_FRAMES or not (np.ptp(wanted) > 0.0 and np.ptp(read) > 0.0):
        return None
    if abs(float(np.corrcoef(wanted, read)[0, 1])) < alike:
        return None
    return float(np.polyfit(read - read.mean(), wanted, 1)[0])

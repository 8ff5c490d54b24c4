"""Sensors on random arms: sound ones are never refused, and what is wrong with others is seen as often as stated."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from affine_model.acceleration_beside import gravity_of
from affine_model.arm import arm_of, neutral_parameters, parameter_index
from affine_model.base_signal import Steps, base_table
from affine_model.curvature import midline
from affine_model.simulate import Batch, Timing, simulate
from inference.appearance import Appearance
from inference.interpolate import at_times
from inference.run_motion import motion_at
from inference.sensor import AccelerometerAxis, Gauge
from tentacle.model import Model
from tentacle.recording import Declaration, Recording
from tentacle.sensor_slips import sensor_slips
from tentacle.signals import (
    AccelerationSignal,
    Accelerometer,
    Array,
    Markers,
    Midline,
    MotorSignal,
    StrainGauge,
    StrainSignal,
)
from tentacle.specimen import AIR, WATER, Cone, Gravity, Specimen
from tentacle.waveform import Multisine, Ramped

ARMS = 400
STEP, SECONDS = 1.0 / 600.0, 6.0
G = 9.80665
S = np.linspace(0.0, 1.0, 21)


@dataclass(frozen=True)
class Seen:
    """Coordinates q (T, n, 1) and the base's angle theta (T, 1) [rad] at some times."""

    q: Array
    theta: Array


def seen_at(batch: Batch, times: Array) -> Seen:
    q, theta = (
        at_times(batch.t, x, rate, times[:, None])
        for x, rate in ((batch.q, batch.q_rate), (batch.theta[:, None], batch.theta_rate[:, None]))
    )
    return Seen(q, theta[:, 0])


def declared(random: np.random.Generator) -> tuple[Declaration, float]:
    """An arm of 100 to 350 mm that hangs, lies or stands, and a modulus with which its weight bends it little."""
    length, radius = random.uniform(0.1, 0.35), random.uniform(0.004, 0.015)
    specimen = Specimen(Cone(radius, radius * random.uniform(0.1, 1.0)), length, 1070.0)
    fluid = WATER if random.random() < 0.5 else AIR
    angle = float(random.choice([0.0, 0.0, 0.2, np.pi / 2, -np.pi / 2, np.pi, 0.8]))
    bends = specimen.mass * G * length**2 / (2.0 * float(specimen.section.second_moment(0.0)))
    modulus = bends * random.uniform(2.0, 20.0) * (1.0 if angle == 0.0 else 3.0)
    return Declaration(specimen, fluid, Gravity(angle)), float(np.clip(modulus, 5e4, 5e7))


def run_of(declaration: Declaration, modulus: float, random: np.random.Generator) -> tuple[Recording, Batch, Array]:
    """The arm's run under three sines, without its pictures, and the parameters."""
    parameters = neutral_parameters()
    material = {("elasticity", "E"): modulus, ("damping", "eta"): 0.01 * modulus, ("drag", "C_perp"): 1.1}
    for key, value in material.items():
        parameters[parameter_index(*key)] = value
    sizes = random.uniform(0.05, 0.9) * random.dirichlet([1.0, 1.0, 1.0])
    frequencies, phases = np.sort(random.uniform(0.2, 2.5, 3)), random.uniform(0.0, 6.0, 3)
    wave = Ramped(Multisine(tuple(sizes), tuple(frequencies), tuple(phases)), 1.0)
    base = base_table(wave, Steps(0.0, STEP, round(SECONDS / STEP)), parameters[:, None])
    arm = arm_of(Model(declaration.specimen, declaration.fluid, declaration.gravity, order=3))
    batch = simulate(arm, parameters[:, None], base, Timing(STEP, 2))
    theta = wave(batch.t)[0]
    return Recording("random", declaration, motor=MotorSignal(batch.t, theta, theta)), batch, parameters


def drawn(seed: int) -> Recording:
    """A random arm with pictures, both axes of an accelerometer with a zero of up to 1 m/s^2, and a gauge."""
    random = np.random.default_rng(seed)
    declaration, modulus = declared(random)
    recording, batch, parameters = run_of(declaration, modulus, random)
    specimen = declaration.specimen
    length, radius = specimen.length, float(specimen.section.half_thickness(0.0))
    read_at = np.arange(0.02, SECONDS - 0.05, 1.0 / random.choice([55, 100, 240, 1000]))
    frames = np.arange(0.0, SECONDS - 0.01, 1.0 / random.choice([10, 15, 30, 60, 120]))
    s, d = float(random.choice([0.3, 0.6, 1.0])), float(random.choice([0.0, 0.0, radius, -radius]))
    axes = (Accelerometer(s, d, "normal"), Accelerometer(s, d, "tangent"))
    there = seen_at(batch, read_at)
    arm = arm_of(Model(specimen, declaration.fluid, declaration.gravity, order=3))
    pull = gravity_of(arm, parameters[:, None])[None]
    shown = replace(Appearance.as_declared(there.q, there.theta), motion=motion_at(arm, batch, read_at[:, None], pull))
    felt = np.stack([AccelerometerAxis("a", 1.0, axis).read(shown, length)[:, 0] for axis in axes], axis=1)
    felt = felt + random.uniform(-1.0, 1.0, 2) + 0.05 * random.standard_normal(felt.shape)
    gauge = StrainGauge(float(random.choice([0.2, 0.5])), radius if random.random() < 0.5 else -radius)
    strain = Gauge("g", 1.0, gauge).read(shown, length) + random.uniform(-0.1, 0.1)
    strain = strain + 1e-4 * random.standard_normal(strain.shape)
    pictured, noise = seen_at(batch, frames), float(random.choice([1e-4, 5e-4, 1e-3, 2e-3]))
    xy = midline(pictured.q[:, :, 0], pictured.theta[:, 0], length, S)
    xy = xy + noise * random.standard_normal(xy.shape)
    at = ([], [20], [7, 14, 20])[random.integers(3)]
    names = tuple(f"m{k}" for k in at)
    return replace(
        recording,
        midline=None if at else Midline(frames, S, xy, np.full(xy.shape[:2], noise)),
        markers=Markers(frames, names, S[at], np.zeros(len(at)), xy[:, at]) if at else None,
        acceleration=AccelerationSignal(read_at, ("n", "t"), axes, felt),
        strain=StrainSignal(read_at, ("g",), (gauge,), strain),
    )


def felt(change: Callable[[Array], Array]) -> Callable[[Recording], Recording]:
    def changed(recording: Recording) -> Recording:
        read = recording.acceleration
        assert read is not None
        return replace(recording, acceleration=replace(read, values=change(read.values)))

    return changed


def stretched(factor: float) -> Callable[[Recording], Recording]:
    def changed(recording: Recording) -> Recording:
        read = recording.strain
        assert read is not None
        return replace(recording, strain=replace(read, values=factor * read.values))

    return changed


WAYS: dict[str, Callable[[Recording], Recording]] = {
    "sound": lambda recording: recording,
    "zero at rest": felt(lambda values: values - values[:20].mean(axis=0)),
    "zero on average": felt(lambda values: values - values.mean(axis=0)),
    "in g": felt(lambda values: values / G),
    "wrong signs": felt(lambda values: -values),
    "exchanged": felt(lambda values: values[:, ::-1]),
    "permille": stretched(1e3),
    "strain's sign": stretched(-1.0),
}


def word(recording: Recording) -> str:
    found = [slip for slip in sensor_slips(recording, None) if slip is not None]
    return "refused" if any(slip.certain for slip in found) else "advised" if found else "passed"


@pytest.mark.long
def test_sound_sensors_pass_and_slips_are_seen() -> None:
    tally = {way: Counter[str]() for way in WAYS}
    hanging = {way: Counter[str]() for way in WAYS}
    for seed in range(ARMS):
        recording = drawn(seed)
        for way, change in WAYS.items():
            said = word(change(recording))
            tally[way][said] += 1
            hanging[way][said] += abs(recording.declaration.gravity.angle) < 0.3
    count = sum(hanging["sound"].values())
    assert tally["sound"] == {"passed": ARMS}
    assert not tally["zero at rest"]["refused"]
    assert not tally["zero on average"]["refused"]
    assert hanging["wrong signs"]["refused"] == hanging["exchanged"]["refused"] == count > 100
    assert not hanging["in g"]["passed"]
    assert hanging["in g"]["refused"] > 0.6 * count
    # The others' pictures are too noisy for the bend, or the arm hardly bends.
    assert tally["permille"]["refused"] + tally["permille"]["advised"] > 0.5 * ARMS
    assert tally["strain's sign"]["advised"] > 0.5 * ARMS
    assert not tally["strain's sign"]["refused"]

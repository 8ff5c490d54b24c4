"""Recordings made by the reduced model itself, with white noise: there the truth is in the model."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import arm_of, neutral_parameters, parameter_index
from affine_model.base_signal import Servo, Steps, base_table
from affine_model.curvature import midline
from affine_model.simulate import Timing, simulate
from inference.base_fit import Setting, fit_base
from inference.judged_fit import JudgedFit, judged_fit
from inference.prepare import prepare
from tentacle.model import Model
from tentacle.recording import Declaration, Recording
from tentacle.signals import Markers, Midline, MotorSignal
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Multisine, Ramped

SPECIMEN = Specimen(Cone(0.0125, 0.005), 0.14, 1070.0)
WAVE = Ramped(Multisine((0.2, 0.15, 0.1), (0.4, 1.1, 1.9), (0.0, 1.0, 2.0)), 1.0)
TRUTH = {("elasticity", "E"): 2e5, ("damping", "eta"): 1.5e3, ("drag", "C_perp"): 1.1}
FPS = 60
S = np.linspace(0.0, 1.0, 21)
STEP = 1.0 / 600.0


def record(hidden=None, *, seconds=8.0, noise=1e-4, order=2, seed=0, wave=WAVE) -> Recording:
    """A recording of the reduced model with these base parameters and hidden effects (effect, parameter) -> value."""
    arm = arm_of(Model(SPECIMEN, WATER, order=order))
    parameters = neutral_parameters()
    for (effect, parameter), value in {**TRUTH, **(hidden or {})}.items():
        parameters[parameter_index(effect, parameter)] = value
    steps = round(seconds / STEP)
    base = base_table(wave, Steps(0.0, STEP, steps), Servo.of(parameters[:, None]))
    batch = simulate(arm, parameters[:, None], base, Timing(STEP, round(1.0 / STEP / FPS)))
    theta = wave(batch.t)[0]  # as commanded
    points = midline(batch.q[:, :, 0], batch.theta[:, 0], SPECIMEN.length, S)
    points = points + noise * np.random.default_rng(seed).standard_normal(points.shape)
    seen = Midline(batch.t, S, points, np.full(points.shape[:2], noise))
    return Recording("made", Declaration(SPECIMEN, WATER), motor=MotorSignal(batch.t, theta, theta), midline=seen)


@pytest.fixture(scope="session")
def recorded() -> Callable[..., Recording]:
    """record(), as a fixture."""
    return record


def as_markers(recording: Recording, places: tuple[float, ...] = (0.6, 0.8, 1.0)) -> Recording:
    """The same run seen at single markers on the axis (places of S)."""
    midline = recording.midline
    assert midline is not None
    at = np.searchsorted(S, np.array(places) - 1e-9)
    names = tuple(f"m{k}" for k in range(len(places)))
    seen = Markers(midline.t, names, S[at], np.zeros(len(places)), midline.xy[:, at])
    return replace(recording, midline=None, markers=seen)


def base_of(recording: Recording) -> JudgedFit:
    """The declared model's fit to a recording, judged."""
    setting = Setting(recording.declaration, (prepare(recording, hold_out=True).experiment,), 2)
    return judged_fit(*fit_base(setting, 2))


@pytest.fixture(scope="session")
def plain(recorded) -> JudgedFit:
    """The base hypothesis of a recording in which nothing is hidden."""
    return base_of(recorded())


@pytest.fixture(scope="session")
def with_current(recorded) -> JudgedFit:
    """The base hypothesis of a recording with a steady current of 30 mm/s across the arm."""
    return base_of(recorded({("current", "U_x"): 0.03}))


@pytest.fixture(scope="session")
def without_motion(recorded) -> Recording:
    """A recording whose arm hangs still."""
    recording = recorded(seconds=2.0)
    still = np.repeat(recording.midline.xy[:1], recording.midline.t.size, axis=0)
    still = still + 1e-4 * np.random.default_rng(1).standard_normal(still.shape)
    zero = np.zeros_like(recording.motor.t)
    return replace(
        recording, midline=replace(recording.midline, xy=still), motor=MotorSignal(recording.motor.t, zero, zero)
    )

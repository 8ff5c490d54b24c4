"""Recordings made by the reduced model itself, with white noise: there the truth is in the model."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest

from affine_model.arm import arm_of, neutral_parameters, parameter_index
from affine_model.base_signal import Steps, base_table
from affine_model.curvature import midline
from affine_model.simulate import Timing, simulate
from inference.base_fit import Setting, fit_base
from inference.judged_fit import JudgedFit, judged_fit
from inference.prepare import prepare
from tentacle.model import Model
from tentacle.recording import Declaration, Recording
from tentacle.signals import Markers, Midline, MotorSignal
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Multisine, Ramped, Waveform

SPECIMEN = Specimen(Cone(0.0125, 0.005), 0.14, 1070.0)
WAVE = Ramped(Multisine((0.2, 0.15, 0.1), (0.4, 1.1, 1.9), (0.0, 1.0, 2.0)), 1.0)
TRUTH = {("elasticity", "E"): 2e5, ("damping", "eta"): 1.5e3, ("drag", "C_perp"): 1.1}
FPS = 60
S = np.linspace(0.0, 1.0, 21)
STEP = 1.0 / 600.0


@dataclass(frozen=True)
class Run:
    """How long [s], under which motion of the base, with how many coordinates; noise [m] of a point, and its seed."""

    seconds: float = 8.0
    noise: float = 1e-4
    order: int = 2
    seed: int = 0
    wave: Waveform = WAVE


def record(hidden=None, **run) -> Recording:
    """A Recording of the reduced model with these base parameters and hidden effects (effect, parameter) -> value.

    run: fields of Run.
    """
    return record_declared(Declaration(SPECIMEN, WATER), hidden or {}, Run(**run))


def record_declared(declaration: Declaration, hidden: Mapping[tuple[str, str], float], run: Run) -> Recording:
    """The same of an arm that is as declared."""
    arm = arm_of(Model(declaration.specimen, declaration.fluid, declaration.gravity, order=run.order))
    parameters = neutral_parameters()
    for (effect, parameter), value in {**TRUTH, **hidden}.items():
        parameters[parameter_index(effect, parameter)] = value
    steps = round(run.seconds / STEP)
    base = base_table(run.wave, Steps(0.0, STEP, steps), parameters[:, None])
    batch = simulate(arm, parameters[:, None], base, Timing(STEP, round(1.0 / STEP / FPS)))
    theta = run.wave(batch.t)[0]  # as commanded
    q = batch.q[:, :, 0]
    points = midline(q, batch.theta[:, 0] + arm.root_turn(q, 1), arm.specimen.length, S)
    points = points + run.noise * np.random.default_rng(run.seed).standard_normal(points.shape)
    seen = Midline(batch.t, S, points, np.full(points.shape[:2], run.noise))
    return Recording("made", declaration, motor=MotorSignal(batch.t, theta, theta), midline=seen)


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

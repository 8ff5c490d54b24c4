"""Recordings of one arm over months, short and cheap, with an effect hidden in some of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from affine_model.curvature import midline
from affine_model.from_model import simulate_model
from affine_model.simulate import Timing
from discovery.library.evidence import RecordingEvidence
from tentacle.model import Estimate, Model
from tentacle.recording import Declaration, Recording
from tentacle.signals import Array, Midline, MotorSignal
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Chirp, Multisine, Ramped, Sine

SPECIMEN = Specimen(Cone(0.0125, 0.005), 0.14, 1070.0)
TRUTH = {("elasticity", "E"): 2e5, ("damping", "eta"): 1.5e3, ("drag", "C_perp"): 1.1}
BY_RECORDING = {"elasticity": 0.01, "damping": 0.05, "drag": 0.03}  # relative spread, as a diagnosis allows
DRIFT = -0.04  # relative change of E over the library
FPS, SECONDS, NOISE, POINTS = 30, 4.0, 1e-4, 21
MOTIONS = (
    Ramped(Multisine((0.2, 0.15, 0.1), (0.4, 1.1, 1.9), (0.0, 1.0, 2.0)), 1.0),
    Ramped(Sine(0.35, 1.1), 1.0),
    Ramped(Chirp(0.3, 0.3, 2.0, SECONDS), 1.0),
)
# An effect, the strength that is hidden, and its shapes
HIDDEN: tuple[tuple[str, str, dict[str, float]], ...] = (
    ("current", "U_x", {}),
    ("gravity_tilt", "tilt", {}),
    ("tip_mass", "mass", {"reach": 0.0, "drop": 0.0}),
    ("buoyancy", "density_error", {}),
    ("cubic_stiffness", "beta", {}),
    ("linear_drag", "c_n", {}),
    ("servo_lag", "tau", {"period": 0.0}),
    ("stiffness_drift", "rate", {"settling": 0.0}),
    ("viscoelasticity", "g", {"tau": 0.3}),
    ("added_mass", "C_a", {"convective": 1.0, "tangential": 0.0}),
)


@dataclass(frozen=True)
class Made:
    """One recording: its place in the library 0 .. 1, its motion's place in MOTIONS, its seed."""

    place: float
    motion: int
    seed: int


def made(of: Made, hidden: dict[str, dict[str, float]]) -> Recording:
    """The recording, with hidden effects as effect -> parameter -> value."""
    random = np.random.default_rng(of.seed)
    values: dict[str, dict[str, float]] = {}
    for value, (effect, name) in _parameters(of, random):
        values.setdefault(effect, {})[name] = value
    values |= hidden
    exact = {effect: {n: Estimate.exact(v) for n, v in held.items()} for effect, held in values.items()}
    wave, s = MOTIONS[of.motion], np.linspace(0.0, 1.0, POINTS)
    run = simulate_model(Model(SPECIMEN, WATER, parameters=exact), wave, SECONDS, timing=Timing(1 / 600, 600 // FPS))
    xy = midline(run.q[:, :, 0], run.theta[:, 0], SPECIMEN.length, s)
    seen = Midline(run.t, s, xy + NOISE * random.standard_normal(xy.shape), np.full(xy.shape[:2], NOISE))
    theta = wave(run.t)[0]
    return Recording(
        f"run {of.seed}", Declaration(SPECIMEN, WATER), motor=MotorSignal(run.t, theta, theta), midline=seen
    )


def drawn(reference: RecordingEvidence, of: Made, column: int, strength: float) -> RecordingEvidence:
    """A recording's evidence in the reference's own linear model, r = e - J dx - S g: the noise e is white there.

    dx: from the reference's fit to this recording's parameters; g: the strength [of its scale] of one column of roots.
    """
    random, count = np.random.default_rng(of.seed), len(reference.free)
    truth = np.array([value for value, _ in _parameters(of, random)])
    shift = np.zeros(reference.scale.size)
    shift[:count] = (truth - reference.centre) / reference.scale[:count]
    shift[column] += strength
    roots = reference.roots.copy()
    for root in roots:
        noise = random.standard_normal(root.shape[0])
        root[:, -1] = noise - root[:, :-1] @ shift
    return replace(reference, roots=roots)


def _parameters(of: Made, random: np.random.Generator) -> list[tuple[float, tuple[str, str]]]:
    """The arm's parameters in a recording, in the order of TRUTH."""
    found = []
    for (effect, name), value in TRUTH.items():
        drift = 1.0 + DRIFT * of.place if effect == "elasticity" else 1.0
        found.append((value * drift * (1.0 + BY_RECORDING[effect] * float(random.standard_normal())), (effect, name)))
    return found


def strength_of(reference: RecordingEvidence, hidden: tuple[str, str, dict[str, float]], R: float) -> float:
    """The strength that leaves R [noise sigmas] rms in the reference's data, after a refit of the arm's parameters."""
    effect, parameter, shapes = hidden
    place = len(reference.free) + reference.columns.index((effect, parameter, tuple(shapes.values())))
    left = alone(reference.noise_root, len(reference.free), place)
    return R * float(np.sqrt(reference.data)) / left * float(reference.scale[place])


def alone(root: Array, count: int, place: int) -> float:
    """Norm of a column of a root without what the first `count` columns can absorb."""
    basis, _ = np.linalg.qr(root[:, :count])
    column: Any = root[:, place]
    return float(np.linalg.norm(column - basis @ (basis.T @ column)))

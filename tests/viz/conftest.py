"""A diagnosis and its recordings, made up in closed form: what the room is tried on without any other room."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from tentacle.diagnosis import Diagnosis, ErrorBudget, ErrorMeasure, RankedEffect, RunComparison
from tentacle.model import Estimate, Model
from tentacle.recording import Camera, Declaration, Recording
from tentacle.signals import LoadCellSignal, Midline, MotorSignal, ShapeTrack, Video
from tentacle.specimen import WATER, Cone, Specimen

ARM = Specimen(Cone(0.0125, 0.001), 0.14, 1070.0)
CAMERA = Camera(30.0, 0.0008, (320.0, 40.0), (0.0, 1.0))


@dataclass(frozen=True)
class Case:
    diagnosis: Diagnosis
    recordings: list[Recording]


def midline(theta: np.ndarray, q: np.ndarray, s: np.ndarray, length: float) -> np.ndarray:
    """(T, P, 2) [m] of phi = theta + q1 s + q2 s^2 / 2, by the trapezium rule."""
    phi = theta[:, None] + q[:, :1] * s + q[:, 1:] * s**2 / 2
    tangent = np.stack([-np.sin(phi), np.cos(phi)], -1)
    steps = 0.5 * (tangent[:, 1:] + tangent[:, :-1]) * np.diff(s)[:, None]
    return length * np.concatenate([np.zeros((len(theta), 1, 2)), np.cumsum(steps, axis=1)], axis=1)


def make_video(path: Path, xy: np.ndarray, frame_rate: float) -> Path:
    import cv2

    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), frame_rate, (640, 360))
    for line in CAMERA.to_pixels(xy):
        picture = np.full((360, 640, 3), 205, np.uint8)
        for k, (a, b) in enumerate(pairwise(line)):
            width = max(2, round(30 * (1 - k / (len(line) - 1))))
            cv2.line(picture, tuple(map(int, a.round())), tuple(map(int, b.round())), (60, 50, 50), width)
        writer.write(picture)
    writer.release()
    return path


def make_run(name: str, duration: float, seed: int, folder: Path | None) -> tuple[RunComparison, Recording]:
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, duration, 1 / 30)
    s = np.linspace(0.0, 1.0, 41)
    theta = 0.35 * np.sin(2 * np.pi * 0.6 * t)
    truth = np.stack([0.6 * np.sin(2 * np.pi * 0.6 * t - 0.8), -0.5 * np.sin(2 * np.pi * 0.6 * t - 1.1)], -1)
    truth += [0.25, 0.1]  # the steady bend that a current makes
    base, augmented = truth - [0.25, 0.1], truth + 0.004 * rng.standard_normal(truth.shape)
    xy = midline(theta, truth, s, ARM.length)
    measured = xy + 1.5e-4 * rng.standard_normal(xy.shape)
    measured[20:24] = np.nan
    accepted = np.ones(len(t), bool)
    accepted[20:24] = False
    coefficients = np.column_stack([np.zeros(len(t)), truth])
    coefficients[~accepted] = np.nan
    covariance = np.tile(np.diag([1e-6, 4e-4, 3e-3]), (len(t), 1, 1))
    reason = tuple("" if good else "outline and picture disagree" for good in accepted)
    shape = ShapeTrack(t, coefficients, covariance, accepted, reason, 1.0, 0.001, np.zeros(2))
    base_xy, augmented_xy = (midline(theta, q, s, ARM.length) for q in (base, augmented))
    run = RunComparison(
        name, t, s, measured, base_xy, augmented_xy,
        np.where(accepted[:, None], truth, np.nan), base, augmented, t > 2 / 3 * duration, theta,
        thrust_base=0.02 * np.sin(2 * np.pi * 1.2 * t), thrust_augmented=0.01 + 0.02 * np.sin(2 * np.pi * 1.2 * t),
        drag_base=-0.3 * np.gradient(base_xy, 1 / 30, axis=0),
        drag_augmented=-0.3 * np.gradient(augmented_xy, 1 / 30, axis=0),
    )  # fmt: skip
    video = None if folder is None else Video(make_video(folder / f"{name.replace(' ', '_')}.mp4", xy, 30.0))
    load_t = np.arange(0.0, duration, 1 / 80)
    load = 0.01 + 0.02 * np.sin(2 * np.pi * 1.2 * load_t) + 0.002 * rng.standard_normal(len(load_t))
    recording = Recording(
        name, Declaration(ARM, WATER, camera=CAMERA), motor=MotorSignal(t, theta, theta),
        load_cell=LoadCellSignal(load_t, load), midline=Midline(t, s, measured, np.full(measured.shape[:2], 1.5e-4)),
        video=video, shape=shape,
    )  # fmt: skip
    return run, recording


def make_case(duration: float, folder: Path | None, names: tuple[str, ...] = ("chirp 1", "gait: trial/2")) -> Case:
    pairs = [make_run(name, duration, seed, folder if seed == 0 else None) for seed, name in enumerate(names)]
    model = Model(ARM, WATER, parameters={
        "elasticity": {"E": Estimate(2.1e5, 2.0e5, 2.2e5, "Pa")},
        "damping": {"eta": Estimate(310.0, 280.0, 340.0, "Pa s")},
        "drag": {"C_perp": Estimate(1.2, 1.0, 1.4)},
    })  # fmt: skip
    speed = Estimate(0.052, 0.047, 0.058, "m/s")
    names17 = ("current", "gravity_tilt", "intrinsic_curvature", "added_mass", "tip_mass", "time_offset")
    cosines = np.eye(6)
    cosines[0, 1] = cosines[1, 0] = 0.90
    cosines[1, 2] = cosines[2, 1] = -0.995
    diagnosis = Diagnosis(
        "effect", ("current",), 0.93, {"current": {"speed": speed, "direction": Estimate(0.1, -0.2, 0.4, "rad")}},
        ErrorMeasure(10.52, 0.21, 0.26, 0.11, 0.012), ErrorMeasure(0.31, 0.006, 0.005, 0.012, 0.004),
        ErrorMeasure(0.21, 0.004, 0.003, 0.009, 0.003), True,
        tuple(RankedEffect(n, 4000.0 / (k * k + 1), 0.3 + k, p)
              for k, (n, p) in enumerate(zip(names17, (0.93, 0.04, 0.02, 0.01, 0, 0), strict=True))),
        {"kind": "multisine", "amplitudes": [0.3, 0.1], "frequencies": [0.4, 1.3], "phases": [0.0, 1.0]},
        ErrorBudget(0.15, 0.15, 10.4, 0.22), model, model.with_effect("current", speed=speed),
        names17, cosines, tuple(run for run, _ in pairs),
        ("The residual that remains grows towards the tip & is <0.3 mm.",), 7,
    )  # fmt: skip
    return Case(diagnosis, [recording for _, recording in pairs])


@pytest.fixture(scope="session")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return make_case(6.0, tmp_path_factory.mktemp("video"))

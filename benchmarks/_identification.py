"""Identification of a known arm from a noisy shape track: time of a fit, and coverage of its 95 % intervals."""

from __future__ import annotations

import time

import numpy as np

from affine_model.arm import parameter_index
from affine_model.simulate import Timing, simulate
from benchmarks._affine_arm import ARM, FREE, SPECIMEN, TRUTH, parameters
from inference.experiment import Experiment
from inference.fit import fit
from inference.measured_shapes import from_track
from inference.trajectory import Problem
from tentacle.signals import Array, ShapeTrack
from tentacle.waveform import Chirp

FIT_STEP = 1 / 1000  # s: its error moves the estimates by 0.1 of their standard error (at 1/500 by 0.4)


def recorded(seconds: float, fps: float, seed: int) -> tuple[Problem, tuple[Array, ...]]:
    """A video's shape track of the model's own motion with the vision's noise, and where a fit of it starts."""
    wave = Chirp(0.5, 0.3, 2.0, seconds)
    stride = 160
    h = 1.0 / (fps * stride)  # the truth's own error must be far below the fit's
    base = wave((np.arange(round(seconds / h)) + 0.5) * h)
    clean = simulate(ARM, parameters()[:, None], base[:, :, None], Timing(h, stride))
    sigma = np.array([1e-3, 1.7e-3, 6.0e-3])
    link = np.array([[1, 0, 0], [0, 1, -0.987], [0, -0.987, 1.0]])
    covariance = link * np.outer(sigma, sigma)
    noise = np.random.default_rng(seed).multivariate_normal(np.zeros(3), covariance, clean.t.size)
    coefficients = np.concatenate([np.zeros((clean.t.size, 1)), clean.q[:, :, 0]], axis=1) + noise
    track = ShapeTrack(
        clean.t, coefficients, np.tile(covariance, (clean.t.size, 1, 1)), np.ones(clean.t.size, bool),
        ("",) * clean.t.size, 1.0, 1e-3, np.zeros(2),
    )  # fmt: skip
    observation = from_track(track, wave(clean.t)[0], SPECIMEN.length)
    used = np.ones(clean.t.size, bool)
    gain = np.ones(observation.coefficients.shape[1])
    experiment = Experiment("own", observation, wave, 0.0, seconds, None, used, gain)
    given = parameters()
    for (effect, name), factor in zip(FREE, (0.7, 1.5, 0.8, 0.7), strict=True):
        given[parameter_index(effect, name)] *= factor
    nuisances = np.zeros(len(experiment.nuisance_names(ARM.order)))
    nuisances[: ARM.order] = ARM.from_monomial @ coefficients[0, 1:]
    return Problem(ARM, (experiment,), FREE, given, FIT_STEP), (nuisances,)


def identification(short: bool, figures: dict[str, float]) -> None:
    """Time of a fit of 39 s at 25 fps, and how often its 95 % intervals hold the truth."""
    problem, nuisances = recorded(8.0 if short else 39.0, 25.0, 0)
    fit(problem, nuisances)
    start = time.perf_counter()
    found = fit(problem, nuisances)
    figures["identify_s"] = time.perf_counter() - start
    print(f"identification: {figures['identify_s']:.2f} s, {found.evaluations} evaluations")
    for (effect, name), value, truth in zip(FREE, found.values, TRUTH, strict=True):
        print(f"  {effect}.{name} {value:.5g}, truth {truth:g}")
    inside, seeds = 0, 5 if short else 200
    for seed in range(seeds):
        found = fit(*recorded(12.0, 25.0, 100 + seed))
        away = np.abs(found.values - np.array(TRUTH)) / np.sqrt(np.diag(found.covariance))
        inside += int(np.sum(away < 1.96))
    figures["coverage_95"] = inside / (seeds * len(FREE))
    print(f"95 % intervals hold the truth in {figures['coverage_95']:.1%} of {seeds} x {len(FREE)}")

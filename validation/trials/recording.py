"""A blind trial like a recording: hidden effects get a detectable size, then the arm is simulated and measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from affine_model.curvature import Array, legendre_to_monomial
from inference.measured_shapes import Tracker, fit_shapes
from inference.observation import POSE
from mujoco_ref.influence import value
from mujoco_ref.undeclared.make import Noise, Scenario, make_recording
from tentacle.io.reading import read_recording
from tentacle.recording import Recording
from tentacle.signals import Markers
from validation.trials.design import Design
from validation.trials.likeness import declared_fit
from validation.trials.own_errors import OwnErrors, own_errors
from validation.trials.sight import EVERYWHERE, Measurement, track_noise, track_of
from validation.trials.sizing import sized, track_root

AXIS_STEP = 1e-3  # of the length: distance to either side of a marker of two places that give the axis' direction


def trial_recording(design: Design) -> tuple[Recording, dict[str, Any]]:
    """The recording, its name and declaration without a hint, and its sealed truth as plain data.

    InputError where the arm cannot follow the motion.
    """
    hidden, reached = sized(design, track_root(design) if design.sight.kind == "track" else None)
    recording, truth = recording_with(design, hidden)
    return recording, {"kind": design.kind, "r": reached, **truth}


def recording_with(design: Design, hidden: Mapping[str, Mapping[str, float]]) -> tuple[Recording, dict[str, Any]]:
    """The recording of a design with these parameters of hidden effects, and their truth.

    InputError where the arm cannot follow the motion.
    """
    model, sight = design.model(), design.sight
    recording, truth = make_recording(
        hidden,
        Scenario(
            model,
            design.waveform(),
            design.duration,
            design.fps,
            _places(sight),
            initial_q=None if design.initial_q is None else np.array(design.initial_q),
            release_t=design.release_t,
        ),
        design.seed,
        Noise(midline=sight.noise, angle=sight.angle_noise),
        name=f"trial_{design.index:04d}",
        clean_midline=sight.kind in ("track", "markers") or bool(design.errors_of),
    )
    random = np.random.default_rng([design.seed, 2])
    assert recording.midline is not None
    own = errors_of(design.errors_of).at(recording.midline.t) if design.errors_of else None
    if sight.kind == "track":
        recording = _tracked(recording, sight, random)
    elif sight.kind == "markers":
        excess = value(truth["effects"], "camera_scale", "excess")
        if own is None:
            own = sight.noise * random.standard_normal((recording.midline.t.size, len(sight.s), 2))
        recording = _marked(recording, sight, excess, own)
    else:
        if own is not None:
            recording = replace(recording, midline=replace(recording.midline, xy=recording.midline.xy + own))
        assert recording.midline is not None
        stated = np.nan if sight.stated is None else sight.stated
        sigma = np.full(recording.midline.sigma.shape, stated)
        recording = replace(recording, midline=replace(recording.midline, sigma=sigma))
    return recording, truth


def _places(sight: Measurement) -> Array:
    """Places on the reference's axis that are needed: for markers, on either side of each."""
    if sight.kind == "track":
        return np.array(EVERYWHERE)
    s = np.array(sight.s)
    return (
        np.concatenate([np.maximum(s - AXIS_STEP, 0.0), s, np.minimum(s + AXIS_STEP, 1.0)])
        if sight.kind == "markers"
        else s
    )


def _tracked(recording: Recording, sight: Measurement, random: np.random.Generator) -> Recording:
    """The same run as a track: shapes by the edges, with the noise that the tracker states, times its gain.

    The scale is one number of a recording, known to scale_sigma.
    """
    midline, order = recording.midline, len(sight.covariance) - 1
    assert midline is not None
    theta = np.zeros(midline.t.size) if recording.motor is None else recording.motor.command
    length = recording.declaration.specimen.length
    free = fit_shapes(midline, theta, length, order, Tracker(sight.noise))
    scale = float(np.exp(np.median(free.coefficients[:, 3])))
    seen = fit_shapes(replace(midline, xy=midline.xy / scale), theta, length, order, Tracker(sight.noise, True))
    q = seen.coefficients[:, POSE:] @ legendre_to_monomial(order).T
    coefficients = np.column_stack([seen.coefficients[:, 0], q]) + track_noise(sight, midline.t.size, random)
    measured = scale * (1.0 + (sight.scale_sigma or 0.0) * float(random.standard_normal()))
    return replace(recording, midline=None, shape=track_of(sight, midline.t, coefficients, measured))


@cache
def errors_of(path: str) -> OwnErrors:
    """The own errors of a recording, kept: one is fitted once in a process."""
    return own_errors(*declared_fit(read_recording(Path(path))))


def _marked(recording: Recording, sight: Measurement, excess: float, noise: Array) -> Recording:
    """The same run as markers seen by a camera; excess: relative error of the scale; noise (T, M, 2) [m]."""
    midline = recording.midline
    assert midline is not None
    before, at, after = np.split(midline.xy, 3, axis=1)
    along = (after - before) / np.linalg.norm(after - before, axis=2, keepdims=True)
    beside = (1.0 + excess) * np.array(sight.d)[:, None] * np.stack([along[..., 1], -along[..., 0]], axis=-1)
    xy = at + beside + noise
    names = tuple(f"m{k + 1}" for k in range(len(sight.s)))
    markers = Markers(midline.t, names, np.array(sight.s), np.array(sight.d), xy)
    return replace(recording, midline=None, markers=markers)

"""What the reduction alone loses: a reduced model's midline against the reference at the same parameters.

The reduced model's midline comes as an array: this room knows nothing of how it was computed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from mujoco_ref.simulate import DEFAULT_LINKS, simulate
from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.signals import Array
from tentacle.waveform import Waveform

MOST_FRAMES_PER_SECOND = 200.0  # enough for a spline through motions of a few Hz


@dataclass(frozen=True)
class ReductionError:
    """rms_mm over all points and instants; per_point_mm (P,) over time, per_frame_mm (T,) over points; reference (T,
    P, 2) [m]."""

    rms_mm: float
    per_point_mm: Array
    per_frame_mm: Array
    reference: Array


@dataclass(frozen=True)
class _From:
    """A waveform whose time begins at `start` [s]."""

    waveform: Waveform
    start: float

    def __call__(self, t: ArrayLike) -> Array:
        return self.waveform(np.asarray(t, dtype=float) + self.start)


def reduction_error(
    model: Model,
    base_motion: Waveform,
    t: Array,
    s: Array,
    midline: Array,
    *,
    initial_q: Array | None = None,
    initial_q_rate: Array | None = None,
    release_t: float | None = None,
    links: int = DEFAULT_LINKS,
) -> ReductionError:
    """Run the reference with the model's own parameters and hold the reduced model's midline against it.

    t (T,) [s] rising; s (P,); midline (T, P, 2) [m] of the reduced model, in the base frame. base_motion: theta(t)
    that both were given. initial_q, initial_q_rate (K,): state at t[0] in the paper's coordinates, as the reduced
    model had it (default: the equilibrium at rest). release_t [s] as in recording.toml. Raises InputError where shapes
    differ or t does not rise.
    """
    t = np.asarray(t, dtype=float)
    if midline.shape != (t.size, s.size, 2):
        expected = f"({t.size}, {s.size}, 2)"
        raise InputError(f"shape {midline.shape} does not fit", field="midline", expected=expected)
    if t.size < 2 or not np.all(np.diff(t) > 0.0):
        raise InputError("times must rise", field="t", expected="2 or more instants, in order")
    duration = float(t[-1] - t[0])
    fps = min(MOST_FRAMES_PER_SECOND, max(25.0, 2.0 * t.size / duration))
    run = simulate(
        model,
        _From(base_motion, float(t[0])),
        duration + 2.0 / fps,
        fps,
        links=links,
        s=s,
        initial_q=initial_q,
        initial_q_rate=initial_q_rate,
        release_t=None if release_t is None else max(0.0, release_t - float(t[0])),
    )
    reference = CubicSpline(run.t, run.midline.xy, axis=0)(t - t[0])
    squares = np.sum((midline - reference) ** 2, axis=2)
    return ReductionError(
        rms_mm=1e3 * float(np.sqrt(np.mean(squares))),
        per_point_mm=1e3 * np.sqrt(np.mean(squares, axis=0)),
        per_frame_mm=1e3 * np.sqrt(np.mean(squares, axis=1)),
        reference=reference,
    )

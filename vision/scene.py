"""Known motions to render: shapes q(t), base angle theta(t), and their midline by a separate quadrature."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_simpson

from tentacle.recording import Camera
from tentacle.signals import Array, Midline
from tentacle.specimen import Cone, Specimen

ARC_POINTS = 1601  # points along the arc in the quadrature; the error is below 1e-9 of the length


@dataclass(frozen=True)
class Scene:
    """What is rendered: t (T,) [s], theta (T,) and q (T, n) [rad], a constant base angle offset [rad], midline."""

    specimen: Specimen
    camera: Camera
    size: tuple[int, int]
    t: Array
    theta: Array
    q: Array
    offset: float
    midline: Midline


@dataclass(frozen=True)
class Swing:
    """order: curvature coordinates; amplitude of curvature [rad]; frequency [Hz] of the motor."""

    order: int = 2
    amplitude: float = 0.9
    frequency: float = 0.6


USUAL_SWING = Swing()
BASE_OFFSET = 0.01  # rad, of the base angle against the motor's
SCENE_TIP_RADIUS = 1.5e-3  # m


def exact_midline(t: Array, angle: Array, q: Array, length: float, points: int = 41) -> Midline:
    """Midline (T, points) of shapes q (T, n) on base angles angle (T,) [rad], by Simpson's rule (eq. 3)."""
    v = np.linspace(0.0, 1.0, ARC_POINTS)
    powers = np.array([v ** (j + 1) / (j + 1) for j in range(q.shape[1])])
    phi = angle[:, None] + q @ powers
    x = length * cumulative_simpson(-np.sin(phi), x=v, axis=1, initial=0)
    y = length * cumulative_simpson(np.cos(phi), x=v, axis=1, initial=0)
    pick = np.linspace(0, ARC_POINTS - 1, points).astype(int)
    xy = np.stack([x[:, pick], y[:, pick]], axis=-1)
    return Midline(np.asarray(t, dtype=float), v[pick], xy, np.zeros(xy.shape[:2]))


def swaying(
    seed: int,
    frames: int = 60,
    fps: float = 60.0,
    size: tuple[int, int] = (1280, 720),
    swing: Swing = USUAL_SWING,
    exposure: float = 0.0,
) -> Scene:
    """A cone that a motor sways in a swing; phases by the seed."""
    rng = np.random.default_rng(seed)
    specimen = Specimen(Cone(0.0125, SCENE_TIP_RADIUS), length=0.14, density=1070.0)
    length_px = 0.66 * size[1]
    base = (0.5 * size[0] + rng.uniform(-3, 3), 0.14 * size[1] + rng.uniform(-3, 3))
    camera = Camera(fps, specimen.length / length_px, base_px=base, arm_px=(0.0, 1.0), exposure=exposure)
    t = np.arange(frames) / fps
    omega = 2.0 * np.pi * swing.frequency
    theta = 0.5 * np.sin(omega * t + rng.uniform(0, 2 * np.pi))
    sizes = swing.amplitude * np.array([1.0, 0.8, 0.5, 0.4, 0.3])[: swing.order]
    phases = rng.uniform(0.0, 2.0 * np.pi, (2, swing.order))
    q = sizes * (np.sin(omega * t[:, None] + phases[0]) + 0.3 * np.sin(2.0 * omega * t[:, None] + phases[1]))
    midline = exact_midline(t, theta + BASE_OFFSET, q, specimen.length)
    return Scene(specimen, camera, size, t, theta, q, BASE_OFFSET, midline)

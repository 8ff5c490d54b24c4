"""Both models of one arm under one base motion, from the same start, for `compare` and `reproduce`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from affine_model.simulate import Start, Timing

if TYPE_CHECKING:
    from tentacle.model import Model
    from tentacle.signals import Array
    from tentacle.waveform import Waveform

AFFINE_STEP = 2e-3  # s; halving it moves mean thrust by less than 1e-3
S = np.linspace(0.0, 1.0, 41)


@dataclass(frozen=True)
class Twin:
    """One model's motion: t (T,) [s], theta (T,) [rad], xy (T, 41, 2) [m], q (T, 2) [rad], load (T,) [N] at the base
    along +y.

    q: the two coordinates nearest to the angle along the arm (eq. 2), for any number of coordinates of the model. load
    is counted from its reading at rest; over whole periods its mean is the mean thrust (eq. 17).
    """

    t: Array
    theta: Array
    xy: Array
    q: Array
    load: Array

    def mean_load(self, window: float) -> float:
        """Mean load over the last `window` seconds [N]."""
        inside = self.t > self.t[-1] - window + 1e-9
        return float(np.mean(self.load[inside]))


def reference_twin(
    model: Model, waveform: Waveform, duration: float, fps: float, links: int = 20, start: Array | None = None
) -> Twin:
    """The MuJoCo reference, from the shape start (K,) at rest (default: straight)."""
    from mujoco_ref.simulate import Initial, Setup, simulate

    initial = np.zeros(2) if start is None else start
    run = simulate(model, waveform, duration, fps, setup=Setup(links=links, s=S, initial=Initial(initial)))
    q = reduced(run.angles - run.theta[:, None])
    # For every start the load is counted from that of the straight arm at rest.
    return Twin(run.t, run.theta, run.midline.xy, q, run.load_cell)


def reduced(alpha: Array) -> Array:
    """The paper's (q1, q2), (T, 2) [rad], nearest to angles alpha (T, N) [rad] at even s from 0 to 1."""
    s = np.linspace(0.0, 1.0, alpha.shape[1])
    basis = np.stack([s, 0.5 * s**2], axis=1)  # alpha = q1 s + q2 s^2 / 2 (eq. 2)
    return np.asarray(np.linalg.lstsq(basis, alpha.T, rcond=None)[0].T, dtype=float)


def affine_twin(
    model: Model, order: int, waveform: Waveform, duration: float, fps: float, start: Array | None = None
) -> Twin:
    """The reduced model with that many coordinates, from the same start."""
    from affine_model.arm import arm_of, parameter_vector
    from affine_model.base_signal import Steps, base_table
    from affine_model.curvature import midline
    from affine_model.simulate import simulate

    model = replace(model, order=order)
    arm, parameters = arm_of(model), parameter_vector(model)
    stride = int(np.ceil(1.0 / (fps * AFFINE_STEP) - 1e-9))
    step = 1.0 / (fps * stride)
    steps = (int(np.floor(duration * fps + 1e-9)) + 1) * stride
    base = base_table(waveform, Steps(0.0, step, steps), parameters[:, None])
    q = np.zeros((order, 1))
    if start is not None:
        q[: min(order, start.size), 0] = start[:order]
    run = simulate(arm, parameters[:, None], base, Timing(step, stride), start=Start(q=q))
    frames = len(run.t) - 1
    load = run.load[:frames, 0]
    # A reading at a frame is the mean of those over the intervals beside it.
    at_frames = np.concatenate([load[:1], 0.5 * (load[1:] + load[:-1])])
    coordinates = run.q[:frames, :, 0]
    theta, turn = run.theta[:frames, 0], arm.root_turn(coordinates, 1)
    xy = midline(coordinates, theta + turn, model.specimen.length, S)
    alpha = turn[:, None] + coordinates @ np.stack([S**j / j for j in range(1, order + 1)])
    return Twin(run.t[:frames], theta, xy, reduced(alpha), at_frames - net_weight(model))


def net_weight(model: Model) -> float:
    """Weight minus buoyancy along +y [N], the reading of a load cell at the base at rest."""
    specimen, fluid = model.specimen, model.fluid
    carried = specimen.mass * (1.0 - fluid.density / specimen.density) + specimen.tip_mass
    return float(carried * model.gravity.magnitude * np.cos(model.gravity.angle))


def shape_error(one: Twin, reference: Twin, window: float) -> tuple[float, float]:
    """Distance of two midlines, rms over points and the last `window` seconds: [mm], and relative to the tip's rms
    motion."""
    inside = reference.t > reference.t[-1] - window + 1e-9
    apart = np.sqrt(np.mean(np.sum((one.xy[inside] - reference.xy[inside]) ** 2, axis=2)))
    tip = reference.xy[inside, -1]
    moved = np.sqrt(np.mean(np.sum((tip - tip.mean(axis=0)) ** 2, axis=1)))
    return 1e3 * float(apart), float(apart / moved)

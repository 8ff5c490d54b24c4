"""An exported arm run by MuJoCo beside the recording that its model was identified from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from mujoco_ref.chain import clamp_gives, hinge_positions, hinge_sharpness
from mujoco_ref.engine import mujoco
from mujoco_ref.export.arm_forces import Forces, drive
from mujoco_ref.midline import chain_midline_points
from tentacle.model import Model
from tentacle.recording import Recording
from tentacle.signals import Array
from validation.export.start import Started, as_camera_has_it, distance_mm, start_of


@dataclass(frozen=True)
class ExportError:
    """rms distance to the recording's points [mm]: ours, arm.xml with arm_forces.py, arm.xml alone; frames judged;
    whether the fit of the common start converged.
    """

    name: str
    ours_mm: float
    with_forces_mm: float
    alone_mm: float
    frames: int
    converged: bool = True

    def sentence(self) -> str:
        """The three errors side by side."""
        return (
            f"{self.name}: ours {self.ours_mm:.3f} mm, MuJoCo with arm_forces.py {self.with_forces_mm:.3f} mm "
            f"({self.with_forces_mm / self.ours_mm:.2f} times ours), arm.xml alone {self.alone_mm:.3f} mm, "
            f"rms over {self.frames} frames"
            f"{'' if self.converged else '; the fit of the start did not converge'}"
        )


def export_error(xml: str, model: Model, recording: Recording) -> ExportError:
    """Run arm.xml's text in MuJoCo, with and without its callback, under a recording's base motion."""
    started = start_of(model, recording)
    errors = [distance_mm(started.seen.xy, points_in_mujoco(xml, model, started, exact)) for exact in (True, False)]
    return ExportError(recording.name, started.error_mm, errors[0], errors[1], len(started.t), started.converged)


def points_in_mujoco(xml: str, model: Model, started: Started, exact: bool) -> Array:
    """Where MuJoCo puts the recording's points (T, P, 2) [m], as the camera shows them."""
    engine = mujoco.MjModel.from_xml_string(xml)
    forces = Forces(engine) if exact else None
    data = mujoco.MjData(engine)
    hinges = sum(engine.joint(j).name.startswith("hinge_") for j in range(engine.njnt))
    gives = int(clamp_gives(model.specimen))
    s, sharpness = (values(model.specimen, hinges - gives) for values in (hinge_positions, hinge_sharpness))
    powers = np.stack([s**j for j in range(len(started.q))])
    data.qpos[0], data.qvel[0] = started.base(started.start)[:2]
    data.qpos[1 : hinges + 1] = started.q @ powers / sharpness
    data.qvel[1 : hinges + 1] = started.q_rate @ powers / sharpness
    data.time = started.start
    try:
        if forces is not None:
            forces.attach()
        positions = drive(engine, data, started.base, started.t)
    finally:
        mujoco.set_mjcb_passive(None)
    angles = np.cumsum(positions[:, : hinges + 1], axis=1)[:, gives:]
    shown = started.seen
    xy = chain_midline_points(angles, np.zeros((len(angles), 2)), model.specimen.length, shown.s)
    phi = CubicSpline(np.linspace(0.0, 1.0, angles.shape[1]), angles, axis=1)(shown.s)
    beside = shown.d[:, None] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    return as_camera_has_it(model, xy + beside, started.shift)

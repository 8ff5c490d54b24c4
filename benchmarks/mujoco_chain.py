"""MuJoCo's own arm in water for benchmarks: 20 links, ellipsoid fluid model, a stiff servo at the base."""

from __future__ import annotations

from typing import Any

import numpy as np

from mujoco_ref.engine import mujoco
from tentacle.signals import Array
from tentacle.specimen import Specimen

LINKS = 20


def chain_model(specimen: Specimen, E: float, eta: float, fluid_density: float, step: float) -> Any:
    """A chain of capsules of the specimen's mass, buoyancy by gravcomp, integrator `discrete`."""
    piece = specimen.length / LINKS
    body, closing = "", ""
    for k in range(LINKS):
        s_joint, s_middle = k / LINKS, (k + 0.5) / LINKS
        section = specimen.section
        radius, bending = float(section.half_thickness(s_middle)), float(section.second_moment(s_joint))
        mass = specimen.density * float(section.area(s_middle)) * piece
        stiffness, damping = (0.0, 0.0) if k == 0 else (E * bending / piece, eta * bending / piece)
        body += f"""<body pos="0 0 {0 if k == 0 else -piece}" gravcomp="{fluid_density / specimen.density}">
          <joint name="j{k}" type="hinge" axis="0 1 0" stiffness="{stiffness}" damping="{damping}"/>
          <geom type="ellipsoid" size="{radius} {radius} {piece / 2}" pos="0 0 {-piece / 2}" mass="{mass}"
           fluidshape="ellipsoid" contype="0" conaffinity="0"/>"""
        closing += "</body>"
    text = f"""<mujoco><option timestep="{step}" integrator="discrete" density="{fluid_density}" viscosity="0.001"/>
      <worldbody>{body}{closing}</worldbody>
      <actuator><position joint="j0" kp="50" kv="0.5"/></actuator></mujoco>"""
    return mujoco.MjModel.from_xml_string(text)


def roll(model: Any, command: Array, threads: int) -> Array:
    """Tip angle (B, S) [rad] of B runs from rest under commands (B, S) [rad], on that many threads."""
    count, steps = command.shape
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    initial = np.zeros((count, size))
    from mujoco import rollout

    data = [mujoco.MjData(model) for _ in range(threads)]
    states, _ = rollout.rollout(model, data, initial, command[:, :, None], nstep=steps)
    return np.asarray(states)[:, :, 1 : 1 + model.nq].sum(axis=2)

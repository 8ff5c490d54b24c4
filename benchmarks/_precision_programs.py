"""The programs of benchmarks/precision.py: each moves one arm under one motion and gives its midline, its mean thrust
and the processor time of one second of motion.

Ours in batches (as a search runs it) and alone; our chain of hinges on MuJoCo; MuJoCo's own chain, with nothing of
ours: a hinge in the middle of each piece, masses, centres and inertias of the frusta, a stiff servo at the base.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from affine_model.arm import Arm, neutral_parameters, parameter_index
from affine_model.curvature import midline
from affine_model.simulate import Timing, simulate
from mujoco_ref.engine import mujoco
from mujoco_ref.midline import chain_midline_points
from mujoco_ref.simulate import Setup
from mujoco_ref.simulate import simulate as simulate_chain
from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.signals import Array
from tentacle.specimen import Cone, Fluid, Gravity, Specimen

S = np.linspace(0.0, 1.0, 21)
BATCH = 512
FRAMES = 20  # a period
KP, KV = 200.0, 2.0  # N m/rad, N m s/rad: the native chain's servo


@dataclass(frozen=True)
class Material:
    """An arm: its specimen, modulus [Pa], viscosity [Pa s]; C_perp of eq. 15 where there is water."""

    name: str
    specimen: Specimen
    modulus: float
    viscosity: float
    drag: float = 1.1


@dataclass(frozen=True)
class Motion:
    """A sine of amplitude [rad] and frequency [Hz] that swells from nothing within its first period."""

    amplitude: float
    frequency: float
    periods: int = 6

    @property
    def seconds(self) -> float:
        """How long it lasts [s]."""
        return self.periods / self.frequency

    def __call__(self, t: Any) -> Array:
        """Theta and its first two derivatives (3, ...)."""
        t = np.asarray(t, dtype=float)
        w, r = 2.0 * np.pi * self.frequency, np.pi * self.frequency
        early = (t > 0.0) & (t < 1.0 / self.frequency)
        swell = np.where(early, 0.5 - 0.5 * np.cos(r * t), np.where(t > 0.0, 1.0, 0.0))
        rate, bend = np.where(early, 0.5 * r * np.sin(r * t), 0.0), np.where(early, 0.5 * r * r * np.cos(r * t), 0.0)
        sine, cosine = np.sin(w * t), np.cos(w * t)
        found = [swell * sine, rate * sine + swell * w * cosine]
        found.append(bend * sine + 2.0 * rate * w * cosine - swell * w * w * sine)
        return self.amplitude * np.stack(found)


@dataclass(frozen=True)
class Case:
    """One arm, one motion, in a fluid of this density [kg/m^3] (0: none)."""

    material: Material
    motion: Motion
    density: float


@dataclass(frozen=True)
class Run:
    """xy (F, P, 2) [m] at every frame after half of the time; thrust [N], the mean over the same; seconds of processor
    time a simulated second.
    """

    xy: Array
    thrust: float
    cost: float


def processor_seconds(work: Callable[[], object], repeats: int = 2) -> float:
    """The least processor time of several calls [s]."""
    best = np.inf
    for _ in range(repeats):
        begin = time.process_time()
        work()
        best = min(best, time.process_time() - begin)
    return best


def ours(case: Case, order: int, substeps: int, count: int = BATCH, nodes: int | None = None) -> Run:
    """The reduced model: `order` curvatures, `substeps` steps a frame, in a batch of `count`."""
    arm = Arm(case.material.specimen, Fluid(case.density), Gravity(0.0, 0.0), order, nodes or order + 2)
    vector = neutral_parameters()
    named = (("elasticity", "E", case.material.modulus), ("damping", "eta", case.material.viscosity))
    for effect, name, value in (*named, ("drag", "C_perp", case.material.drag)):
        vector[parameter_index(effect, name)] = value
    step = 1.0 / (case.motion.frequency * FRAMES * substeps)
    rows = np.repeat(vector[:, None], count, axis=1)

    def base(motion: Motion) -> Array:
        return motion((np.arange(motion.periods * FRAMES * substeps) + 0.5) * step)[:, :, None]

    def seconds(motion: Motion) -> float:
        table = base(motion)
        return processor_seconds(lambda: simulate(arm, rows, table, Timing(step, 0)), 3)

    batch = simulate(arm, vector[:, None], base(case.motion), Timing(step, substeps))
    half = case.motion.periods // 2 * FRAMES
    if not np.isnan(batch.diverged[0]):
        raise FloatingPointError("diverged")
    xy = midline(batch.q[:, :, 0], batch.theta[:, 0], case.material.specimen.length, S)[half:]
    cost = seconds(case.motion) / case.motion.seconds
    if count == 1:  # as for the chain: what is done once a run does not count
        longer = replace(case.motion, periods=10 * case.motion.periods)
        cost = (seconds(longer) - seconds(case.motion)) / (longer.seconds - case.motion.seconds)
    return Run(xy, float(batch.fluid_force[half:, 1, 0].mean()), cost / count)


def chain(case: Case, links: int, substeps: int, timed: bool = True) -> Run:
    """Our chain of hinges on MuJoCo, drag by the section (mujoco_ref)."""
    named = {"elasticity": {"E": case.material.modulus}, "damping": {"eta": case.material.viscosity}}
    named["drag"] = {"C_perp": case.material.drag}
    values = {effect: {k: Estimate.exact(v) for k, v in own.items()} for effect, own in named.items()}
    model = Model(case.material.specimen, Fluid(case.density), Gravity(0.0, 0.0), 2, values)
    fps = case.motion.frequency * FRAMES

    def work(motion: Motion) -> Any:
        return simulate_chain(
            model,
            motion,
            motion.seconds,
            fps,
            setup=Setup(links=links, s=S, longest_step=1.0 / (fps * substeps * (1.0 - 1e-9))),
        )

    try:
        run = work(case.motion)
    except InputError as error:
        raise FloatingPointError("ran away") from error
    half = case.motion.periods // 2 * FRAMES
    cost = np.nan
    if timed:  # the difference of a long and a short run: what is done once a run does not count
        longer = replace(case.motion, periods=3 * case.motion.periods)
        spent = processor_seconds(lambda: work(longer), 1) - processor_seconds(lambda: work(case.motion), 1)
        cost = spent / (longer.seconds - case.motion.seconds)
    return Run(run.midline.xy[half:], float(np.mean(run.thrust[half + 1 :])), cost)


def native_model(case: Case, links: int, step: float, integrator: str, own_water: bool) -> Any:
    """MuJoCo's own chain: hinges at (k + 1/2) / links, so that the link between two carries the angle at k / links."""
    specimen, piece = case.material.specimen, case.material.specimen.length / links
    text, closing, previous = "", "", 0.0
    for k in range(links + 1):
        begin, end = max(0.0, (k - 0.5) / links), min(1.0, (k + 0.5) / links)
        s = begin + (end - begin) * (np.polynomial.legendre.leggauss(8)[0] + 1.0) / 2.0
        w = np.polynomial.legendre.leggauss(8)[1] / 2.0 * (end - begin) * specimen.length
        line = specimen.density * specimen.section.area(s) * w
        mass, along = float(line.sum()), (s - begin) * specimen.length
        centre = float(line @ along / mass)
        inertia = float(line @ (along - centre) ** 2 + specimen.density * specimen.section.second_moment(s) @ w)
        bending = 0.0 if k == 0 else float(specimen.section.second_moment(np.array([begin]))[0]) / piece
        stiffness, damping = case.material.modulus * bending, case.material.viscosity * bending
        size, middle = (
            0.5 * (end - begin) * specimen.length,
            float(specimen.section.half_thickness(0.5 * (begin + end))),
        )
        text += f"""<body pos="0 0 {-(begin - previous) * specimen.length}">
          <joint name="j{k}" type="hinge" axis="0 1 0" stiffness="{stiffness}" damping="{damping}"/>
          <inertial pos="0 0 {-centre}" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>
          <geom type="ellipsoid" size="{middle} {middle} {size}" pos="0 0 {-size}" contype="0" conaffinity="0"
           {'fluidshape="ellipsoid"' if own_water else ""}/>"""
        closing, previous = closing + "</body>", begin
    water = f'density="{case.density}" viscosity="0.001"' if own_water else ""
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="{step}" integrator="{integrator}" gravity="0 0 0" {water}/>
        <worldbody>{text}{closing}</worldbody>
        <actuator><position joint="j0" kp="{KP}" kv="{KV}"/></actuator></mujoco>"""
    )


def native(case: Case, links: int, substeps: int, integrator: str, own_water: bool = False, timed: bool = True) -> Run:
    """MuJoCo's own chain by mujoco.rollout on one thread; its thrust is not asked for (NaN)."""
    from mujoco import rollout

    step = 1.0 / (case.motion.frequency * FRAMES * substeps)
    model = native_model(case, links, step, integrator, own_water)
    steps = case.motion.periods * FRAMES * substeps
    wanted = case.motion((np.arange(steps) + 1.0) * step)
    command = (wanted[0] + KV / KP * wanted[1])[None, :, None]
    start, data = np.zeros((1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))), mujoco.MjData(model)
    states, _ = rollout.rollout(model, [data], start, command, nstep=steps)
    angles = np.cumsum(np.asarray(states)[0, :, 1 : 2 + links], axis=1)[substeps - 1 :: substeps]
    if not np.all(np.abs(angles) < 100.0):
        raise FloatingPointError("ran away")
    angles = angles[case.motion.periods // 2 * FRAMES - 1 :]
    xy = chain_midline_points(angles, np.zeros((len(angles), 2)), case.material.specimen.length, S)
    cost = np.nan
    if timed:
        cost = processor_seconds(lambda: rollout.rollout(model, [data], start, command, nstep=steps))
    return Run(xy, np.nan, cost / case.motion.seconds)


def cone(length: float, base: float, tip: float) -> Specimen:
    """A cone of silicone: lengths in m."""
    return Specimen(Cone(base, tip), length, 1070.0)

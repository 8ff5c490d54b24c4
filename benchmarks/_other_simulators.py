"""Other simulators of the same arm and motion, each in an environment of its own under a temporary folder.

PyElastica with 20 elements (a Cosserat rod with drag by the section) and torchdiffeq on our own equations. One that
cannot be installed is skipped, with the reason.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PATIENCE = 900.0  # s for an installation or a run

# Each prints {"seconds": of computing, "simulated": s, "tip_angle": [rad, the end of every run]}. ARGUMENTS holds the
# specimen, its parameters, and the base's amplitudes and frequencies.
PYELASTICA = '''
import json, sys, time
import numpy as np
import elastica as ea
from elastica.boundary_conditions import ConstraintBase
from elastica.external_forces import NoForces
a = json.loads(sys.argv[1])
n, length = 20, a["length"]
element = length / n
middles = (np.arange(n) + 0.5) / n
radius = a["r0"] + (a["r1"] - a["r0"]) * middles
dt = a["step"]


class Turned(ConstraintBase):
    """The base element turns by amplitude sin(2 pi f t) about the third axis."""

    def __init__(self, position, director, amplitude, frequency, **kwargs):
        super().__init__(**kwargs)
        self.position, self.director = np.array(position), np.array(director)
        self.amplitude, self.omega = amplitude, 2 * np.pi * frequency

    def constrain_values(self, rod, time):
        angle = self.amplitude * np.sin(self.omega * time)
        turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1.0]])
        rod.position_collection[..., 0] = self.position
        rod.director_collection[..., 0] = self.director @ turn.T

    def constrain_rates(self, rod, time):
        rate = self.amplitude * self.omega * np.cos(self.omega * time)
        rod.velocity_collection[..., 0] = 0.0
        rod.omega_collection[..., 0] = rod.director_collection[..., 0] @ np.array([0.0, 0.0, rate])


class Water(NoForces):
    """Drag along the normal, and buoyancy's absence of weight: the arm is horizontal in the plane of motion."""

    def apply_forces(self, rod, time=0.0):
        velocity = 0.5 * (rod.velocity_collection[:, 1:] + rod.velocity_collection[:, :-1])
        tangent = rod.tangents
        across = velocity - np.sum(velocity * tangent, axis=0) * tangent
        speed = np.sqrt(np.sum(velocity**2, axis=0))
        force = -0.5 * a["fluid"] * a["C_perp"] * 2 * radius * element * speed * across
        rod.external_forces[:, 1:] += 0.5 * force
        rod.external_forces[:, :-1] += 0.5 * force


class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Damping):
    pass


ends, spent = [], 0.0
for amplitude, frequency in zip(a["amplitude"], a["frequency"]):
    simulator = Simulator()
    rod = ea.CosseratRod.straight_rod(
        n, np.zeros(3), np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0]), length, radius, a["density"],
        youngs_modulus=a["E"], shear_modulus=a["E"] / 3.0)
    simulator.append(rod)
    simulator.constrain(rod).using(
        Turned, constrained_position_idx=(0,), constrained_director_idx=(0,), amplitude=amplitude, frequency=frequency)
    simulator.add_forcing_to(rod).using(Water)
    simulator.dampen(rod).using(ea.AnalyticalLinearDamper, damping_constant=a["damping"], time_step=dt)
    simulator.finalize()
    steps = round(a["seconds"] / dt)
    ea.integrate(ea.PositionVerlet(), simulator, 2 * dt, 2, progress_bar=False)  # compiled
    start = time.perf_counter()
    ea.integrate(ea.PositionVerlet(), simulator, steps * dt, steps, progress_bar=False)
    spent += time.perf_counter() - start
    ends.append(float(np.arctan2(-rod.tangents[0, -1], rod.tangents[1, -1])))
print(json.dumps({"seconds": spent, "simulated": a["seconds"] * len(ends), "tip_angle": ends}))
'''

TORCHDIFFEQ = """
import json, sys, time
import torch
from torchdiffeq import odeint
from affine_model.arm import active_effects
from affine_model.dynamics import balance
from benchmarks.affine import ARM, parameters
a = json.loads(sys.argv[1])
torch.set_default_dtype(torch.float64)
vector = parameters()
effects, rows = active_effects(vector), torch.from_numpy(vector)[:, None]
amplitude, omega = torch.tensor(a["amplitude"]), 2 * torch.pi * torch.tensor(a["frequency"])
n, count = ARM.order, amplitude.numel()


def rate(t, state):
    z, z_rate = state[:, :n], state[:, n:]
    angle = omega * t
    theta = torch.stack([amplitude * angle.sin(), amplitude * omega * angle.cos(), -amplitude * omega**2 * angle.sin()])
    rail = torch.zeros(count, 1)
    u = torch.cat([z, theta[0][:, None], rail], 1)
    v = torch.cat([z_rate, theta[1][:, None], rail], 1)
    found = balance(ARM, effects, rows, u, v, t)
    right = found.force[:, :n] - found.mass_matrix[:, :n, n] * theta[2][:, None]
    return torch.cat([z_rate, torch.linalg.solve(found.mass_matrix[:, :n, :n], right)], 1)


times = torch.linspace(0.0, a["seconds"], 2)
start = time.perf_counter()
with torch.no_grad():
    end = odeint(rate, torch.zeros(count, 2 * n), times, rtol=a["tolerance"], atol=a["tolerance"], method="dopri5")[-1]
spent = time.perf_counter() - start
last = amplitude * torch.sin(omega * a["seconds"]) + end[:, 0]
print(json.dumps({"seconds": spent, "simulated": a["seconds"] * count, "tip_angle": last.tolist()}))
"""

PROGRAMS = {"pyelastica": PYELASTICA, "torchdiffeq": TORCHDIFFEQ}


@dataclass(frozen=True)
class Ran:
    """simulated seconds per second of wall time, and the tip's angle [rad] at the end of every run."""

    speed: float
    tip_angle: list[float]


def run_other(package: str, arguments: dict[str, object]) -> Ran | str:
    """Install the package into a temporary folder and run its program; the reason where either fails."""
    with tempfile.TemporaryDirectory(prefix="tentacle-benchmark-") as folder:
        # torchdiffeq asks for torch, which stands here already.
        alone = ["--no-deps"] if package == "torchdiffeq" else []
        install = [sys.executable, "-m", "pip", "install", "--quiet", *alone, "--target", folder, package]
        try:
            subprocess.run(install, capture_output=True, text=True, check=True, timeout=PATIENCE)
            path = os.pathsep.join([folder, str(ROOT)])
            done = subprocess.run(
                [sys.executable, "-c", PROGRAMS[package], json.dumps(arguments)],
                env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, check=True, timeout=PATIENCE,
            )  # fmt: skip
        except subprocess.CalledProcessError as error:
            return (error.stderr or error.stdout or "it failed").strip().splitlines()[-1]
        except subprocess.TimeoutExpired:
            return f"not done after {PATIENCE:.0f} s"
    found = json.loads(done.stdout.strip().splitlines()[-1])
    return Ran(found["simulated"] / found["seconds"], found["tip_angle"])

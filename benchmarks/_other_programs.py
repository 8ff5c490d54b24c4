"""Programs that run in other simulators' environments: the same cone in the same water, turned by the same sines.

Each takes one JSON argument: length, r0, r1 [m], density, fluid [kg/m^3], E [Pa], eta [Pa s], C_perp, seconds, the
base's amplitude [rad] and frequency [Hz] of every run, and the simulator's own accuracy. Each prints, as its last
line, {"seconds": of computing, "tip_angle": [rad, at the end of every run]}. Compiling is done before the clock runs.
All have Kelvin-Voigt damping and normal drag, no weight and no added mass.
"""

# A Cosserat rod of 20 elements, which also shears and stretches; its first element, 1/20 of the arm, is clamped whole.
# It has neither drag by the section nor Kelvin-Voigt damping: both are added here, compiled as its own forces are.
PYELASTICA = '''
import json, sys, time
import numpy as np
import elastica as ea
from elastica.boundary_conditions import ConstraintBase
from elastica.external_forces import NoForces
from numba import njit
a = json.loads(sys.argv[1])
n, length, dt = 20, a["length"], a["step"]
radius = a["r0"] + (a["r1"] - a["r0"]) * (np.arange(n) + 0.5) / n
drag = 0.5 * a["fluid"] * a["C_perp"] * 2 * radius * length / n
joint_radius = a["r0"] + (a["r1"] - a["r0"]) * np.arange(1, n) / n
viscous = a["eta"] * np.pi * joint_radius**4 / 4 / (length / n)


class Turned(ConstraintBase):
    """The base element turns by amplitude sin(2 pi f t) about the third axis."""

    def __init__(self, position, director, amplitude, frequency, **kwargs):
        super().__init__(**kwargs)
        self.position, self.director = np.array(position), np.array(director)
        self.amplitude, self.omega = amplitude, 2 * np.pi * frequency

    def constrain_values(self, system, time):
        angle = self.amplitude * np.sin(self.omega * time)
        turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1.0]])
        system.position_collection[..., 0] = self.position
        system.director_collection[..., 0] = self.director @ turn.T

    def constrain_rates(self, system, time):
        rate = self.amplitude * self.omega * np.cos(self.omega * time)
        system.velocity_collection[..., 0] = 0.0
        system.omega_collection[..., 0] = system.director_collection[..., 0] @ np.array([0.0, 0.0, rate])


@njit
def push(velocity, tangents, force):
    """Drag along the normal, half of every element's to each of its ends."""
    for k in range(tangents.shape[1]):
        v = 0.5 * (velocity[:, k] + velocity[:, k + 1])
        along = v[0] * tangents[0, k] + v[1] * tangents[1, k] + v[2] * tangents[2, k]
        size = 0.5 * drag[k] * np.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2)
        for i in range(3):
            part = size * (v[i] - along * tangents[i, k])
            force[i, k] -= part
            force[i, k + 1] -= part


@njit
def twist(rate, torque):
    """Kelvin-Voigt: a couple against the difference of neighbouring elements' rates."""
    for k in range(rate.shape[1] - 1):
        for i in range(2):
            moment = viscous[k] * (rate[i, k + 1] - rate[i, k])
            torque[i, k] += moment
            torque[i, k + 1] -= moment


class Surroundings(NoForces):
    def apply_forces(self, system, time=0.0):
        push(system.velocity_collection, system.tangents, system.external_forces)

    def apply_torques(self, system, time=0.0):
        twist(system.omega_collection, system.external_torques)


class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing):
    pass


ends, spent = [], 0.0
for amplitude, frequency in zip(a["amplitude"], a["frequency"]):
    simulator = Simulator()
    rod = ea.CosseratRod.straight_rod(
        n, np.zeros(3), np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0]), length, radius, a["density"],
        youngs_modulus=a["E"], shear_modulus=a["E"] / 3.0)
    rate = amplitude * 2 * np.pi * frequency
    rod.velocity_collection[0] = -rate * rod.position_collection[1]
    rod.omega_collection[:] = rod.director_collection[:, 2] * rate
    simulator.append(rod)
    simulator.constrain(rod).using(
        Turned, constrained_position_idx=(0,), constrained_director_idx=(0,), amplitude=amplitude, frequency=frequency)
    simulator.add_forcing_to(rod).using(Surroundings)
    simulator.finalize()
    stepper, steps = ea.PositionVerlet(), round(a["seconds"] / dt)
    ea.integrate(stepper, simulator, 2 * dt, 2, progress_bar=False)  # compiled
    start = time.perf_counter()
    ea.integrate(stepper, simulator, (steps - 2) * dt, steps - 2, restart_time=2 * dt, progress_bar=False)
    spent += time.perf_counter() - start
    ends.append(float(np.arctan2(-rod.tangents[0, -1], rod.tangents[1, -1])))
print(json.dumps({"seconds": spent, "tip_angle": ends}))
'''

# Geometric variable strain, order 1: curvature affine in the arc length, as ours. It knows neither fluid nor a base
# that moves as prescribed: drag is put in through its Jacobians, and its equations are split at the base's angle.
SOROMOX = """
import json, sys, time
import diffrax
import jax
import jax.numpy as jnp
from soromox.systems.components import JointSpec, LinearProfile, LinkSpec
from soromox.systems.gvs import GVS, GVSSegment, StrainBasisSpec
jax.config.update("jax_enable_x64", True)
a = json.loads(sys.argv[1])
link = LinkSpec.circular(
    length=a["length"], radius=LinearProfile(a["r0"], a["r1"]), density=a["density"],
    reference_strain=[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], young_modulus=a["E"], poisson_ratio=0.49)
arm = GVS.from_segments(
    [GVSSegment(link, JointSpec.revolute("z"), StrainBasisSpec("monomial", ["kappa_z"], 1), 6)],
    gravity=jnp.zeros(3), base_pose=jnp.array([0.0, 0, 0, 1, 0, 0, 0]), backend="jax")
stiffness = arm.stiffness_matrix()[1:, 1:]
damping = stiffness * a["eta"] / a["E"]
radius = a["r0"] + (a["r1"] - a["r0"]) * arm.integration_points[0, 1:-1]
drag = 0.5 * a["fluid"] * a["C_perp"] * 2 * radius * arm.inner_integration_weights[0]


def rate(t, state, motion):
    amplitude, omega = motion
    angle, angle_rate = amplitude * jnp.sin(omega * t), amplitude * omega * jnp.cos(omega * t)
    z, z_rate = state[:2], state[2:]
    q, q_rate = jnp.concatenate([angle[None], z]), jnp.concatenate([angle_rate[None], z_rate])
    inertia, coriolis, _ = arm.dynamics_terms(q, q_rate)
    columns = arm.integration_kinematics(q, q_rate)[1][0]
    along, across = columns[:, 3] @ q_rate, columns[:, 4] @ q_rate
    water = -(drag * jnp.sqrt(along**2 + across**2) * across) @ columns[:, 4]
    right = (water - coriolis)[1:] - stiffness @ z - damping @ z_rate + inertia[1:, 0] * omega**2 * angle
    return jnp.concatenate([z_rate, jnp.linalg.solve(inertia[1:, 1:], right)])


def end(amplitude, omega, tolerance):
    z = diffrax.diffeqsolve(
        diffrax.ODETerm(rate), diffrax.Tsit5(), 0.0, a["seconds"], None, jnp.zeros(4), args=(amplitude, omega),
        saveat=diffrax.SaveAt(t1=True), max_steps=100000,
        stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=tolerance)).ys[-1]
    return amplitude * jnp.sin(omega * a["seconds"]) + a["length"] * (z[0] + 0.5 * z[1])


batch = jax.jit(jax.vmap(end, in_axes=(0, 0, None)))
given = jnp.array(a["amplitude"]), 2 * jnp.pi * jnp.array(a["frequency"]), a["tolerance"]
batch(*given).block_until_ready()  # compiled
start = time.perf_counter()
ends = batch(*given).block_until_ready()
print(json.dumps({"seconds": time.perf_counter() - start, "tip_angle": ends.tolist()}))
"""

# Our own equations in their readable form, by torch operation; torch.compile gains nothing (it breaks the graph).
TORCHDIFFEQ = """
import json, sys, time
import torch
from torchdiffeq import odeint
from affine_model.arm import active_effects
from affine_model.dynamics import balance
from benchmarks.affine import bare_arm, bare_parameters
a = json.loads(sys.argv[1])
torch.set_default_dtype(torch.float64)
torch.set_num_threads(1)
arm, vector = bare_arm(), bare_parameters()
effects, rows = active_effects(vector), torch.from_numpy(vector)[:, None]
amplitude, omega = torch.tensor(a["amplitude"]), 2 * torch.pi * torch.tensor(a["frequency"])
n, count = arm.order, amplitude.numel()


def rate(t, state):
    z, z_rate = state[:, :n], state[:, n:]
    angle = omega * t
    theta = torch.stack([amplitude * angle.sin(), amplitude * omega * angle.cos(), -amplitude * omega**2 * angle.sin()])
    rail = torch.zeros(count, 1)
    u = torch.cat([z, theta[0][:, None], rail], 1)
    v = torch.cat([z_rate, theta[1][:, None], rail], 1)
    found = balance(arm, effects, rows, u, v, t)
    right = found.force[:, :n] - found.mass_matrix[:, :n, n] * theta[2][:, None]
    return torch.cat([z_rate, torch.linalg.solve(found.mass_matrix[:, :n, :n], right)], 1)


times, rest = torch.linspace(0.0, a["seconds"], 2), torch.zeros(count, 2 * n)
with torch.no_grad():
    rate(times[0], rest)
    start = time.perf_counter()
    end = odeint(rate, rest, times, rtol=a["tolerance"], atol=a["tolerance"], method="dopri5")[-1]
spent = time.perf_counter() - start
# z_1 is the mean curvature, and so the angle that the arm adds up.
last = amplitude * torch.sin(omega * a["seconds"]) + end[:, 0]
print(json.dumps({"seconds": spent, "tip_angle": last.tolist()}))
"""

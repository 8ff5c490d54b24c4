"""The equations of motion against mechanics itself: energy, Lagrange's equations, autodiff."""

import numpy as np
import pytest
import torch

from affine_model.arm import Arm, active_effects
from affine_model.curvature import midline, quadrature
from affine_model.dynamics import balance
from tentacle.specimen import WATER, Cone, Gravity, Rectangle, Specimen

SPECIMENS = [
    Specimen(Cone(0.0125, 0.001), 0.14, 1070.0),
    Specimen(Cone(0.01, 0.005), 0.2, 1100.0, tip_mass=3e-3),
    Specimen(Rectangle(0.02, 0.01), 0.2, 1070.0),
]
U = np.array([0.9, -0.7, 0.35, 0.5, 0.04])  # three curvatures, base angle, rail
V = np.array([2.0, 1.5, -3.0, -1.2, 0.3])


def assembled(arm, p, u, v):
    return balance(arm, active_effects(p), p, u, v)


def kinetic_energy(arm, u, v, C_a):
    """By quadrature on 64 nodes of velocities that are differences of midline(): nothing shared with the assembly."""
    rule, n, specimen = quadrature(64), arm.order, arm.specimen
    section, h = specimen.section, 1e-6

    def points(state):
        xy = midline(arm.to_monomial @ state[:n], state[n], specimen.length, np.append(rule.s, 1.0), nodes=64)
        return xy + np.array([0.0, state[n + 1]])

    def angles(state):
        from affine_model.curvature import monomial_angle

        return state[n] + monomial_angle(arm.to_monomial @ state[:n], rule.s)

    velocity = (points(u + h * v) - points(u - h * v)) / (2 * h)
    turning = (angles(u + h * v) - angles(u - h * v)) / (2 * h)
    phi = angles(u)
    along_n = velocity[:-1, 0] * np.cos(phi) + velocity[:-1, 1] * np.sin(phi)
    carried = specimen.density * section.area(rule.s) * np.sum(velocity[:-1] ** 2, -1)
    rotary = specimen.density * section.second_moment(rule.s) * turning**2
    added = C_a * arm.fluid.density * np.pi / 4 * section.width(rule.s) ** 2 * along_n**2
    line = specimen.length * np.sum(rule.weights * (carried + rotary + added))
    payload = specimen.tip_mass * (1.0 + 0.5 * arm.fluid.density / specimen.tip_mass_density)  # a sphere's water
    return 0.5 * line + 0.5 * payload * np.sum(velocity[-1] ** 2)


@pytest.mark.parametrize("specimen", SPECIMENS)
@pytest.mark.parametrize("C_a", [0.0, 1.0])
def test_kinetic_energy_is_half_v_M_v(parameters, specimen, C_a):
    arm = Arm(specimen, WATER, Gravity(0.3), order=3, nodes=12)
    M = assembled(arm, parameters(added_mass__C_a=C_a), U, V).mass_matrix
    np.testing.assert_allclose(M, M.T, rtol=0, atol=1e-15)
    assert np.all(np.linalg.eigvalsh(M) > 0)
    # M is the Hessian of T: a quadratic form agrees with T on enough directions only if it is. Differences: 1e-9.
    rng = np.random.default_rng(1)
    for direction in rng.normal(size=(20, 5)):
        truth = kinetic_energy(arm, U, direction, C_a)
        assert 0.5 * direction @ M @ direction == pytest.approx(truth, rel=1e-7)


@pytest.mark.parametrize("specimen", SPECIMENS)
@pytest.mark.parametrize("C_a", [0.0, 1.0])
def test_velocity_forces_are_christoffel(parameters, specimen, C_a):
    """Without dissipation, force(u, v) - force(u, 0) = dT/du - M_dot v, with M's derivatives by autodiff."""
    arm = Arm(specimen, WATER, Gravity(0.3), order=3, nodes=8)
    p = parameters(elasticity__E=2e5, added_mass__C_a=C_a)
    row = torch.from_numpy(p)
    effects = active_effects(p)

    def mass(u):
        return balance(arm, effects, row, u, torch.zeros(5, dtype=torch.float64)).mass_matrix

    slope = torch.autograd.functional.jacobian(mass, torch.from_numpy(U)).numpy()  # dM_ij/du_k
    christoffel = np.einsum("ijk,j,k->i", slope, V, V) - 0.5 * np.einsum("jki,j,k->i", slope, V, V)
    found = assembled(arm, p, U, 0 * V).force - assembled(arm, p, U, V).force
    # Positions, Jacobians and their rates come from one quadrature: the identity is exact, up to rounding.
    np.testing.assert_allclose(found, christoffel, rtol=0, atol=1e-12 * np.max(np.abs(christoffel)) + 1e-16)


@pytest.mark.parametrize("specimen", SPECIMENS)
def test_gravity_elasticity_and_hardening_are_gradients(parameters, specimen):
    arm = Arm(specimen, WATER, Gravity(0.7), order=3, nodes=10)
    p = parameters(
        elasticity__E=2e5,
        elasticity__k0=0.01,
        cubic_stiffness__beta=0.2,
        intrinsic_curvature__c0=0.3,
        tip_mass__mass=2e-3,
    )
    rule, section, L = arm.rule, specimen.section, specimen.length
    down = torch.tensor([np.sin(0.7), np.cos(0.7)]) * arm.gravity.magnitude

    def potential(u):
        phi = u[3] + torch.from_numpy(arm.angle_basis) @ u[:3]
        tangent = torch.stack([-torch.sin(phi), torch.cos(phi)], -1)
        position = L * torch.from_numpy(rule.integration) @ tangent
        tip = L * torch.from_numpy(rule.weights) @ tangent
        rail = torch.stack([0 * u[4], u[4]])
        line = torch.from_numpy(L * rule.weights * (specimen.density - WATER.density) * section.area(rule.s))
        in_water = (specimen.tip_mass + 2e-3) * (1.0 - WATER.density / specimen.tip_mass_density)
        weight = -(line @ ((position + rail) @ down)) - in_water * (tip + rail) @ down
        bent = torch.from_numpy(arm.curvature_basis) @ u[:3]
        k = torch.from_numpy(2e5 * section.second_moment(rule.s) / L + 0.01)
        c = bent - 0.3  # from the shape in which nothing pulls
        elastic = k * (0.5 * c**2 + 0.2 * c**4 / 4)
        return weight + torch.from_numpy(rule.weights) @ elastic

    gradient = torch.autograd.functional.jacobian(potential, torch.from_numpy(U)).numpy()
    force = assembled(arm, p, U, 0 * V).force
    np.testing.assert_allclose(force, -gradient, rtol=0, atol=1e-12 * np.max(np.abs(gradient)))


def test_affine_stiffness_matrix_is_equation_13(parameters):
    arm = Arm(SPECIMENS[0], order=3, gravity=Gravity(0.0, 0.0))
    p = parameters(elasticity__k0=6.2e-3, elasticity__k1=-4.92e-3)
    q = np.array([0.3, -0.2, 0.1])
    u = np.concatenate([arm.from_monomial @ q, [0.0, 0.0]])
    force = arm.from_monomial.T @ assembled(arm, p, u, 0 * u).force[:3]  # in the paper's coordinates
    K = np.array([[6.2e-3 / (i + j + 1) - 4.92e-3 / (i + j + 2) for j in range(3)] for i in range(3)])
    np.testing.assert_allclose(force, -K @ q, rtol=1e-12)


def test_torch_and_numpy_assemble_alike(parameters):
    arm = Arm(SPECIMENS[1], WATER, Gravity(0.3), order=3)
    p = parameters(elasticity__E=2e5, damping__eta=1e3, drag__C_perp=1.1, current__U_x=0.1, added_mass__C_a=0.9)
    a = assembled(arm, p, U, V)
    b = balance(arm, active_effects(p), torch.from_numpy(p), torch.from_numpy(U), torch.from_numpy(V))
    for name in ("mass_matrix", "force", "fluid_force"):
        expected = getattr(a, name)
        np.testing.assert_allclose(getattr(b, name).numpy(), expected, rtol=0, atol=1e-14 * np.max(np.abs(expected)))


def test_gradients_of_the_assembly_are_right(parameters):
    """d force / d (u, v, parameters) by autodiff against central differences, all of the fluid acting."""
    arm = Arm(SPECIMENS[1], WATER, Gravity(0.3), order=3)
    p = parameters(elasticity__E=2e5, damping__eta=1e3, drag__C_perp=1.1, skin_drag__C_t=0.05, added_mass__C_a=0.9)
    effects = active_effects(p)

    def force(u, v, row):
        return balance(arm, effects, row, u, v).force

    arguments = [torch.from_numpy(a) for a in (U, V, p)]
    jacobians = torch.autograd.functional.jacobian(force, tuple(arguments))
    for k, (argument, jacobian) in enumerate(zip(arguments, jacobians, strict=True)):
        for j in torch.nonzero(argument).flatten().tolist():
            h = 1e-5 * max(abs(argument[j].item()), 1e-3)
            values = []
            for sign in (1, -1):
                moved = [a.clone() for a in arguments]
                moved[k][j] += sign * h
                values.append(force(*moved))
            difference = (values[0] - values[1]) / (2 * h)
            scale = max(float(jacobian.abs().max()), 1e-12)
            assert float((difference - jacobian[:, j]).abs().max()) < 2e-7 * scale + 1e-10


def test_batches_are_the_sum_of_their_members(parameters):
    arm = Arm(SPECIMENS[0], WATER, Gravity(0.3), order=3)
    p = parameters(elasticity__E=2e5, drag__C_perp=1.1, added_mass__C_a=0.9)
    states = np.stack([U, 2 * U, -U])
    together = assembled(arm, p, states, np.stack([V, -V, V]))
    alone = assembled(arm, p, 2 * U, -V)
    # A batched sum may be ordered otherwise: rounding.
    np.testing.assert_allclose(together.force[1], alone.force, rtol=0, atol=1e-14 * np.max(np.abs(alone.force)))

"""The torch simulation against the compiled kernel, its gradients against differences, and the operator."""

import numpy as np
import pytest
import torch
from torch.utils._python_dispatch import TorchDispatchMode
from torch.utils._pytree import tree_leaves

from affine_model.arm import Arm, active_effects, parameter_index
from affine_model.simulate import Rail, Servo, simulate
from affine_model.torch_operator import arm_from_row, arm_row, mean_thrust
from affine_model.torch_simulation import PENALTY, torch_simulate
from tentacle.specimen import WATER, Cone, Gravity, Rectangle, Specimen
from tentacle.waveform import Sine

ARM = Arm(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0, tip_mass=0.001), WATER, Gravity(0.2), order=2, nodes=8)
H, STEPS = 1 / 200, 100
BASE = {"elasticity__E": 2e5, "damping__eta": 2e3, "drag__C_perp": 1.1}
Q0 = np.array([[0.4, -0.2], [-0.3, 0.1]])


def base_motion():
    return Sine(0.5, 1.3, 0.4)((np.arange(STEPS) + 0.5) * H)[:, :, None]


@pytest.mark.parametrize(
    "extra",
    [
        {},
        {"added_mass__C_a": 1.0, "sloshing__U_cos": 0.05, "skin_drag__C_t": 0.05},
        {"viscoelasticity__g": 0.3, "tip_mass__mass": 1e-3, "dry_friction__c_f": 0.02, "stiffness_drift__rate": 0.05},
    ],
)
def test_torch_steps_as_the_kernel_does(parameters, extra):
    p = np.repeat(parameters(**BASE, **extra)[:, None], 2, axis=1)
    p[parameter_index("elasticity", "E"), 1] *= 1.3
    truth = simulate(ARM, p, base_motion(), H, q=Q0, iterations=6)
    found = torch_simulate(ARM, *map(torch.from_numpy, (p, base_motion())), H, q=torch.from_numpy(Q0), iterations=4)
    # Both converge to the same implicit midpoint; dry friction's smoothed sign converges slowest.
    np.testing.assert_allclose(found.q.numpy(), truth.q, atol=2e-8)
    np.testing.assert_allclose(found.q_rate.numpy(), truth.q_rate, atol=2e-6)
    np.testing.assert_allclose(found.t.numpy(), truth.t, atol=1e-12)
    np.testing.assert_allclose(
        found.fluid_force.numpy(), truth.fluid_force, atol=1e-6 * np.abs(truth.fluid_force).max()
    )
    np.testing.assert_allclose(found.mean_thrust.numpy(), truth.mean_thrust, rtol=1e-5)


def test_gradients_through_the_simulation(parameters):
    """d (mean thrust + final shape) / d (parameters, q0, base) by autodiff against central differences."""
    extra = {"added_mass__C_a": 0.8, "viscoelasticity__g": 0.3, "current__U_x": 0.05}
    p = torch.from_numpy(parameters(**BASE, **extra)[:, None])
    inputs = [p, torch.from_numpy(base_motion()[:, :40]), torch.from_numpy(Q0[:, :1])]

    def outcome(row, base, q):
        batch = torch_simulate(ARM, row, base, H, q=q, iterations=4)
        return 100.0 * batch.mean_thrust.sum() + batch.q[-1].sum()

    for tensor in inputs:
        tensor.requires_grad_(True)
    gradients = torch.autograd.grad(outcome(*inputs), inputs)
    rng = np.random.default_rng(3)
    for k, (tensor, gradient) in enumerate(zip(inputs, gradients, strict=True)):
        # Along a random direction, in proportion to each entry's own size.
        direction = tensor.detach() * torch.from_numpy(rng.normal(size=tensor.shape))
        values = []
        for sign in (1, -1):
            moved = [t.detach() for t in inputs]
            moved[k] = moved[k] + sign * 1e-5 * direction
            values.append(float(outcome(*moved)))
        difference = (values[0] - values[1]) / 2e-5
        # Central differences of 1e-5: 1e-9 truncation, 1e-9 rounding.
        assert float((gradient * direction).sum()) == pytest.approx(difference, rel=1e-5)
        assert abs(difference) > 1e-6


def test_servo_and_rail_step_as_in_the_kernel(parameters):
    p = parameters(**BASE, added_mass__C_a=1.0)[:, None]
    servo = Servo(0.8, 0.02, 0.006, integral=0.5)  # the limit is met on the way
    rail = Rail(0.25, 0.35, 0.01)
    truth = simulate(ARM, p, base_motion(), H, servo=servo, rail=rail, iterations=8)
    assert np.max(np.abs(truth.torque)) == pytest.approx(0.006)
    given = map(torch.from_numpy, (p, base_motion()))
    found = torch_simulate(ARM, *given, H, servo=servo, rail=rail, iterations=6)
    for name in ("q", "theta", "rail"):  # both converge to the same implicit midpoint
        np.testing.assert_allclose(getattr(found, name).numpy(), getattr(truth, name), atol=2e-8)


def test_gradients_through_servo_and_rail(parameters):
    p = torch.from_numpy(parameters(**BASE)[:, None])
    base = torch.from_numpy(base_motion()[:, :30])
    servo, rail = Servo(0.8, 0.02, 1.0), Rail(0.25, 0.35)

    def outcome(row):
        return torch_simulate(ARM, row, base, H, servo=servo, rail=rail, iterations=4).rail[-1].sum()

    row = p.clone().requires_grad_(True)
    (gradient,) = torch.autograd.grad(outcome(row), row)
    place = parameter_index("drag", "C_perp")
    moved = [p.index_put((torch.tensor(place), torch.tensor(0)), p[place, 0] + d) for d in (1e-4, -1e-4)]
    difference = float(outcome(moved[0]) - outcome(moved[1])) / 2e-4
    assert float(gradient[place, 0]) == pytest.approx(difference, rel=1e-5)  # truncation 1e-8, rounding 1e-8
    assert abs(difference) > 1e-9


def test_no_tensor_stays_behind_on_the_cpu(parameters, monkeypatch):
    """Every tensor that the simulation makes lies where its parameters do: shown on torch's meta device."""
    p, base = torch.from_numpy(parameters(**BASE)[:, None]), torch.from_numpy(base_motion()[:, :3])
    seen = []

    class Spy(TorchDispatchMode):
        def __torch_dispatch__(self, func, types, args=(), kwargs=None):
            result = func(*args, **(kwargs or {}))
            seen.extend(t.device.type for t in tree_leaves((args, result)) if isinstance(t, torch.Tensor) and t.dim())
            return result

    effects = active_effects(p.numpy())
    monkeypatch.setattr("affine_model.torch_simulation.active_effects", lambda _: effects)
    monkeypatch.setattr(torch.Tensor, "cpu", lambda tensor: torch.zeros(tensor.shape))
    fake = [tensor.to("meta") for tensor in (p, base)]
    torch_simulate(ARM, *fake, H, stride=0)  # constants moved there once
    with Spy():
        batch = torch_simulate(ARM, *fake, H, stride=0)
    assert batch.mean_thrust.device.type == "meta"
    computed = seen.count("meta")
    assert computed > 1000
    # What remains are tables built on the CPU and moved as a whole.
    assert seen.count("cpu") < 40


def test_a_diverging_individual_gets_the_penalty_and_disturbs_no_other(parameters):
    sound, mad = parameters(**BASE), parameters(**{**BASE, "damping__eta": -5e5})
    alone = torch_simulate(ARM, torch.from_numpy(np.stack([sound, sound], 1)), torch.from_numpy(base_motion()), H)
    row = torch.from_numpy(np.stack([sound, mad], 1)).requires_grad_(True)
    mixed = torch_simulate(ARM, row, torch.from_numpy(base_motion()), H)
    assert mixed.mean_thrust[1].item() == PENALTY
    assert mixed.reasons[0] == ""
    assert "at t = " in mixed.reasons[1]
    # Rounding: batched products may be ordered otherwise.
    torch.testing.assert_close(mixed.q[:, :, 0], alone.q[:, :, 0], rtol=1e-10, atol=1e-12)
    (gradient,) = torch.autograd.grad(mixed.mean_thrust[0], row)
    assert torch.isfinite(gradient[:, 0]).all()


def test_the_operator_is_the_kernel(parameters):
    p = np.repeat(parameters(**BASE)[:, None], 3, axis=1)
    p[parameter_index("damping", "eta"), 1] = -5e5
    found = mean_thrust(ARM, torch.from_numpy(p), torch.from_numpy(base_motion()), H, average_from=0.2)
    truth = simulate(ARM, p, base_motion(), H, average_from=0.2).mean_thrust
    assert found[0].item() == truth[0]
    assert found[1].item() == PENALTY
    row = torch.from_numpy(p[:, :1]).requires_grad_(True)
    (gradient,) = torch.autograd.grad(mean_thrust(ARM, row, torch.from_numpy(base_motion()), H).sum(), row)
    place = parameter_index("drag", "C_perp")
    ahead, behind = p[:, :1].copy(), p[:, :1].copy()
    ahead[place], behind[place] = ahead[place] + 1e-3, behind[place] - 1e-3
    values = [simulate(ARM, row, base_motion(), H).mean_thrust[0] for row in (ahead, behind)]
    # One Newton correction forward, two in the graph: they differ by the square of the predictor's error.
    assert gradient[place, 0].item() == pytest.approx((values[0] - values[1]) / 2e-3, rel=1e-3)
    torch.library.opcheck(
        torch.ops.tentacle.mean_thrust.default,
        (arm_row(ARM), torch.from_numpy(p), torch.from_numpy(base_motion()), H, 0.2, PENALTY),
        test_utils=("test_schema", "test_faketensor"),
    )


def test_an_arm_survives_its_row():
    for section in (Cone(0.01, 0.002), Rectangle(0.02, 0.004)):
        arm = Arm(Specimen(section, 0.2, 1100.0, 1e-3), WATER, Gravity(0.3, 9.0), order=3, nodes=9)
        assert arm_from_row(arm_row(arm)) == arm


@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a CUDA device")
def test_the_gpu_gives_what_the_cpu_gives(parameters):
    p = torch.from_numpy(np.repeat(parameters(**BASE, added_mass__C_a=1.0)[:, None], 64, axis=1))
    base = torch.from_numpy(base_motion())
    cpu = torch_simulate(ARM, p, base, H)
    gpu = torch_simulate(ARM, p.cuda(), base.cuda(), H)  # no gradient: the captured graph
    torch.testing.assert_close(gpu.q.cpu(), cpu.q, rtol=1e-8, atol=1e-10)
    on_graph = mean_thrust(ARM, p.cuda(), base.cuda(), H)
    torch.testing.assert_close(on_graph.cpu(), cpu.mean_thrust, rtol=1e-8, atol=1e-12)
    row = p.cuda().requires_grad_(True)
    (gradient,) = torch.autograd.grad(torch_simulate(ARM, row, base.cuda()[:, :20], H).mean_thrust.sum(), row)
    assert torch.isfinite(gradient).all()

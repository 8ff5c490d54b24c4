"""The torch operator against the compiled kernel, and its gradients against differences of the whole simulation."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from affine_model.advance import PRESCRIBED, Drive, Pace
from affine_model.arm import Arm, parameter_index
from affine_model.simulate import Rail, Servo, Start, Timing, simulate
from affine_model.torch_adjoint import pace_row
from affine_model.torch_advance import arm_from_row, arm_row, drive_from_row, drive_row
from affine_model.torch_operator import mean_thrust
from affine_model.torch_simulation import DIVERGED_THRUST, torch_simulate
from tentacle.errors import InputError
from tentacle.specimen import WATER, Cone, Gravity, Rectangle, Specimen
from tentacle.waveform import Sine

ARM = Arm(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0, tip_mass=0.001), WATER, Gravity(0.2), order=2, nodes=8)
# Behind a clamp that gives, with sections that shear.
GIVING = replace(ARM, specimen=replace(ARM.specimen, clamp_length=0.01, shear_compliance=1.0))
H, STEPS = 1 / 200, 60
BASE = {"elasticity__E": 2e5, "damping__eta": 2e3, "drag__C_perp": 1.1}
Q0 = np.array([[0.4, -0.2], [-0.3, 0.1]])
SERVO, RAIL = Servo(0.8, 0.02, 1.0, integral=0.5), Rail(0.25, 0.35, 0.01)


def base_motion(steps=STEPS):
    return Sine(0.5, 1.3, 0.4)((np.arange(steps) + 0.5) * H)[:, :, None]


@pytest.mark.parametrize(("arm", "drive"), [(ARM, PRESCRIBED), (ARM, Drive(SERVO, RAIL)), (GIVING, Drive(SERVO, RAIL))])
def test_forward_is_the_kernels_own(parameters, arm, drive):
    p = np.repeat(parameters(**BASE, added_mass__C_a=1.0, viscoelasticity__g=0.2)[:, None], 2, axis=1)
    p[parameter_index("elasticity", "E"), 1] *= 1.3
    truth = simulate(arm, p, base_motion(), Timing(H, 5, 0.1), start=Start(Q0, memory=0.5 * Q0), drive=drive)
    given = map(torch.from_numpy, (p, base_motion()))
    start = Start(torch.from_numpy(Q0), memory=torch.from_numpy(0.5 * Q0))
    found = torch_simulate(arm, *given, Timing(H, 5, 0.1), start=start, drive=drive)
    for name in ("t", "q", "q_rate", "theta", "rail", "fluid_force", "load", "torque", "mean_thrust", "mean_power"):
        np.testing.assert_allclose(getattr(found, name).numpy(), getattr(truth, name), rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize(
    ("arm", "extra", "drive"),
    [
        (ARM, {"added_mass__C_a": 0.8, "viscoelasticity__g": 0.3, "current__U_x": 0.05}, PRESCRIBED),
        (ARM, {"added_mass__C_a": 1.0, "sloshing__U_cos": 0.05, "stiffness_drift__rate": 0.05}, Drive(servo=SERVO)),
        (ARM, {"tip_mass__mass": 1e-3, "skin_drag__C_t": 0.05}, Drive(rail=RAIL)),
        (GIVING, {"viscoelasticity__g": 0.3}, PRESCRIBED),
    ],
)
def test_gradients_at_the_default_of_one_iteration(parameters, arm, extra, drive):
    """Along random directions, against fourth-order central differences of the operator's own forward."""
    p = parameters(**BASE, **extra)[:, None]
    inputs = [torch.from_numpy(x.copy()).requires_grad_(True) for x in (p, base_motion(), Q0[:, :1])]

    def outcome(row, base, q):
        batch = torch_simulate(arm, row, base, Timing(H, 2, 0.1), start=Start(q), drive=drive)
        forces = batch.fluid_force[7].sum() + 10.0 * batch.torque[20].sum() + batch.mean_power.sum()
        return 100.0 * batch.mean_thrust.sum() + batch.q[-1].sum() + 3.0 * batch.rail_rate[-1].sum() + forces

    gradients = torch.autograd.grad(outcome(*inputs), inputs)
    rng = np.random.default_rng(3)
    for k, (tensor, gradient) in enumerate(zip(inputs, gradients, strict=True)):
        direction = tensor.detach() * torch.from_numpy(rng.normal(size=tensor.shape))
        values = []
        for offset in (2, 1, -1, -2):
            moved = [t.detach() for t in inputs]
            moved[k] = moved[k] + offset * 1e-5 * direction
            values.append(float(outcome(*moved)))
        difference = (8.0 * (values[1] - values[2]) - (values[0] - values[3])) / 12e-5
        assert abs(difference) > 1e-6
        assert float((gradient * direction).sum()) == pytest.approx(difference, rel=1e-6)


def test_no_gradient_where_the_base_travels(parameters):
    row = torch.from_numpy(parameters(**BASE)[:, None]).requires_grad_(True)
    base = np.concatenate([base_motion(), np.zeros((6, STEPS, 1))])
    batch = torch_simulate(ARM, row, torch.from_numpy(base), Timing(H))
    with pytest.raises(InputError, match="the base travels"):
        batch.mean_thrust.sum().backward()


def test_a_diverging_individual_gets_the_penalty_and_disturbs_no_other(parameters):
    sound, mad = parameters(**BASE), parameters(**{**BASE, "damping__eta": -5e5})
    alone = torch_simulate(
        ARM, torch.from_numpy(np.stack([sound, sound], 1)), torch.from_numpy(base_motion()), Timing(H)
    )
    row = torch.from_numpy(np.stack([sound, mad], 1)).requires_grad_(True)
    mixed = torch_simulate(ARM, row, torch.from_numpy(base_motion()), Timing(H))
    assert mixed.mean_thrust[1].item() == DIVERGED_THRUST
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
    truth = simulate(ARM, p, base_motion(), Timing(H, average_from=0.2)).mean_thrust
    assert found[0].item() == truth[0]
    assert found[1].item() == DIVERGED_THRUST
    still = [torch.zeros(*shape, 3, dtype=torch.float64) for shape in ((), (4,), (4,), (9,), (2, 8))]
    torch.library.opcheck(
        torch.ops.tentacle.advance.default,
        (
            [arm_row(ARM), drive_row(Drive())], torch.from_numpy(p), torch.from_numpy(base_motion()), still,
            pace_row(Pace(H, 5, 20, complete=True)),
        ),
        test_utils=("test_schema", "test_faketensor"),
    )  # fmt: skip


def test_arm_and_drive_survive_their_rows():
    for section in (Cone(0.01, 0.002), Rectangle(0.02, 0.004)):
        arm = Arm(Specimen(section, 0.2, 1100.0, 1e-3), WATER, Gravity(0.3, 9.0), order=3, nodes=9)
        assert arm_from_row(arm_row(arm)) == arm
    for drive in (Drive(), Drive(SERVO, RAIL)):
        assert drive_from_row(drive_row(drive)) == drive


@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a CUDA device")
def test_the_gpu_gives_what_the_cpu_gives(parameters):
    p = torch.from_numpy(np.repeat(parameters(**BASE, added_mass__C_a=1.0)[:, None], 64, axis=1))
    base = torch.from_numpy(base_motion())
    cpu, gpu = torch_simulate(ARM, p, base, Timing(H)), torch_simulate(ARM, p.cuda(), base.cuda(), Timing(H))
    torch.testing.assert_close(gpu.q.cpu(), cpu.q, rtol=1e-9, atol=1e-11)
    torch.testing.assert_close(gpu.mean_thrust.cpu(), cpu.mean_thrust, rtol=1e-9, atol=1e-13)
    rows = [t.clone().requires_grad_(True) for t in (p, p.cuda())]
    gradients = [
        torch.autograd.grad(mean_thrust(ARM, row, base.to(row.device)[:, :20], H).sum(), row)[0] for row in rows
    ]
    torch.testing.assert_close(gradients[1].cpu(), gradients[0], rtol=1e-6, atol=1e-12)

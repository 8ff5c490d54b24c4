"""The mean thrust of a batch as one torch operator: on the CPU the compiled kernel, on a GPU the captured torch step.

Forward it runs the compiled kernel; backward, which the kernel cannot, it runs affine_model.torch_simulation once more
with its graph. Both take the same steps, so the gradient is that of what was computed, to the order of one Newton
correction; it costs what the torch simulation costs.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from affine_model.arm import Arm
from affine_model.simulate import simulate
from affine_model.torch_simulation import PENALTY, torch_simulate
from tentacle.specimen import Cone, Fluid, Gravity, Rectangle, Specimen


def arm_row(arm: Arm) -> Tensor:
    """The arm as a row of numbers, since an operator of torch takes only tensors and numbers."""
    section = arm.specimen.section
    if isinstance(section, Cone):
        shape = [0.0, section.base_radius, section.tip_radius]
    else:
        shape = [1.0, section.section_width, section.height]
    specimen, gravity = arm.specimen, arm.gravity
    payload = [specimen.tip_mass, specimen.tip_mass_reach, specimen.tip_mass_drop, specimen.tip_mass_density]
    whole = [specimen.length, specimen.density, *payload, arm.fluid.density, gravity.angle, gravity.magnitude]
    return torch.tensor([*shape, *whole, float(arm.order), float(arm.nodes)], dtype=torch.float64)


def arm_from_row(row: Tensor) -> Arm:
    """The arm of a row of numbers."""
    kind, a, b, length, density, *payload, fluid, angle, magnitude, order, nodes = row.tolist()
    mass, reach, drop, of_payload = payload
    section = Cone(a, b) if kind == 0.0 else Rectangle(a, b)
    specimen = Specimen(section, length, density, mass, "section", reach, drop, of_payload)
    return Arm(specimen, Fluid(fluid), Gravity(angle, magnitude), int(order), int(nodes))


@torch.library.custom_op("tentacle::mean_thrust", mutates_args=(), device_types="cpu")
def _mean_thrust(
    row: Tensor, parameters: Tensor, base: Tensor, step: float, average_from: float, penalty: float
) -> Tensor:
    batch = simulate(arm_from_row(row), parameters.numpy(), base.numpy(), step, stride=0, average_from=average_from)
    return torch.nan_to_num(torch.from_numpy(batch.mean_thrust), nan=penalty).to(parameters.dtype)


@_mean_thrust.register_kernel("cuda")
def _mean_thrust_cuda(
    row: Tensor, parameters: Tensor, base: Tensor, step: float, average_from: float, penalty: float
) -> Tensor:
    with torch.no_grad():
        batch = torch_simulate(
            arm_from_row(row), parameters, base, step, stride=0, average_from=average_from, penalty=penalty
        )
    return batch.mean_thrust


@_mean_thrust.register_fake
def _mean_thrust_shape(
    row: Tensor, parameters: Tensor, base: Tensor, step: float, average_from: float, penalty: float
) -> Tensor:
    del row, base, step, average_from, penalty
    return parameters.new_empty(parameters.shape[1])


def _remember(ctx: Any, inputs: tuple[Any, ...], output: Tensor) -> None:
    del output
    row, parameters, base, *ctx.numbers = inputs
    ctx.save_for_backward(row, parameters, base)


def _backward(ctx: Any, gradient: Tensor) -> tuple[Tensor | None, ...]:
    row, *saved = ctx.saved_tensors
    step, average_from, penalty = ctx.numbers
    wanted = ctx.needs_input_grad[1:3]
    with torch.enable_grad():
        inputs = [tensor.detach().requires_grad_(needed) for tensor, needed in zip(saved, wanted, strict=True)]
        batch = torch_simulate(
            arm_from_row(row), inputs[0], inputs[1], step, stride=0, average_from=average_from, penalty=penalty
        )
    asked = [tensor for tensor, needed in zip(inputs, wanted, strict=True) if needed]
    found = iter(torch.autograd.grad(batch.mean_thrust, asked, gradient))
    return None, *(next(found) if needed else None for needed in wanted), None, None, None


_mean_thrust.register_autograd(_backward, setup_context=_remember)


def mean_thrust(
    arm: Arm, parameters: Tensor, base: Tensor, step: float, *, average_from: float = 0.0, penalty: float = PENALTY
) -> Tensor:
    """Mean thrust (B,) [N] from average_from [s] on; parameters (R, B), base (3, S, B or 1), as simulate takes them.

    `penalty` [N] stands for an individual that diverged. Gradients flow to parameters and base. Works under
    torch.compile.
    """
    return _mean_thrust(arm_row(arm), parameters, base, step, average_from, penalty)

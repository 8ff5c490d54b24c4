"""The mean thrust of a batch as one torch operator: on the CPU the compiled kernel, on a GPU the captured torch step.

It gives no gradient: for that, affine_model.torch_simulation.
"""

from __future__ import annotations

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
    whole = [specimen.length, specimen.density, specimen.tip_mass, arm.fluid.density, gravity.angle, gravity.magnitude]
    return torch.tensor([*shape, *whole, float(arm.order), float(arm.nodes)], dtype=torch.float64)


def arm_from_row(row: Tensor) -> Arm:
    """The arm of a row of numbers."""
    kind, a, b, length, density, tip_mass, fluid, angle, magnitude, order, nodes = row.tolist()
    section = Cone(a, b) if kind == 0.0 else Rectangle(a, b)
    specimen = Specimen(section, length, density, tip_mass)
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


def mean_thrust(
    arm: Arm, parameters: Tensor, base: Tensor, step: float, *, average_from: float = 0.0, penalty: float = PENALTY
) -> Tensor:
    """Mean thrust (B,) [N] from average_from [s] on; parameters (R, B), base (3, S, B or 1), as simulate takes them.

    `penalty` [N] stands for an individual that diverged. Works under torch.compile.
    """
    return _mean_thrust(arm_row(arm), parameters, base, step, average_from, penalty)

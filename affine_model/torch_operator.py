"""The mean thrust of a batch as one differentiable function of tensors, for optimisers that need only this number."""

from __future__ import annotations

from torch import Tensor

from affine_model.arm import Arm
from affine_model.simulate import Timing
from affine_model.torch_simulation import torch_simulate


def mean_thrust(arm: Arm, parameters: Tensor, base: Tensor, step: float, *, average_from: float = 0.0) -> Tensor:
    """Mean thrust (B,) [N] from average_from [s] on; parameters (R, B), base (3, S, B or 1), as simulate takes them.

    PENALTY stands for an individual that diverged. Gradients flow to parameters and base. Works under
    torch.compile.
    """
    batch = torch_simulate(arm, parameters, base, Timing(step, 0, average_from))
    return batch.mean_thrust

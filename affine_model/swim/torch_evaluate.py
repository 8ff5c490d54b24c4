"""evaluate as one torch operator, `tentacle::swim`: the compiled kernel on the CPU, one fused Warp kernel on CUDA.

The population is a tensor of (individuals, genes). On the CPU its memory is read where it lies; on CUDA every thread
computes its own gait and its own arm, so that a million gaits need no table of base motions.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor

from affine_model.advance import Drive, Pace
from affine_model.arm import Arm
from affine_model.curvature import Array
from affine_model.swim.evaluate import ROWS, Bounds, evaluate
from affine_model.swim.torch_gait import gait_rows
from affine_model.torch_advance import arm_from_row, arm_row, drive_from_row, drive_row


def _timing(numbers: list[float]) -> tuple[float, tuple[Pace, int]]:
    """The servo's bandwidth [Hz], and the pace with the number of steps, of a row of numbers."""
    bandwidth, step, steps, average_from = numbers
    return bandwidth, (Pace(step, 2, int(average_from)), int(steps))


@torch.library.custom_op("tentacle::swim", mutates_args=(), device_types="cpu")
def _swim(rows: list[Tensor], genes: Tensor, parameters: Tensor, kinematic: Tensor, numbers: list[float]) -> Tensor:
    bandwidth, timing = _timing(numbers)
    own, given = (arm_from_row(rows[0]), drive_from_row(rows[1])), (genes.numpy(), parameters.numpy())
    return torch.from_numpy(evaluate(*own, *given, Bounds(kinematic.numpy(), bandwidth), timing))


@_swim.register_kernel("cuda")
def _swim_cuda(
    rows: list[Tensor], genes: Tensor, parameters: Tensor, kinematic: Tensor, numbers: list[float]
) -> Tensor:
    from affine_model.gpu import swim_on_device

    bandwidth, timing = _timing(numbers)
    own, limits = (arm_from_row(rows[0]), drive_from_row(rows[1])), (kinematic.to(genes.device), bandwidth)
    columns = [swim_on_device(*own, sample, genes, limits, timing) for sample in parameters.unbind(1)]
    return torch.stack(columns, dim=2)


@_swim.register_fake
def _swim_shape(
    rows: list[Tensor], genes: Tensor, parameters: Tensor, kinematic: Tensor, numbers: list[float]
) -> Tensor:
    del rows, kinematic, numbers
    return genes.new_empty(ROWS, genes.shape[0], parameters.shape[1])


def _remember(ctx: Any, inputs: tuple[Any, ...], output: Tensor) -> None:
    del output
    rows, genes, parameters, kinematic, ctx.numbers = inputs
    ctx.save_for_backward(*rows, genes, parameters, kinematic)


def _backward(ctx: Any, gradient: Tensor) -> tuple[Any, ...]:
    arm, drive, genes, parameters, kinematic = ctx.saved_tensors
    bandwidth, timing = _timing(ctx.numbers)
    wanted = ctx.needs_input_grad[1:3]
    with torch.enable_grad():
        given = [part.detach().requires_grad_(asked) for part, asked in zip((genes, parameters), wanted, strict=True)]
        limits = kinematic, bandwidth
        found = gait_rows(arm_from_row(arm), drive_from_row(drive), given[0], given[1], limits, timing)
        asked = [part for part in given if part.requires_grad]
        slopes = iter(torch.autograd.grad(found, asked, gradient))
    return [None, None], *(next(slopes) if part.requires_grad else None for part in given), None, None


_swim.register_autograd(_backward, setup_context=_remember)


def population(genes: Array, device: str) -> Tensor:
    """The tensor (individuals, genes) of an array (B, 9): on the CPU of the same memory."""
    return torch.from_numpy(np.ascontiguousarray(genes)).to(device)


def swum(arm: Arm, drive: Drive, genes: Tensor, parameters: Tensor, bounds: Bounds, timing: tuple[Pace, int]) -> Tensor:
    """affine_model.swim.evaluate.evaluate of a population (B, 9), on the device where it lies. Gradients flow to genes
    and parameters (affine_model.swim.torch_gait).
    """
    pace, steps = timing
    kinematic = torch.from_numpy(bounds.kinematic)
    numbers = [bounds.bandwidth, pace.step, float(steps), float(pace.average_from)]
    return _swim([arm_row(arm), drive_row(drive)], genes, parameters, kinematic, numbers)

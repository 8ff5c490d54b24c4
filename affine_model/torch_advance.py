"""The batch simulation as one torch operator, `tentacle::advance`: the compiled kernel on the CPU, a generated Warp
kernel on CUDA (affine_model.gpu), and a gradient on both.

On the CPU nothing is copied: the kernel reads and writes the tensors' own memory. The gradient is that of what was
computed, one Newton correction a step included (affine_model.torch_adjoint).
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import torch
from torch import Tensor

from affine_model.advance import Drive, Pace, Rail, Servo, State, advance
from affine_model.arm import Arm
from affine_model.torch_adjoint import WantedGradients, pace_row, pulled_back
from tentacle.errors import InputError
from tentacle.specimen import Cone, Fluid, Gravity, Rectangle, Specimen

Outputs = tuple[Tensor, Tensor, Tensor, Tensor, Tensor, Tensor]


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
    held = [float(arm.order), float(arm.nodes), specimen.clamp_length, specimen.shear_compliance]
    return torch.tensor([*shape, *whole, *held], dtype=torch.float64)


def arm_from_row(row: Tensor) -> Arm:
    """The arm of a row of numbers."""
    return _arm(tuple(row.tolist()))


@lru_cache(maxsize=64)
def _arm(row: tuple[float, ...]) -> Arm:
    kind, a, b, length, density, *payload, fluid, angle, magnitude, order, nodes, clamp, shear = row
    mass, reach, drop, of_payload = payload
    section = Cone(a, b) if kind == 0.0 else Rectangle(a, b)
    rigid = Specimen(section, length, density, mass, "section", reach, drop, of_payload)
    specimen = replace(rigid, clamp_length=clamp, shear_compliance=shear)
    return Arm(specimen, Fluid(fluid), Gravity(angle, magnitude), int(order), int(nodes))


def drive_row(drive: Drive) -> Tensor:
    """Servo and rail as a row of 11 numbers, each behind a flag that says whether it is there; InputError on a hull."""
    if drive.hull is not None:
        raise InputError(
            "a free hull swims in the compiled kernel alone", field="drive", expected="a base that is held"
        )
    servo, rail = drive.rows()
    flags = float(drive.servo is not None), float(drive.rail is not None)
    return torch.tensor([flags[0], *servo, flags[1], *rail], dtype=torch.float64)


def drive_from_row(row: Tensor) -> Drive:
    """The drive of a row of numbers."""
    driven, stiffness, integral, damping, limit, rotor, slides, *rail = row.tolist()
    servo = Servo(stiffness, damping, limit, integral, rotor) if driven else None
    return Drive(servo, Rail(*rail) if slides else None)


def pace_of(numbers: list[float]) -> Pace:
    """The pace of a row of numbers."""
    step, *counts = numbers
    stride, average_from, iterations, age, complete, every_effect = map(int, counts)
    return Pace(step, stride, average_from, iterations, age, bool(complete), bool(every_effect))


@torch.library.custom_op("tentacle::advance", mutates_args=(), device_types="cpu")
def _advance(rows: list[Tensor], parameters: Tensor, base: Tensor, start: list[Tensor], pace: list[float]) -> Outputs:
    times, *state = (tensor.contiguous().numpy() for tensor in start)
    given = [tensor.contiguous().numpy() for tensor in (parameters, base)]
    arm, drive = arm_from_row(rows[0]), drive_from_row(rows[1])
    course = advance(arm, drive, given[0], given[1], (times, State(*state)), pace_of(pace))
    whole = (course.u, course.u_rate, course.force, course.past, course.store, course.summary)
    a, b, c, d, e, f = (torch.from_numpy(array) for array in whole)
    return a, b, c, d, e, f


@_advance.register_kernel("cuda")
def _advance_cuda(
    rows: list[Tensor], parameters: Tensor, base: Tensor, start: list[Tensor], pace: list[float]
) -> Outputs:
    from affine_model.gpu import advance_on_device

    arm, drive = arm_from_row(rows[0]), drive_from_row(rows[1])
    return advance_on_device(arm, drive, parameters, base, tuple(start), pace_of(pace))


@_advance.register_fake
def _advance_shapes(
    rows: list[Tensor], parameters: Tensor, base: Tensor, start: list[Tensor], pace: list[float]
) -> Outputs:
    del rows
    _, u, _, past, store = start
    stride = int(pace[1])
    count, kept = parameters.shape[1], base.shape[1] // stride if stride else 0
    whole = kept if pace[5] else 0
    motion = parameters.new_empty(kept + 1, u.shape[0], count)
    return (
        motion,
        torch.empty_like(motion),
        parameters.new_empty(max(kept, 1), 4, count),
        parameters.new_empty(whole, past.shape[0], count),
        parameters.new_empty(whole, *store.shape[:2], count),
        parameters.new_empty(5 + 2 * u.shape[0], count),
    )


def _remember(ctx: Any, inputs: tuple[Any, ...], output: Outputs) -> None:
    del output
    rows, parameters, base, start, ctx.pace = inputs
    ctx.save_for_backward(*rows, parameters, base, *start)


def _backward(ctx: Any, *gradients: Tensor) -> tuple[Any, ...]:
    arm, drive, *tensors = ctx.saved_tensors
    if tensors[1].shape[0] > 3:
        raise InputError("no gradient where the base travels", field="base", expected="3 rows: the base only turns")

    def run(parameters: Tensor, base: Tensor, start: list[Tensor], pace: list[float]) -> Outputs:
        return _advance([arm, drive], parameters, base, start, pace)

    with torch.no_grad():
        wanted = WantedGradients(gradients, (ctx.needs_input_grad[1], ctx.needs_input_grad[2]))
        found = pulled_back(run, arm_from_row(arm), drive_from_row(drive), tensors, pace_of(ctx.pace), wanted)
    of_parameters, of_base, *of_start = found
    return [None, None], of_parameters, of_base, of_start, None


_advance.register_autograd(_backward, setup_context=_remember)


def advanced(
    arm: Arm, drive: Drive, parameters: Tensor, base: Tensor, start: tuple[Tensor, ...], pace: Pace
) -> Outputs:
    """affine_model.advance.advance on tensors of one device, float64: (u, u_rate, force, past, store, summary).

    start: times (B,), u, u_rate, past, store. Gradients flow from all outputs except past and store to parameters,
    base, u, u_rate, past and store; InputError in the backward pass where the base travels (9 rows). Works under
    torch.compile.
    """
    return _advance([arm_row(arm), drive_row(drive)], parameters, base, list(start), pace_row(pace))

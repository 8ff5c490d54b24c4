"""The gradient of the computed simulation, by reverse accumulation over the kernel's own steps.

One step maps (state, parameters, base) to (state, forces). Its Jacobian J_k comes from central differences of that one
step, for all steps, directions and individuals in a few batches of the kernel. Then, from the last step to the first,

    lambda_k = J_k' (lambda_(k+1), d L / d forces_k) + d L / d state_k        (discrete adjoint)

The implicit function theorem would be exact only where Newton has converged. With the default of one correction a step
it is wrong by several per cent of the gradient; the Jacobian of the computed steps is not. A difference over one smooth
step loses about 1e-9 of the Jacobian; no difference is taken over the whole simulation. Across a kink (a servo at its
limit, a friction element that yields) the difference gives a value between the two slopes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from affine_model.advance import Drive, Pace
from affine_model.arm import Arm, active_effects, parameter_rows
from affine_model.dynamics import remembering
from affine_model.effects import catalogue

RELATIVE_OFFSET = 1e-5  # of a quantity's own size: truncation ~ offset^2, rounding ~ 1e-16 / offset
LANES = 16384  # single steps a batch of the kernel
MEAN_ROWS = 4  # rows of the summary that are means over the steps
AdjointRun = Callable[..., tuple[Tensor, ...]]


def pace_row(pace: Pace) -> list[float]:
    """The pace as a row of numbers, since an operator of torch takes only tensors and numbers."""
    counts = pace.stride, pace.average_from, pace.iterations, pace.age, pace.complete, pace.every_effect
    return [pace.step, *map(float, counts)]


@dataclass(frozen=True)
class _Columns:
    """What a step depends on: rows of the state, of the parameters and of the base that are moved, one at a time."""

    state: list[int]
    parameters: list[int]
    base: list[int]

    def __len__(self) -> int:
        return len(self.state) + len(self.parameters) + len(self.base)


@dataclass(frozen=True)
class _Inputs:
    """times (B,), state (X, B) with X rows u, u_rate, past and store; parameters (R, B), base (3, B), of single steps;
    any further axes between.
    """

    times: Tensor
    state: Tensor
    parameters: Tensor
    base: Tensor


def _columns(arm: Arm, drive: Drive, parameters: Tensor, of_parameters: bool, of_base: bool) -> _Columns:
    """State that is free to move; parameters of acting effects, and strengths of the others (their shapes mean
    nothing while the strengths are zero).
    """
    n = arm.order
    moving = [*range(n), *([n] if drive.servo else []), *([n + 1] if drive.rail else [])]
    size = n + 2
    state = [part * size + k for part in range(4) for k in moving]
    first = 4 * size + 1
    state += [first - 1] if drive.servo and drive.servo.integral else []
    acting = {effect.name for effect in active_effects(parameters.cpu().numpy())}
    for slot, effect in enumerate(remembering(tuple(catalogue().values()))):
        if effect.name in acting:
            state += range(first + slot * arm.node_count, first + (slot + 1) * arm.node_count)
    rows = [row.index for row in parameter_rows() if row.effect in acting or not row.parameter.scan]
    return _Columns(state, rows if of_parameters else [], [0, 1, 2] if of_base else [])


def _offsets(parameters: Tensor, h: float, size: int, rows: int) -> tuple[Tensor, Tensor, Tensor]:
    """Sizes by which state (X, 1), parameters (R, B) and base (3, 1) are moved."""
    state = parameters.new_full((rows, 1), RELATIVE_OFFSET)
    state[2 * size : 4 * size] = RELATIVE_OFFSET / h  # accelerations: as far as they move the rates in a step
    nominal = parameters.new_tensor([row.parameter.nominal for row in parameter_rows()])
    own = RELATIVE_OFFSET * torch.maximum(parameters.abs(), nominal.abs()[:, None])
    return state, own, parameters.new_tensor([[RELATIVE_OFFSET], [RELATIVE_OFFSET], [RELATIVE_OFFSET / h]])


def _split(arm: Arm, state: Tensor) -> tuple[Tensor, ...]:
    """u, u_rate, past, store (S, N, ...) of rows (X, ...)."""
    size = arm.order + 2
    u, u_rate, past, store = state.split([size, size, 2 * size + 1, state.shape[0] - 4 * size - 1])
    return u, u_rate, past, store.unflatten(0, (-1, arm.node_count))


def _single_steps(run: AdjointRun, arm: Arm, given: _Inputs, pace: Pace) -> Tensor:
    """(X + 4 + 4, ...): state after, forces and the summary's means of one step each; all axes of `given` are lanes."""
    lanes = given.state.shape[1:]
    flat = [tensor.reshape(tensor.shape[0], -1) for tensor in (given.state, given.parameters, given.base)]
    u, u_rate, past, store = _split(arm, flat[0])
    starts = [part.contiguous() for part in (given.times.reshape(-1), u, u_rate, past, store)]
    single = replace(pace, stride=1, average_from=0, complete=True)
    base = flat[2][:, None].contiguous()
    u, u_rate, force, past, store, summary = run(flat[1], base, starts, pace_row(single))
    after = torch.cat([u[1], u_rate[1], past[0], store[0].flatten(0, 1), force[0], summary[:MEAN_ROWS]])
    return after.reshape(-1, *lanes)


def _jacobians(run: AdjointRun, arm: Arm, drive: Drive, given: _Inputs, columns: _Columns, pace: Pace) -> Tensor:
    """d (state, forces, sums) / d column (C, rows, K, B) of K steps; given has axes (rows, K, B)."""
    size, doubled = arm.order + 2, 2 * len(columns)
    moved = _Inputs(
        *(
            tensor[..., None, :, :].repeat(*[1] * (tensor.dim() - 2), doubled, 1, 1)
            for tensor in (given.times, given.state, given.parameters, given.base)
        )
    )
    of_state, of_parameters, of_base = _offsets(given.parameters.flatten(1), pace.step, size, given.state.shape[0])
    if drive.rail is not None and drive.rail.dry:  # its friction turns around within the slip speed
        of_state[size + size - 1 : 4 * size : size] *= drive.rail.slip_speed
    parts = (
        (moved.state, columns.state, of_state[:, None].expand(-1, *given.state.shape[1:])),
        (moved.parameters, columns.parameters, of_parameters.reshape(given.parameters.shape)),
        (moved.base, columns.base, of_base[:, None].expand(-1, *given.base.shape[1:])),
    )
    widths, place = [], 0
    for tensor, rows, offsets in parts:
        for row in rows:
            tensor[row, place] += offsets[row]
            tensor[row, place + 1] -= offsets[row]
            widths.append(tensor[row, place] - tensor[row, place + 1])
            place += 2
    after = _single_steps(run, arm, moved, pace).movedim(1, 0)
    return (after[0::2] - after[1::2]) / torch.stack(widths)[:, None]


@dataclass(frozen=True)
class WantedGradients:
    """Gradients of a loss by the outputs of advance, and whether its gradient by the parameters and by the base is
    asked for.
    """

    gradients: Sequence[Tensor | None]
    inputs: tuple[bool, bool]


def pulled_back(
    run: AdjointRun, arm: Arm, drive: Drive, tensors: Sequence[Tensor], pace: Pace, wanted: WantedGradients
) -> tuple[Tensor | None, ...]:
    """Gradients of parameters, base, times (None), u, u_rate, past and store from those of advance's outputs.

    run(parameters, base, start, pace_row(pace)) is the operator.
    """
    parameters, base, times, *start = tensors
    count, steps, size = parameters.shape[1], base.shape[1], arm.order + 2
    single = replace(pace, stride=1, average_from=0, complete=True)
    whole = run(parameters, base, [times, *start], pace_row(single))
    first = torch.cat([start[0], start[1], start[2], start[3].flatten(0, 1)])
    later = torch.cat([whole[0][1:], whole[1][1:], whole[3], whole[4].flatten(1, 2)], 1)
    states = torch.cat([first[None], later]).movedim(0, 1)  # (X, S + 1, B)
    rows = states.shape[0]
    columns = _columns(arm, drive, parameters, *wanted.inputs)
    pull = _Pull(pace, steps, size, wanted.gradients, whole[5][4] < 0.0)
    adjoint = pull.at_end(parameters.new_zeros(rows, count))
    of_parameters, of_base = torch.zeros_like(parameters), parameters.new_zeros(3, steps, count)
    table = base.expand(3, steps, count)
    split = len(columns.state), len(columns.state) + len(columns.parameters)
    for begin, end in reversed(_pieces(steps, max(1, LANES // (2 * len(columns) * count)), pace.age)):
        at = torch.arange(begin, end, device=parameters.device, dtype=parameters.dtype)
        given = _Inputs(
            times + at[:, None] * pace.step,
            states[:, begin:end],
            parameters[:, None].expand(-1, end - begin, -1),
            table[:, begin:end],
        )
        slopes = _jacobians(run, arm, drive, given, columns, replace(pace, age=pace.age + begin))
        for k in reversed(range(begin, end)):
            adjoint = adjoint + pull.at_state(k + 1, adjoint)
            weight = torch.cat([adjoint, pull.at_step(k, adjoint)])
            found = torch.einsum("crb,rb->cb", slopes[:, :, k - begin], weight)
            adjoint = torch.zeros_like(adjoint)
            adjoint[columns.state] = found[: split[0]]
            of_parameters[columns.parameters] += found[split[0] : split[1]]
            of_base[columns.base, k] = found[split[1] :]
    adjoint = adjoint + pull.at_state(0, adjoint)
    of_base = of_base if base.shape[2] == count else of_base.sum(2, keepdim=True)
    return (
        of_parameters if wanted.inputs[0] else None,
        of_base if wanted.inputs[1] else None,
        None,
        *_split(arm, adjoint),
    )


def _pieces(steps: int, size: int, age: int) -> list[tuple[int, int]]:
    """Ranges of steps that run as one batch; the first two steps of a simulation are stepped otherwise, so alone."""
    alone = max(0, min(2 - age, steps))
    firsts = [(k, k + 1) for k in range(alone)]
    return firsts + [(k, min(k + size, steps)) for k in range(alone, steps, size)]


@dataclass(frozen=True)
class _Pull:
    """Gradients of the loss by the outputs of each step (u, u_rate, force, past, store, summary); zero for individuals
    that diverged (not sound).
    """

    pace: Pace
    steps: int
    size: int
    gradients: Sequence[Tensor | None]
    sound: Tensor

    def at_end(self, nothing: Tensor) -> Tensor:
        """Of the summary's final u and u_rate (X, B)."""
        summary = self.gradients[5]
        if summary is None:
            return nothing
        nothing[: 2 * self.size] = torch.where(self.sound, summary[MEAN_ROWS + 1 :], 0.0)
        return nothing

    def at_state(self, k: int, like: Tensor) -> Tensor:
        """Of the state after k steps (X, B), where it was kept."""
        stride, pull = self.pace.stride, torch.zeros_like(like)
        place = k // stride if stride else 0
        if (k > 0 and not stride) or (stride and k % stride):
            return pull
        for part in (0, 1):
            gradient = self.gradients[part]
            if gradient is not None and (stride or k == 0) and place < gradient.shape[0]:
                own = torch.where(self.sound, gradient[place], 0.0)
                pull[part * self.size : (part + 1) * self.size] = own
        return pull

    def at_step(self, k: int, like: Tensor) -> Tensor:
        """Of forces and means of step k (8, B)."""
        pull, stride = like.new_zeros(2 * MEAN_ROWS, like.shape[1]), self.pace.stride
        force, summary = self.gradients[2], self.gradients[5]
        if force is not None and stride and k // stride < force.shape[0]:
            pull[:MEAN_ROWS] = torch.where(self.sound, force[k // stride], 0.0) / stride
        if summary is not None and k >= self.pace.average_from:
            kept = max(self.steps - self.pace.average_from, 1)
            pull[MEAN_ROWS:] = torch.where(self.sound, summary[:MEAN_ROWS], 0.0) / kept
        return pull

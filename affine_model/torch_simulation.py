"""Batches in torch, with gradients through the simulation: the kernel's linearly implicit midpoint step on
dynamics.balance.

On the CPU or a GPU, after the tensors it is given. The base turns as prescribed. Where no gradient is asked for on a
GPU, one step is captured as a CUDA graph and replayed. For speed on the CPU use affine_model.torch_operator (the
compiled kernel).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor

from affine_model.arm import Arm, active_effects
from affine_model.dynamics import advanced_memory, balance, remembering
from affine_model.effect import Effect

FARTHEST, FASTEST = 1e3, 1e6  # rad, rad/s: beyond these an individual counts as diverged, as in the kernel
NUDGE = 2e-4  # rad/s, times 1/h an acceleration: the differences that give the matrix of the corrections
PENALTY = -1.0  # N, thousand times what an arm can push: stands for the mean thrust of a diverged individual


@dataclass(frozen=True)
class TorchBatch:
    """t (T,) [s]; q, q_rate (T, n, B) the paper's coordinates; fluid_force (S, 2, B) [N] at the middle of every step;

    mean_thrust (B,) [N], the penalty where the individual diverged; diverged (B,) [s], NaN where it did not.
    """

    t: Tensor
    q: Tensor
    q_rate: Tensor
    fluid_force: Tensor
    mean_thrust: Tensor
    diverged: Tensor

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why each individual got the penalty; empty where it did not."""
        limits = f"curvature beyond {FARTHEST:g} rad or {FASTEST:g} rad/s"
        return tuple("" if t != t else f"{limits} at t = {t:.3f} s" for t in self.diverged.tolist())


@dataclass(frozen=True)
class _State:
    """z, z_rate, and the last two mean accelerations (B, n); memory (B, S, N); fluid force of the step (B, 2)."""

    z: Tensor
    z_rate: Tensor
    last: Tensor
    before: Tensor
    memory: Tensor
    fluid: Tensor

    def tensors(self) -> tuple[Tensor, ...]:
        return (self.z, self.z_rate, self.last, self.before, self.memory, self.fluid)


Step = Callable[[_State, Tensor, Tensor], _State]


def _eliminate(matrix: Tensor, right: Tensor) -> Tensor:
    """Solve matrix (B, n, n) x = right (B, n), positive definite, without pivots: a few tensor operations,
    no library call.
    """
    n = right.shape[-1]
    rows, values = [matrix[:, i] for i in range(n)], [right[:, i] for i in range(n)]
    for i in range(n):
        for k in range(i + 1, n):
            factor = rows[k][:, i] / rows[i][:, i]
            rows[k] = rows[k] - factor[:, None] * rows[i]
            values[k] = values[k] - factor * values[i]
    solution: list[Tensor] = [right[:, 0]] * n
    for i in reversed(range(n)):
        rest = sum((rows[i][:, k] * solution[k] for k in range(i + 1, n)), torch.zeros_like(values[i]))
        solution[i] = (values[i] - rest) / rows[i][:, i]
    return torch.stack(solution, dim=-1)


def _stepper(arm: Arm, effects: tuple[Effect, ...], parameters: Tensor, h: float, iterations: int) -> Step:
    """One step as a function (state, base row (3, B), time of its middle) -> state."""
    n = arm.order
    basis = torch.as_tensor(arm.curvature_basis, dtype=parameters.dtype, device=parameters.device)
    offsets = torch.cat([torch.zeros(1, n), torch.eye(n)]).to(parameters) * (NUDGE / h)

    def residual(state: _State, base: Tensor, t: Tensor, a: Tensor) -> tuple[Tensor, Tensor]:
        """Force less inertia (..., B, n) and fluid force (..., B, 2) at mid-step for mean accelerations a (..., B,
        n).
        """
        mid = state.z + 0.5 * h * state.z_rate + 0.25 * h * h * a
        rate = state.z_rate + 0.5 * h * a
        theta = base.reshape(3, *[1] * (a.dim() - 2), -1, 1).expand(3, *a.shape[:-1], 1)
        rail = torch.zeros_like(theta[0])
        memory = advanced_memory(arm, effects, parameters, state.memory, rate @ basis.T, 0.5 * h)
        u, v = torch.cat([mid, theta[0], rail], -1), torch.cat([rate, theta[1], rail], -1)
        found = balance(arm, effects, parameters, u, v, t, memory)
        full = torch.cat([a, theta[2], rail], -1)
        missing = found.force[..., :n] - torch.einsum("...ij,...j->...i", found.mass_matrix[..., :n, :], full)
        fluid = found.fluid_force - torch.einsum("...xj,...j->...x", found.fluid_mass, full)
        return missing, fluid

    def step(state: _State, base: Tensor, t: Tensor) -> _State:
        with torch.no_grad():
            frozen = _State(*(tensor.detach() for tensor in state.tensors()))
            a = 2.0 * frozen.last - frozen.before
            slope = frozen.z.new_zeros(())
            for _ in range(iterations):
                values = residual(frozen, base, t, a + offsets[:, None, :])[0]
                slope = ((values[0] - values[1:]) * (h / NUDGE)).permute(1, 2, 0)  # M + h/2 D + h^2/4 K, by differences
                a = a + _eliminate(slope, values[0])
        # One more correction, with its graph: where the residual vanishes its derivative is the implicit function
        # theorem's.
        a = a + _eliminate(slope, residual(state, base, t, a)[0])
        fluid = residual(state, base, t, a)[1]
        z = state.z + h * state.z_rate + 0.5 * h * h * a
        z_rate = state.z_rate + h * a
        c_rate = (state.z_rate + 0.5 * h * a) @ basis.T
        memory = advanced_memory(arm, effects, parameters, state.memory, c_rate, h)
        sound = ((z.abs() < FARTHEST) & (z_rate.abs() < FASTEST)).all(dim=-1, keepdim=True)
        still = torch.zeros_like(z)
        kept = torch.where(sound, a.detach(), still)
        return _State(
            torch.where(sound, z, still),
            torch.where(sound, z_rate, still),
            kept,
            torch.where(sound, state.last.detach(), still),
            torch.where(sound[..., None], memory, torch.zeros_like(memory)),
            torch.where(sound, fluid, torch.full_like(fluid, torch.nan)),
        )

    return step


def _captured(step: Step, state: _State, base: Tensor, t: Tensor) -> Step:
    """The step as a CUDA graph that is replayed on the same memory;
    the tensors it returns are overwritten by the next call.
    """
    held = _State(*(tensor.clone() for tensor in state.tensors()))
    held_base, held_t = base.clone(), t.clone()
    side = torch.cuda.Stream()
    side.wait_stream(torch.cuda.current_stream())
    with torch.cuda.stream(side):
        for _ in range(3):
            step(held, held_base, held_t)
    torch.cuda.current_stream().wait_stream(side)
    graph = torch.cuda.CUDAGraph()
    with torch.cuda.graph(graph):
        result = step(held, held_base, held_t)

    def replay(new: _State, new_base: Tensor, new_t: Tensor) -> _State:
        for target, source in zip(held.tensors(), new.tensors(), strict=True):
            target.copy_(source)
        held_base.copy_(new_base)
        held_t.copy_(new_t)
        graph.replay()
        return result

    return replay


def torch_simulate(
    arm: Arm,
    parameters: Tensor,
    base: Tensor,
    step: float,
    *,
    q: Tensor | None = None,
    q_rate: Tensor | None = None,
    t0: float = 0.0,
    stride: int = 1,
    average_from: float = 0.0,
    iterations: int = 1,
    penalty: float = PENALTY,
) -> TorchBatch:
    """Integrate B individuals over S steps of `step` seconds; gradients flow to whichever arguments require them.

    parameters (R, B), base (3, S, B or 1) at the middles of the steps, q and q_rate (n, B), as
    affine_model.simulate.simulate takes them; all of one dtype (float64 advised) on one device. stride: keep every
    stride-th state, 0 keeps the last. iterations: Newton corrections (at least 1) before the differentiable one. A
    diverged individual stands still from then on, and its mean thrust is `penalty` [N].
    """
    n, count = arm.order, parameters.shape[1]
    effects = active_effects(parameters.detach().cpu().numpy())
    to_legendre = torch.as_tensor(arm.from_monomial, dtype=parameters.dtype, device=parameters.device)
    to_monomial = torch.as_tensor(arm.to_monomial, dtype=parameters.dtype, device=parameters.device)
    nothing = parameters.new_zeros(count, n)
    z = nothing if q is None else (to_legendre @ q).T
    z_rate = nothing if q_rate is None else (to_legendre @ q_rate).T
    memory = parameters.new_zeros(count, len(remembering(effects)), arm.nodes)
    state = _State(z, z_rate, nothing, nothing, memory, parameters.new_zeros(count, 2))
    base = base.expand(3, -1, count)
    careful = _stepper(
        arm, effects, parameters, step, iterations + 3
    )  # the first two steps have no prediction to start from
    usual = _stepper(arm, effects, parameters, step, iterations)
    times = torch.tensor([t0 + (k + 0.5) * step for k in range(base.shape[1])]).to(parameters)
    needs_graph = torch.is_grad_enabled() and any(
        tensor is not None and tensor.requires_grad for tensor in (parameters, base, q, q_rate)
    )
    replayed = parameters.is_cuda and not needs_graph
    kept, forces = [state], []
    for k in range(base.shape[1]):
        if replayed and k == 2:
            usual = _captured(usual, state, base[:, k], times[k])
        state = (careful if k < 2 else usual)(state, base[:, k], times[k])
        if replayed:
            state = _State(*(tensor.clone() for tensor in state.tensors()))
        if k == 0:
            state = _State(state.z, state.z_rate, state.last, state.last, state.memory, state.fluid)
        forces.append(state.fluid)
        if (stride and (k + 1) % stride == 0) or (not stride and k + 1 == base.shape[1]):
            kept.append(state)
    force = torch.stack(forces)
    broken = torch.isnan(force[..., 1])
    first = torch.where(broken.any(0), times[broken.to(torch.uint8).argmax(0)], torch.full_like(times[:1], torch.nan))
    mean = torch.nan_to_num(force[round(average_from / step) :, :, 1]).mean(0)
    spacing = step * (stride or base.shape[1])
    return TorchBatch(
        t=t0 + spacing * torch.arange(len(kept), dtype=parameters.dtype, device=parameters.device),
        q=torch.einsum("jk,tbk->tjb", to_monomial, torch.stack([s.z for s in kept])),
        q_rate=torch.einsum("jk,tbk->tjb", to_monomial, torch.stack([s.z_rate for s in kept])),
        fluid_force=force.permute(0, 2, 1),
        mean_thrust=torch.where(torch.isnan(first), mean, torch.full_like(mean, penalty)),
        diverged=first,
    )

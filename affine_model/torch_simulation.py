"""Batches in torch, with gradients through the simulation: the kernel's linearly implicit midpoint step on
dynamics.balance.

On the CPU or a GPU, after the tensors it is given. The base turns as prescribed or by the servo, clamped or on a rail.
Where no gradient is asked for on a GPU, one step is captured as a CUDA graph and replayed. For speed on the CPU use
affine_model.torch_operator (the compiled kernel).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from affine_model.arm import Arm, active_effects
from affine_model.dynamics import advanced_memory, balance, remembering
from affine_model.effect import Effect
from affine_model.simulate import Rail, Servo

FARTHEST, FASTEST = 1e3, 1e6  # rad, rad/s: beyond these an individual counts as diverged, as in the kernel
NUDGE = 2e-4  # rad/s, times 1/h an acceleration: the differences that give the matrix of the corrections
PENALTY = -1.0  # N, thousand times what an arm can push: stands for the mean thrust of a diverged individual


@dataclass(frozen=True)
class TorchBatch:
    """t (T,) [s]; q, q_rate (T, n, B) the paper's coordinates; theta, theta_rate (T, B) [rad]; rail, rail_rate (T, B)
    [m]; fluid_force (S, 2, B) [N] at the middle of every step;

    mean_thrust (B,) [N], the penalty where the individual diverged; diverged (B,) [s], NaN where it did not.
    """

    t: Tensor
    q: Tensor
    q_rate: Tensor
    theta: Tensor
    theta_rate: Tensor
    rail: Tensor
    rail_rate: Tensor
    fluid_force: Tensor
    mean_thrust: Tensor
    diverged: Tensor

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why each individual got the penalty; empty where it did not."""
        limits = f"a coordinate beyond {FARTHEST:g} rad (m) or {FASTEST:g} rad/s (m/s)"
        return tuple("" if t != t else f"{limits} at t = {t:.3f} s" for t in self.diverged.tolist())


@dataclass(frozen=True)
class _State:
    """u, u_rate, and the last two mean accelerations (B, n + 2), of which the driven ones are 0; memory (B, S, N);
    integral (B,) of the servo's error; fluid force of the step (B, 2).
    """

    u: Tensor
    u_rate: Tensor
    last: Tensor
    before: Tensor
    memory: Tensor
    integral: Tensor
    fluid: Tensor

    def tensors(self) -> tuple[Tensor, ...]:
        return (self.u, self.u_rate, self.last, self.before, self.memory, self.integral, self.fluid)


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


def _servo_torque(servo: Servo, command: Tensor, u: Tensor, u_rate: Tensor, integral: Tensor, h: float) -> Tensor:
    """The PID's torque at mid-step, within its limit; command (3, ...) and the base's angle and rate (...)."""
    error, error_rate = command[0] - u, command[1] - u_rate
    wanted = servo.stiffness * error + servo.integral * (integral + 0.5 * h * error) + servo.damping * error_rate
    return wanted.clamp(-servo.torque_limit, servo.torque_limit)


@dataclass(frozen=True)
class _Drive:
    """What moves the base: a servo (None: it turns as prescribed), a rail (None: it is clamped)."""

    servo: Servo | None
    rail: Rail | None

    def moving(self, n: int) -> list[int]:
        """Places of the unknown coordinates."""
        return [*range(n), *([n] if self.servo else []), *([n + 1] if self.rail else [])]

    def forces(self, command: Tensor, u: Tensor, u_rate: Tensor, a: Tensor, integral: Tensor, h: float) -> Tensor:
        """(..., 2): the servo's torque less the rotor's inertia, and the carriage's friction and inertia."""
        torque, push = torch.zeros_like(u[..., -2]), torch.zeros_like(u[..., -1])
        if self.servo is not None:
            torque = _servo_torque(self.servo, command, u[..., -2], u_rate[..., -2], integral, h)
            torque = torque - self.servo.rotor_inertia * a[..., -2]
        if self.rail is not None:
            slip = u_rate[..., -1]
            push = -self.rail.mass * a[..., -1] - self.rail.viscous * slip
            push = push - self.rail.dry * torch.tanh(slip / self.rail.slip_speed)
        return torch.stack([torque, push], -1)


def _stepper(
    arm: Arm, effects: tuple[Effect, ...], parameters: Tensor, h: float, iterations: int, drive: _Drive
) -> Step:
    """One step as a function (state, base row (3, B), time of its middle) -> state."""
    n = arm.order
    basis = torch.as_tensor(arm.curvature_basis, dtype=parameters.dtype, device=parameters.device)
    moving = drive.moving(n)
    chosen = torch.eye(n + 2).to(parameters)[moving]  # (D, n + 2): the unknowns out of all coordinates
    offsets = torch.cat([torch.zeros_like(chosen[:1]), chosen]) * (NUDGE / h)
    driven = torch.zeros(n + 2).to(parameters)
    driven[n] = 0.0 if drive.servo else 1.0

    def middle(state: _State, base: Tensor, a: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """u, u_rate and accelerations (..., B, n + 2) at mid-step; a prescribed base angle is put in."""
        given = base.reshape(3, *[1] * (a.dim() - 2), -1, 1) * driven
        kept = 1.0 - driven
        u = kept * (state.u + 0.5 * h * state.u_rate + 0.25 * h * h * a) + given[0]
        return u, kept * (state.u_rate + 0.5 * h * a) + given[1], kept * a + given[2]

    def residual(state: _State, base: Tensor, t: Tensor, a: Tensor) -> tuple[Tensor, Tensor]:
        """Force less inertia (..., B, D) and fluid force (..., B, 2) at mid-step for mean accelerations a (..., B,
        n + 2).
        """
        u, u_rate, full = middle(state, base, a)
        memory = advanced_memory(arm, effects, parameters, state.memory, u_rate[..., :n] @ basis.T, 0.5 * h)
        found = balance(arm, effects, parameters, u, u_rate, t, memory)
        missing = found.force - torch.einsum("...ij,...j->...i", found.mass_matrix, full)
        command = base.reshape(3, *[1] * (a.dim() - 2), -1)
        outer = drive.forces(command, u, u_rate, full, state.integral, h)
        missing = torch.cat([missing[..., :n], missing[..., n:] + outer], -1)
        fluid = found.fluid_force - torch.einsum("...xj,...j->...x", found.fluid_mass, full)
        return missing @ chosen.T, fluid

    def step(state: _State, base: Tensor, t: Tensor) -> _State:
        with torch.no_grad():
            frozen = _State(*(tensor.detach() for tensor in state.tensors()))
            a = 2.0 * frozen.last - frozen.before
            slope = frozen.u.new_zeros(())
            for _ in range(iterations):
                values = residual(frozen, base, t, a + offsets[:, None, :])[0]
                slope = ((values[0] - values[1:]) * (h / NUDGE)).permute(1, 2, 0)  # M + h/2 D + h^2/4 K, by differences
                a = a + _eliminate(slope, values[0]) @ chosen
        # One more correction, with its graph: where the residual vanishes its derivative is the implicit function
        # theorem's.
        a = a + _eliminate(slope, residual(state, base, t, a)[0]) @ chosen
        fluid = residual(state, base, t, a)[1]
        mid, mid_rate, full = middle(state, base, a)
        # Of a prescribed angle, from the middle to the end to second order, as the kernel.
        u = state.u + h * state.u_rate + 0.5 * h * h * a
        u = (1.0 - driven) * u + driven * (mid + 0.5 * h * mid_rate + 0.125 * h * h * full)
        u_rate = (1.0 - driven) * (state.u_rate + h * a) + driven * (mid_rate + 0.5 * h * full)
        memory = advanced_memory(arm, effects, parameters, state.memory, mid_rate[..., :n] @ basis.T, h)
        integral = state.integral + h * (base[0] - mid[..., n])
        sound = ((u.abs() < FARTHEST) & (u_rate.abs() < FASTEST)).all(dim=-1, keepdim=True)
        still = torch.zeros_like(u)
        kept = torch.where(sound, a.detach(), still)
        return _State(
            torch.where(sound, u, still),
            torch.where(sound, u_rate, still),
            kept,
            torch.where(sound, state.last.detach(), still),
            torch.where(sound[..., None], memory, torch.zeros_like(memory)),
            torch.where(sound[..., 0], integral, torch.zeros_like(integral)),
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
    servo: Servo | None = None,
    rail: Rail | None = None,
    t0: float = 0.0,
    stride: int = 1,
    average_from: float = 0.0,
    iterations: int = 1,
    penalty: float = PENALTY,
) -> TorchBatch:
    """Integrate B individuals over S steps of `step` seconds; gradients flow to whichever arguments require them.

    parameters (R, B), base (3, S, B or 1) at the middles of the steps (with a servo, the command), q and q_rate (n, B),
    servo and rail, as affine_model.simulate.simulate takes them; all of one dtype (float64 advised) on one device.
    stride: keep every stride-th state, 0 keeps the last. iterations: Newton corrections (at least 1) before the
    differentiable one. A diverged individual stands still from then on, and its mean thrust is `penalty` [N].
    """
    n, count = arm.order, parameters.shape[1]
    effects, drive = active_effects(parameters.detach().cpu().numpy()), _Drive(servo, rail)
    to_legendre = torch.as_tensor(arm.from_monomial, dtype=parameters.dtype, device=parameters.device)
    to_monomial = torch.tensor(arm.to_monomial, dtype=parameters.dtype, device=parameters.device)
    base = base.expand(3, -1, count)
    none = parameters.new_zeros(n, count)
    # From the first middle back to the start, to second order, as the kernel does.
    angle = base[0, 0] - 0.5 * step * base[1, 0] + 0.125 * step**2 * base[2, 0]
    angle_rate = base[1, 0] - 0.5 * step * base[2, 0]
    at_rest = parameters.new_zeros(1, count)
    u = torch.cat([none if q is None else to_legendre @ q, angle[None], at_rest]).T
    u_rate = torch.cat([none if q_rate is None else to_legendre @ q_rate, angle_rate[None], at_rest]).T
    nothing = parameters.new_zeros(count, n + 2)
    memory = parameters.new_zeros(count, len(remembering(effects)), arm.nodes)
    state = _State(u, u_rate, nothing, nothing, memory, parameters.new_zeros(count), parameters.new_zeros(count, 2))
    # The first two steps have no prediction to start from.
    careful = _stepper(arm, effects, parameters, step, iterations + 3, drive)
    usual = _stepper(arm, effects, parameters, step, iterations, drive)
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
            state = replace(state, before=state.last)
        forces.append(state.fluid)
        if (stride and (k + 1) % stride == 0) or (not stride and k + 1 == base.shape[1]):
            kept.append(state)
    force = torch.stack(forces)
    broken = torch.isnan(force[..., 1])
    first = torch.where(broken.any(0), times[broken.to(torch.uint8).argmax(0)], torch.full_like(times[:1], torch.nan))
    mean = torch.nan_to_num(force[round(average_from / step) :, :, 1]).mean(0)
    spacing = step * (stride or base.shape[1])
    all_u, all_rates = torch.stack([s.u for s in kept]), torch.stack([s.u_rate for s in kept])
    return TorchBatch(
        t=t0 + spacing * torch.arange(len(kept), dtype=parameters.dtype, device=parameters.device),
        q=torch.einsum("jk,tbk->tjb", to_monomial, all_u[..., :n]),
        q_rate=torch.einsum("jk,tbk->tjb", to_monomial, all_rates[..., :n]),
        theta=all_u[..., n],
        theta_rate=all_rates[..., n],
        rail=all_u[..., n + 1],
        rail_rate=all_rates[..., n + 1],
        fluid_force=force.permute(0, 2, 1),
        mean_thrust=torch.where(torch.isnan(first), mean, torch.full_like(mean, penalty)),
        diverged=first,
    )

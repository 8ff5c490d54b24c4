"""affine_model.simulate on tensors: the same kernels, outputs that carry gradients to whatever requires them.

All tensors are float64 and lie on one device, the CPU or CUDA.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from affine_model.advance import PRESCRIBED, Drive
from affine_model.arm import Arm
from affine_model.dynamics import remembering
from affine_model.effects import catalogue
from affine_model.simulate import STRAIGHT, Start, Timing
from affine_model.torch_advance import advanced

DIVERGED_THRUST = -1.0  # N, a thousand times the thrust of an arm: the mean thrust given for a diverged individual


@dataclass(frozen=True)
class TorchBatch:
    """As affine_model.simulate.Batch: t (T,) [s]; q, q_rate (T, n, B); theta, theta_rate (T, B) [rad]; rail, rail_rate
    (T, B) [m]; fluid_force (T-1, 2, B) [N], load (T-1, B) [N] and torque (T-1, B) [N m], means over each interval;

    mean_thrust (B,) [N], the penalty where the individual diverged; mean_power (B,) [W], NaN there; diverged (B,) [s],
    NaN where it did not.
    """

    t: Tensor
    q: Tensor
    q_rate: Tensor
    theta: Tensor
    theta_rate: Tensor
    rail: Tensor
    rail_rate: Tensor
    fluid_force: Tensor
    load: Tensor
    torque: Tensor
    mean_thrust: Tensor
    mean_power: Tensor
    diverged: Tensor

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why each individual got the penalty; empty where it did not."""
        limits = "a coordinate beyond 1000 rad (m) or 1e+06 rad/s (m/s)"
        return tuple("" if t != t else f"{limits} at t = {t:.3f} s" for t in self.diverged.tolist())


def torch_simulate(
    arm: Arm, parameters: Tensor, base: Tensor, timing: Timing, *, start: Start = STRAIGHT, drive: Drive = PRESCRIBED
) -> TorchBatch:
    """Integrate B individuals over the S steps of base; gradients flow to whichever arguments require them.

    All as affine_model.simulate.simulate takes it, with tensors in place of arrays; a stride of 0 keeps the last state
    alone. The mean thrust of a diverged individual is PENALTY.
    """
    n, count = arm.order, parameters.shape[1]
    to_legendre = torch.as_tensor(arm.from_monomial).to(parameters)
    to_monomial = torch.as_tensor(arm.to_monomial).to(parameters)
    none, still = parameters.new_zeros(n, count), parameters.new_zeros(1, count)
    # From the middle of the first step back to its start, to second order.
    angle = (base[0, :1] - 0.5 * timing.step * base[1, :1] + 0.125 * timing.step**2 * base[2, :1]).expand(1, count)
    angle_rate = (base[1, :1] - 0.5 * timing.step * base[2, :1]).expand(1, count)
    u = torch.cat([none if start.q is None else to_legendre @ start.q, angle, still])
    u_rate = torch.cat([none if start.q_rate is None else to_legendre @ start.q_rate, angle_rate, still])
    slots = remembering(tuple(catalogue().values()))
    past, store = parameters.new_zeros(2 * n + 5, count), parameters.new_zeros(len(slots), arm.node_count, count)
    if start.memory is not None:
        at_nodes = torch.as_tensor(arm.curvature_basis @ arm.from_monomial).to(parameters) @ start.memory
        relaxing = torch.tensor([effect.relaxation_time is not None for effect in slots], device=parameters.device)
        store = torch.where(relaxing[:, None, None], at_nodes, store)
    times = parameters.new_full((count,), start.t0)
    found = advanced(arm, drive, parameters, base, (times, u, u_rate, past, store), timing.pace)
    all_u, all_rates, force, _, _, summary = found
    if not timing.stride:
        ends = summary[5:].unflatten(0, (2, n + 2))
        all_u, all_rates = torch.stack([u, ends[0]]), torch.stack([u_rate, ends[1]])
        force = summary.new_full((1, 4, count), torch.nan)
    spacing = timing.step * (timing.stride or base.shape[1])
    sound = summary[4] < 0.0
    return TorchBatch(
        t=start.t0 + spacing * torch.arange(len(all_u), dtype=parameters.dtype, device=parameters.device),
        q=torch.einsum("jk,tkb->tjb", to_monomial, all_u[:, :n]),
        q_rate=torch.einsum("jk,tkb->tjb", to_monomial, all_rates[:, :n]),
        theta=all_u[:, n],
        theta_rate=all_rates[:, n],
        rail=all_u[:, n + 1],
        rail_rate=all_rates[:, n + 1],
        fluid_force=force[:, :2],
        load=force[:, 2],
        torque=force[:, 3],
        mean_thrust=torch.where(sound, summary[1], DIVERGED_THRUST),
        mean_power=torch.where(sound, summary[2], torch.nan),
        diverged=torch.where(sound, torch.nan, summary[4]).detach(),
    )

"""evaluate in torch, step by step differentiable: eq. 20, the servo's limits, and the simulation `tentacle::advance`.

tentacle::swim takes its gradient from here. The simulation's own gradient is the discrete adjoint of the computed steps
(affine_model.torch_adjoint). The limits scale the amplitudes by min(1, limit / peak); the derivative of a peak is that
of the motion at the peak's instant (envelope theorem).
"""

from __future__ import annotations

import math

import torch
from torch import Tensor

from affine_model.advance import Drive, Pace, at_rest
from affine_model.arm import Arm
from affine_model.torch_advance import advanced
from tentacle.gait import COEFFICIENT, MULTIPLE, TERM

Limits = tuple[Tensor, float]  # largest angle [rad], speed [rad/s], acceleration [rad/s^2] (3,); bandwidth [Hz]


def gait_table(genes: Tensor, times: Tensor, bandwidth: float) -> Tensor:
    """Eq. 20 of gaits (B, 9) at times (S,) [s]: theta and its first two derivatives (3, S, B)."""
    term = torch.as_tensor(TERM, device=genes.device)
    multiple, coefficient = (torch.as_tensor(part).to(genes) for part in (MULTIPLE, COEFFICIENT))
    amplitude, fundamental, phase = (part[:, term] for part in genes.split(3, dim=1))  # (B, H) each
    omega = multiple * fundamental
    share = (omega.abs() / (2.0 * math.pi * bandwidth)).clamp(max=1.0)
    fade = torch.where(multiple == 1.0, 1.0, torch.cos(0.5 * math.pi * share) ** 2)
    strength, angle = amplitude * coefficient * fade, omega * times[:, None, None] + phase
    wave = strength * torch.sin(angle)
    parts = (wave, strength * omega * torch.cos(angle), -wave * omega**2)
    return torch.stack([part.sum(dim=2) for part in parts])


def gait_rows(
    arm: Arm, drive: Drive, genes: Tensor, parameters: Tensor, limits: Limits, timing: tuple[Pace, int]
) -> Tensor:
    """The rows (6, B, K) of affine_model.swim.evaluate, of gaits (B, 9) on samples (R, K) of parameters."""
    (pace, steps), (kinematic, bandwidth) = timing, limits
    count, samples = genes.shape[0], parameters.shape[1]
    times = pace.step * (torch.arange(steps, dtype=genes.dtype, device=genes.device) + 0.5)
    table = gait_table(genes, times, bandwidth)
    scale = (kinematic.to(genes)[:, None] / table.abs().amax(dim=1)).amin(dim=0).clamp(max=1.0)
    base = (table * scale).repeat_interleave(samples, dim=2)
    state = at_rest(arm, count * samples)
    rest = [torch.as_tensor(part).to(genes) for part in (state.u, state.u_rate, state.past, state.store)]
    start = (genes.new_zeros(count * samples), *rest)
    motion, _, force, _, _, summary = advanced(arm, drive, parameters.repeat(1, count), base, start, pace)  # type: ignore[arg-type]
    settled, seconds, rail = pace.average_from // 2, (steps - pace.average_from) * pace.step, motion[:, arm.order + 1]
    speed, torque = (rail[settled] - rail[-1]) / seconds, force[settled:, 3].abs().amax(dim=0)
    rows = [-summary[1], speed, summary[2], torque, summary[4].detach(), scale.repeat_interleave(samples)]
    return torch.stack(rows).unflatten(1, (count, samples))

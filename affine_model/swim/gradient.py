"""The gradient of mean thrust over the nine parameters by reverse differentiation (torch), to check and to compare.

It is that of the operator's own steps (affine_model.torch_adjoint), and serves any number of parameters at one price.
With nine of them the 18 neighbours of a point, run as one batch of the compiled kernel, are faster. So polish uses
those.
"""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from affine_model.curvature import Array
from affine_model.swim.trial import Trial
from affine_model.torch_simulation import torch_simulate
from tentacle.gait import COEFFICIENT, MULTIPLE, TERM


def torch_gait(alpha: Tensor, t: Tensor, bandwidth: float) -> Tensor:
    """Eq. 20 at t (S,) as tentacle.gait has it: theta and its first two derivatives (3, S), differentiable in alpha
    (9,).
    """
    multiple, coefficient = torch.from_numpy(MULTIPLE).to(alpha), torch.from_numpy(COEFFICIENT)
    amplitude, omega, phase = (alpha[3 * k : 3 * k + 3][torch.from_numpy(TERM)] for k in range(3))
    share = multiple * omega.abs() / (2.0 * np.pi * bandwidth)
    faded = torch.cos(0.5 * np.pi * share.clamp(max=1.0)) ** 2
    strength = (amplitude * coefficient * torch.where(multiple == 1.0, torch.ones_like(faded), faded))[:, None]
    rate = (multiple * omega)[:, None]
    angle = rate * t + phase[:, None]
    sine, cosine = torch.sin(angle), torch.cos(angle)
    return torch.stack([strength * sine, strength * rate * cosine, -strength * rate**2 * sine]).sum(dim=1)


def thrust_gradient(trial: Trial, alpha: Array) -> tuple[float, Array]:
    """Mean forward thrust [N] of a gait (9,) that the trial's first arm gives, and its gradient (9,).

    The base is clamped, and no limits scale the gait.
    """
    point = torch.tensor(alpha, dtype=torch.float64, requires_grad=True)
    middles = (torch.arange(trial.steps, dtype=torch.float64) + 0.5) * trial.step
    base = torch_gait(point, middles, trial.limits.bandwidth)[:, :, None]
    parameters = torch.from_numpy(trial.parameters[:, :1].copy())
    batch = torch_simulate(trial.arm, parameters, base, trial.step, stride=0, average_from=trial.settled * trial.step)
    thrust = -batch.mean_thrust.sum()
    (gradient,) = torch.autograd.grad(thrust, point)
    return float(thrust.detach()), gradient.numpy()

"""affine_model.simulate on the device that is asked for: arrays in, arrays out.

torch is loaded only where a device is named. A batch of a fit has tens of columns, and every set of effects that is
tried would be a kernel to compile: so one kernel has all effects of the catalogue.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from affine_model.arm import Arm
from affine_model.curvature import Array
from affine_model.simulate import Batch, Start, Timing, simulate


def simulate_on(device: str | None, arm: Arm, parameters: Array, base: Array, timing: Timing, start: Start) -> Batch:
    """As affine_model.simulate.simulate, without servo and rail; device: as torch names it (None: the compiled kernel
    on the CPU, without torch). InputError where Warp is not installed. The two agree to 1e-9, not to the bit.
    """
    if device is None:
        return simulate(arm, parameters, base, timing, start=start)
    import torch

    from affine_model.torch_simulation import torch_simulate

    def there(array: Array) -> torch.Tensor:
        return torch.as_tensor(np.ascontiguousarray(array, dtype=float), device=device)

    states = {name: there(rows) for name in ("q", "q_rate", "memory") if (rows := getattr(start, name)) is not None}
    found = torch_simulate(
        arm, there(parameters), there(base), replace(timing, every_effect=True), start=replace(start, **states)
    )
    arrays = {name: tensor.cpu().numpy() for name, tensor in vars(found).items()}
    t, sound = arrays["t"], np.isnan(arrays["diverged"])
    means = {name: np.where(sound, arrays[name], np.nan) for name in ("mean_thrust", "mean_power")}
    return Batch(**{**arrays, **means}, force_t=0.5 * (t[1:] + t[:-1]))

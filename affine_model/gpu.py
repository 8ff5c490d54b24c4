"""The batch simulation on a CUDA device by generated Warp kernels, one individual a thread; tensors stay in place.

Warp also runs its kernels on the CPU: so the tests compare what was generated with the compiled kernel, without a GPU.
A kernel is made for the set of effects that act and for the drive, and kept in Warp's own cache.
"""

from __future__ import annotations

import importlib.util
from functools import cache, lru_cache
from types import ModuleType
from typing import Any

import torch
from torch import Tensor

from affine_model.advance import Drive, Pace, arm_arrays
from affine_model.arm import Arm, active_effects
from affine_model.effects import catalogue
from affine_model.kernel.load import module_of
from affine_model.kernel.warp_source import ADVANCE, SWIM, Variant, warp_source
from tentacle.errors import InputError
from tentacle.law.in_use import follows_laws


@cache
def warp() -> Any:
    """The module warp, made ready; InputError where it is not installed."""
    if importlib.util.find_spec("warp") is None:
        raise InputError("NVIDIA Warp is not installed", field="device", expected="pip install 'tentacle-twin[gpu]'")
    import warp as wp

    wp.config.log_level = wp.LOG_ERROR
    wp.init()
    return wp


@follows_laws
def _module(variant: Variant, swim: bool) -> ModuleType:
    warp()
    name = f"warp_{'swim' if swim else 'advance'}_{variant.nodes}_{variant.order}"
    return module_of(name, warp_source(variant, swim))


@lru_cache(maxsize=16)
def _arm_tensors(arm: Arm, drive: Drive, device: torch.device) -> dict[str, Any]:
    """The arm's and the drive's arrays on the device, moved there once; plain numbers as they are."""
    given = arm_arrays(arm, drive)
    return {k: v if isinstance(v, float) else torch.as_tensor(v, device=device).contiguous() for k, v in given.items()}


def _variant(arm: Arm, drive: Drive, parameters: Tensor) -> Variant:
    acting = {effect.name for effect in active_effects(parameters.detach().cpu().numpy())}
    active = tuple(name in acting for name in catalogue())
    return Variant(arm.node_count, arm.order, active, drive.servo is not None, drive.rail is not None, arm.clamp)


def _launch(kernel: Any, names: list[str], values: dict[str, Any], count: int, device: torch.device) -> None:
    wp = warp()
    inputs = [wp.from_torch(v, dtype=wp.float64) if isinstance(v, Tensor) else v for v in (values[n] for n in names)]
    stream = wp.stream_from_torch(torch.cuda.current_stream(device)) if device.type == "cuda" else None
    place = wp.device_from_torch(device)
    wp.launch(kernel, dim=count, inputs=inputs, device=None if stream else place, stream=stream)


def advance_on_device(
    arm: Arm, drive: Drive, parameters: Tensor, base: Tensor, start: tuple[Tensor, ...], pace: Pace
) -> tuple[Tensor, Tensor, Tensor, Tensor, Tensor, Tensor]:
    """affine_model.advance.advance on tensors of one device: u, u_rate, force, past, store, summary.

    start: times (B,), u, u_rate (n + 2, B), past (2 n + 5, B), store (S, N, B).
    """
    times, u, u_rate, past, store = start
    n, count, steps = arm.order, parameters.shape[1], base.shape[1]
    kept = steps // pace.stride if pace.stride else 0
    whole = kept if pace.complete else 0
    new = parameters.new_zeros
    found = (
        new(kept + 1, n + 2, count), new(kept + 1, n + 2, count), new(max(kept, 1), 4, count),
        new(whole, 2 * n + 5, count), new(whole, *store.shape[:2], count), new(2 * n + 9, count),
    )  # fmt: skip
    outputs = dict(zip(("out_u", "out_rate", "out_force", "out_past", "out_store", "summary"), found, strict=True))
    values = {
        **_arm_tensors(arm, drive, parameters.device), **outputs, "parameters": parameters, "base": base, "t0": times,
        "start": u, "start_rate": u_rate, "start_past": past, "start_store": store, "h": pace.step, "steps": steps,
        "age": pace.age, "iterations": pace.iterations, "stride": pace.stride, "average_from": pace.average_from,
    }  # fmt: skip
    module = _module(_variant(arm, drive, parameters), False)
    _launch(module.advance, ADVANCE, values, count, parameters.device)
    return found


def swim_on_device(
    arm: Arm, drive: Drive, parameters: Tensor, genes: Tensor, limits: tuple[Tensor, float], timing: tuple[Pace, int]
) -> Tensor:
    """B gaits (B, 9) from rest on one sample of parameters (R,): (6, B) of mean forward thrust [N] and speed [m/s],
    mean power [W], peak torque [N m], time of divergence [s] (-1: none), and the factor that brought the gait within
    limits: largest angle, speed and acceleration (3,), and the bandwidth [Hz]. timing: the pace and the steps.
    """
    pace, steps = timing
    count, n, device = genes.shape[0], arm.order, genes.device
    given = parameters.to(device)[:, None]
    outcome = genes.new_zeros(6, count)
    still = genes.new_zeros(1, 1)
    store = genes.new_zeros(1, 1, 1)
    slots = len([effect for effect in catalogue().values() if effect.remembers])
    values = {
        **_arm_tensors(arm, drive, device), "parameters": given.expand(-1, count), "gait": genes, "outcome": outcome,
        "limits": limits[0], "bandwidth": limits[1], "h": pace.step, "steps": steps, "age": 0,
        "iterations": pace.iterations, "average_from": pace.average_from, "t0": genes.new_zeros(1).expand(count),
        "start": still.expand(n + 2, count), "start_rate": still.expand(n + 2, count),
        "start_past": still.expand(2 * n + 5, count), "start_store": store.expand(slots, arm.node_count, count),
    }  # fmt: skip
    module = _module(_variant(arm, drive, given), True)
    _launch(module.swim, SWIM, values, count, device)
    return outcome

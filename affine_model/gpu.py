"""The batch simulation on a CUDA device by generated Warp kernels, one individual a thread; tensors stay in place.

Warp also runs its kernels on the CPU: so the tests compare what was generated with the compiled kernel, without a GPU.
A kernel is made for the set of effects that act and for the drive, and kept in Warp's own cache.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from itertools import zip_longest
from typing import Any

import numpy as np
import torch
from torch import Tensor

from affine_model.advance import Drive, Pace, arm_arrays
from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array
from affine_model.effects import catalogue
from affine_model.kernel.load import module_of
from affine_model.kernel.warp_source import (
    ADVANCE,
    ADVANCE_UNIFORMS,
    SWIM,
    SWIM_UNIFORMS,
    Variant,
    warp_text,
)
from affine_model.swim.evaluate import Bounds
from tentacle.errors import InputError
from tentacle.law.in_use import follows_laws

THREADS = 64  # of a block: small batches reach all multiprocessors


@cache
def warp() -> Any:
    """The module warp, made ready; InputError where it is not installed."""
    if importlib.util.find_spec("warp") is None:
        raise InputError("NVIDIA Warp is not installed", field="device", expected="pip install 'tentacle-twin[gpu]'")
    import warp as wp

    wp.config.log_level = wp.LOG_ERROR
    wp.init()
    return wp


@dataclass(frozen=True)
class PreparedKernel:
    """A kernel of Warp, the table of uniform values that it reads, and its text."""

    kernel: Any
    table: list[float]
    text: str


@follows_laws
def _module(variant: Variant, swim: bool, outcomes: tuple[bool, ...]) -> tuple[Any, Callable[..., Any], str]:
    """The kernel for these outcomes of tests, the function that gives its uniform values, and its text."""
    warp()
    text, name = warp_text(variant, swim, outcomes), "swim" if swim else "advance"
    kernel = getattr(module_of(f"warp_{name}_{variant.nodes}_{variant.order}", text.kernel), name)
    return kernel, module_of(f"uniforms_{name}", text.uniforms).uniforms, text.kernel


def _prepared(variant: Variant, swim: bool, given: dict[str, Any]) -> PreparedKernel:
    """The kernel that fits the outcomes of its tests on the values given."""
    outcomes: tuple[bool, ...] = ()
    while True:
        kernel, uniforms, text = _module(variant, swim, outcomes)
        numbers = (given[name] for name in (SWIM_UNIFORMS if swim else ADVANCE_UNIFORMS))
        with np.errstate(all="ignore"):  # of a payload that is not there the density may be zero
            values, found = uniforms(*(np.asarray(number)[()] for number in numbers))
        if not any(one != other for one, other in zip_longest(found, outcomes, fillvalue=False)):
            return PreparedKernel(kernel, values, text)
        outcomes = tuple(map(bool, found))


def _acting(parameters: Array) -> tuple[bool, ...]:
    """Of every effect of the catalogue, whether it acts under these parameters (R, B)."""
    acting = {effect.name for effect in active_effects(parameters)}
    return tuple(name in acting for name in catalogue())


def _variant(arm: Arm, drive: Drive, active: tuple[bool, ...]) -> Variant:
    return Variant(arm.node_count, arm.order, active, drive.servo is not None, drive.rail is not None, arm.clamp > 0.0)


def _launch(prepared: PreparedKernel, names: list[str], values: dict[str, Any], count: int) -> None:
    wp = warp()
    device = next(value for value in values.values() if isinstance(value, Tensor)).device
    inputs = [
        wp.from_torch(v.detach(), dtype=wp.float64) if isinstance(v, Tensor) else v for v in (values[n] for n in names)
    ]
    inputs.append(wp.types.vector(length=len(prepared.table), dtype=wp.float64)(*prepared.table))
    stream = wp.stream_from_torch(torch.cuda.current_stream(device)) if device.type == "cuda" else None
    place = wp.device_from_torch(device)
    wp.launch(
        prepared.kernel, dim=count, inputs=inputs, device=None if stream else place, stream=stream, block_dim=THREADS
    )


def advance_on_device(
    arm: Arm, drive: Drive, parameters: Tensor, base: Tensor, start: tuple[Tensor, ...], pace: Pace
) -> tuple[Tensor, Tensor, Tensor, Tensor, Tensor, Tensor]:
    """affine_model.advance.advance on tensors of one device: u, u_rate, force, past, store, summary.

    base (3 or 9, S, B or 1); start: times (B,), u, u_rate (n + 2, B), past (2 n + 5, B), store (S, N, B).
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
        **outputs, "parameters": parameters, "base": base, "t0": times, "start": u, "start_rate": u_rate,
        "start_past": past, "start_store": store, "steps": steps, "age": pace.age, "iterations": pace.iterations,
        "stride": pace.stride, "average_from": pace.average_from,
    }  # fmt: skip
    active = (True,) * len(catalogue()) if pace.every_effect else _acting(parameters.detach().cpu().numpy())
    variant = replace(_variant(arm, drive, active), travels=base.shape[0] > 3)
    _launch(_prepared(variant, False, {**arm_arrays(arm, drive), "h": pace.step}), ADVANCE, values, count)
    return found


def swim_on_device(
    arm: Arm, drive: Drive, parameters: Tensor, genes: Tensor, limits: tuple[Tensor, float], timing: tuple[Pace, int]
) -> Tensor:
    """B gaits (B, 9) from rest on one sample of parameters (R,): (6, B) of mean forward thrust [N] and speed [m/s],
    mean power [W], peak torque [N m], time of divergence [s] (-1: none), and the factor that brought the gait within
    limits: largest angle, speed and acceleration (3,), and the bandwidth [Hz]. timing: the pace and the steps.
    """
    pace, steps = timing
    bounds = Bounds(limits[0].cpu().numpy(), limits[1])
    outcome = genes.new_zeros(6, genes.shape[0])
    values = {
        "gait": genes, "outcome": outcome, "steps": steps, "iterations": pace.iterations,
        "average_from": pace.average_from,
    }  # fmt: skip
    _launch(prepared_swim(arm, drive, parameters.cpu().numpy(), bounds, pace.step), SWIM, values, genes.shape[0])
    return outcome


def prepared_swim(arm: Arm, drive: Drive, parameters: Array, bounds: Bounds, step: float) -> PreparedKernel:
    """The fused kernel for these parameters (R,)."""
    uniform = {
        **arm_arrays(arm, drive), "h": step, "parameters": parameters, "limits": bounds.kinematic,
        "bandwidth": bounds.bandwidth,
    }  # fmt: skip
    return _prepared(_variant(arm, drive, _acting(parameters[:, None])), True, uniform)

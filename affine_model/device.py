"""The device that simulates: the CPU (gaits through torch if it is installed) or a CUDA device."""

from __future__ import annotations

import importlib.util

from tentacle.errors import InputError

AUTO, CPU = "auto", "cpu"


def needs_torch(field: str) -> None:
    """InputError where torch is missing."""
    if importlib.util.find_spec("torch") is None:
        raise InputError("PyTorch missing", field=field, expected="pip install 'tentacle-twin[gpu]'")


def chosen_device(asked: str, processor_only: bool = False) -> str | None:
    """The device of `auto`, `cpu`, `cuda` or `cuda:1`, as torch names it; None for the CPU where torch is missing.

    Without torch the same compiled kernel is called on numpy arrays. InputError where CUDA is asked for and missing.
    processor_only: `auto` takes no CUDA device.
    """
    if asked not in (AUTO, CPU) and not (asked == "cuda" or asked.removeprefix("cuda:").isdecimal()):
        raise InputError(f"{asked!r} is not known", field="device", expected="auto, cpu, cuda or cuda:NUMBER")
    missing = [name for name in ("torch", "warp") if importlib.util.find_spec(name) is None]
    if asked.startswith("cuda") and missing:
        words = " and ".join({"torch": "PyTorch", "warp": "NVIDIA Warp"}[name] for name in missing)
        raise InputError(f"{words} missing", field="device", expected="pip install 'tentacle-twin[gpu]'")
    if "torch" in missing:
        return None
    if asked == CPU or (asked == AUTO and processor_only):
        return CPU
    import torch

    if asked == AUTO:
        return "cuda" if torch.cuda.is_available() and not missing else CPU
    number = int(asked.partition(":")[2] or 0)
    if number >= torch.cuda.device_count():
        found = f"{torch.cuda.device_count()} CUDA devices are there"
        raise InputError(f"{found}; {asked} is not among them", field="device", expected="a device that torch sees")
    return asked


def cuda_device(asked: str) -> str | None:
    """The CUDA device of the same words for batches of tens of columns: None for the CPU, which `auto` means too.

    InputError where CUDA is asked for and missing. Loads torch only if CUDA is asked for.
    """
    found = chosen_device(asked, processor_only=True)
    return None if found == CPU else found

"""Compiles the generated kernel once and keeps it: machine code in the user's cache folder, named by the hash of all
that decides over it.

Two kernels a (nodes, order): of BLOCK lanes for a batch, and of FEW lanes for what is left of it, so that few pay for
few empty ones.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from affine_model.cores import usable_cores
from affine_model.kernel.arguments import packed
from affine_model.kernel.generate import BLOCK, FEW, KernelParts, kernel_parts
from affine_model.kernel.machine_code import Loaded, arguments_of, compiler, object_code
from tentacle.law.in_use import follows_laws
from tentacle.private_cache import cache_folder, sealed, unsealed

__all__ = ["BLOCK", "FEW", "advance_blocks", "load_kernel"]


@dataclass(frozen=True)
class Kernel:
    """A compiled kernel, and the names of its arguments."""

    code: Loaded
    names: list[str]


def _file(name: str, *decisive: str, suffix: str = ".py") -> Path:
    digest = hashlib.sha256("\0".join(decisive).encode()).hexdigest()[:16]
    return cache_folder("kernels", "TENTACLE_KERNELS") / f"{name}_{digest}{suffix}"


def _code_file(parts: KernelParts) -> Path:
    size = "_".join(str(parts.constants[name]) for name in ("NODES", "n", "BLOCK"))
    return _file(f"kernel_{size}", repr(parts), compiler(), suffix=".o")


def is_compiled(nodes: int, order: int) -> bool:
    """Whether this computer has both kernels in machine code already."""
    return all(_code_file(kernel_parts(nodes, order, lanes)).exists() for lanes in (BLOCK, FEW))


@follows_laws
def load_kernel(nodes: int, order: int, lanes: int = BLOCK, free: bool = False) -> Kernel:
    """The kernel for that number of quadrature nodes, curvatures and lanes, of a base that floats or not;
    compiled on first use (1 to 2 s), then loaded from the cache.
    """
    parts = kernel_parts(nodes, order, lanes, free)
    file = _code_file(parts)
    code = unsealed(file)
    if code is None:
        code = object_code(parts.text(), lanes)
        with suppress(OSError):  # a full or read-only disk is no reason to end a run
            partial = file.with_suffix(f".{os.getpid()}.part")
            partial.write_bytes(sealed(file, code))
            partial.replace(file)
    return Kernel(Loaded(code), arguments_of(parts.template))


def module_of(name: str, source: str) -> ModuleType:
    """The module of a generated text, which is kept in the cache folder under its name and the hash of the text. The
    text that is run is this one, whatever lies there.
    """
    path = _file(name, source)
    if not path.exists() or path.read_bytes() != source.encode():
        partial = path.with_suffix(f".{os.getpid()}.part")
        partial.write_text(source)
        partial.replace(path)
    module = ModuleType(path.stem)
    module.__file__ = str(path)
    sys.modules[path.stem] = module
    exec(compile(source, str(path), "exec"), module.__dict__)
    return module


def advance_blocks(nodes: int, order: int, count: int, *arguments: Any, free: bool = False) -> None:
    """Run the kernel over `count` individuals, block by block, on every core that affine_model.cores tells.

    It uses Python threads, and the kernel releases the interpreter lock. A block writes to its own individuals' columns
    alone.
    """
    blocks = list(_blocks(count))
    kernels = {lanes: load_kernel(nodes, order, lanes, free) for lanes in {lanes for lanes, _ in blocks}}
    words, held = packed(next(iter(kernels.values())).names, arguments)
    address = words.ctypes.data

    def run(block: tuple[int, int]) -> None:
        kernels[block[0]].code.run(block[1], address)

    cores = usable_cores()
    if len(blocks) == 1 or cores == 1:
        for block in blocks:
            run(block)
    else:
        with ThreadPoolExecutor(min(len(blocks), cores)) as pool:
            for _ in pool.map(run, blocks):
                pass
    del held  # the arrays lived until here


def _blocks(count: int) -> Iterator[tuple[int, int]]:
    """(lanes, place) of every block of so many individuals: whole ones, and a small one where it holds the rest."""
    whole, rest = divmod(count, BLOCK)
    for place in range(whole + (rest > FEW)):
        yield BLOCK, place
    if 0 < rest <= FEW:
        yield FEW, whole * (BLOCK // FEW)

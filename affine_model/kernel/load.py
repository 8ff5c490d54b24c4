"""Compiles the generated kernel once and keeps it: machine code in the user's cache folder, named by the hash of its
text and of all else that decides over it.

Two kernels a (nodes, order): of BLOCK lanes for a batch, and of FEW lanes, so that one arm alone pays for few empty
ones.
"""

from __future__ import annotations

import hashlib
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from affine_model.kernel.arguments import packed
from affine_model.kernel.generate import BLOCK, FEW, kernel_source
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


def _code_file(nodes: int, order: int, lanes: int, text: str) -> Path:
    return _file(f"kernel_{nodes}_{order}_{lanes}", text, compiler(), suffix=".o")


def is_compiled(nodes: int, order: int) -> bool:
    """Whether this computer has both kernels in machine code already."""
    return all(_code_file(nodes, order, k, kernel_source(nodes, order, k)).exists() for k in (BLOCK, FEW))


@follows_laws
def load_kernel(nodes: int, order: int, lanes: int = BLOCK, free: bool = False) -> Kernel:
    """The kernel for that number of quadrature nodes, curvatures and lanes, of a base that floats or not;
    compiled on first use (1 to 2 s), then loaded from the cache.
    """
    text = kernel_source(nodes, order, lanes, free)
    file = _code_file(nodes, order, lanes, text)
    code = unsealed(file)
    if code is None:
        code = object_code(text, lanes)
        with suppress(OSError):  # a full or read-only disk is no reason to end a run
            partial = file.with_suffix(f".{os.getpid()}.part")
            partial.write_bytes(sealed(file, code))
            partial.replace(file)
    return Kernel(Loaded(code), arguments_of(text))


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
    """Run the kernel over `count` individuals, block by block, on every core this process may use.

    It uses Python threads, and the kernel releases the interpreter lock. A block writes to its own individuals' columns
    alone.
    """
    lanes = FEW if count <= FEW else BLOCK
    kernel = load_kernel(nodes, order, lanes, free)
    words, held = packed(kernel.names, arguments)
    blocks, address = range(-(-count // lanes)), words.ctypes.data
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if len(blocks) == 1 or cores == 1:
        for block in blocks:
            kernel.code.run(block, address)
    else:
        with ThreadPoolExecutor(min(len(blocks), cores)) as pool:
            for _ in pool.map(lambda block: kernel.code.run(block, address), blocks):
                pass
    del held  # the arrays lived until here

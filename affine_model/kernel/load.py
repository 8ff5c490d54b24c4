"""Compiles the generated kernel once and keeps it: a module in the user's cache folder, named by the hash of its text.

Always the text generated here is run, never another text in the cache; tentacle.compiled checks numba's own cache.
"""

from __future__ import annotations

import hashlib
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import ModuleType
from typing import Any

from affine_model.kernel.generate import BLOCK, kernel_source
from tentacle.law.in_use import follows_laws
from tentacle.private_cache import cache_folder

__all__ = ["BLOCK", "advance_blocks", "load_kernel"]


def _file(name: str, source: str) -> Path:
    name = f"{name}_{hashlib.sha256(source.encode()).hexdigest()[:16]}"
    return cache_folder("kernels", "TENTACLE_KERNELS") / f"{name}.py"


def is_compiled(nodes: int, order: int) -> bool:
    """Whether this computer has the kernel in machine code already: numba's index of it lies in the cache."""
    file = _file(f"kernel_{nodes}_{order}", kernel_source(nodes, order))
    return any(file.parent.glob(f"__pycache__/{file.stem}.advance-*.nbi"))


@follows_laws
def load_kernel(nodes: int, order: int) -> ModuleType:
    """The kernel for that number of quadrature nodes and curvatures; compiled on first use (several seconds),
    then loaded from the cache.
    """
    return module_of(f"kernel_{nodes}_{order}", kernel_source(nodes, order))


def module_of(name: str, source: str) -> ModuleType:
    """The module of a generated text, which is kept in the cache folder under its name and the hash of the text."""
    path = _file(name, source)
    if not path.exists() or path.read_bytes() != source.encode():  # numba's cache goes by the file's age and size
        partial = path.with_suffix(f".{os.getpid()}.part")
        partial.write_text(source)
        partial.replace(path)
    module = ModuleType(path.stem)
    module.__file__ = str(path)
    sys.modules[path.stem] = module
    exec(compile(source, str(path), "exec"), module.__dict__)  # the text made here, whatever lies in the cache
    return module


def advance_blocks(nodes: int, order: int, count: int, *arguments: Any) -> None:
    """Run the kernel over `count` individuals, block by block, on every core this process may use.

    It uses Python threads, and the kernel releases the interpreter lock; to compile numba's own parallel loop would
    take as long as the kernel itself. A block writes to its own individuals' columns alone.
    """
    kernel = load_kernel(nodes, order)
    blocks = -(-count // BLOCK)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if blocks == 1 or cores == 1:
        for block in range(blocks):
            kernel.advance(block, *arguments)
        return
    begun = 0
    if not kernel.advance.signatures:  # compiled in this thread: Ctrl-C need not wait until a thread has compiled
        kernel.advance(0, *arguments)
        begun = 1
    with ThreadPoolExecutor(min(blocks, cores)) as pool:
        for _ in pool.map(lambda block: kernel.advance(block, *arguments), range(begun, blocks)):
            pass

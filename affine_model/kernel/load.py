"""Compiles the generated kernel once and keeps it: a module in the user's cache folder,
named by the hash of its text.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from affine_model.kernel.generate import BLOCK, kernel_source

__all__ = ["BLOCK", "advance_blocks", "load_kernel"]


def _cache_folder() -> Path:
    """TENTACLE_KERNELS, or TENTACLE_CACHE, or the user's cache folder; a temporary one where none can be written."""
    base = os.environ.get("TENTACLE_KERNELS") or os.environ.get("TENTACLE_CACHE") or os.environ.get("XDG_CACHE_HOME")
    base = base or str(Path.home() / ".cache")
    folder = Path(base) / "tentacle-twin" / "kernels"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError:
        folder = Path(tempfile.mkdtemp(prefix="tentacle-kernels-"))
    return folder


@cache
def load_kernel(nodes: int, order: int) -> ModuleType:
    """The kernel for that number of quadrature nodes and curvatures; compiled on first use (several seconds),
    then loaded from the cache.
    """
    source = kernel_source(nodes, order)
    name = f"kernel_{nodes}_{order}_{hashlib.sha256(source.encode()).hexdigest()[:16]}"
    path = _cache_folder() / f"{name}.py"
    if not path.exists():
        partial = path.with_suffix(f".{os.getpid()}.part")
        partial.write_text(source)
        partial.replace(path)
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"cannot load the generated kernel {path}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def advance_blocks(nodes: int, order: int, count: int, *arguments: Any) -> None:
    """Run the kernel over `count` individuals, block by block, on every core this process may use.

    Threads of Python, which the kernel frees while it computes: numba's own parallel loop costs as much to compile
    again as the kernel itself. A block writes to its own individuals' columns alone.
    """
    kernel = load_kernel(nodes, order)
    blocks = -(-count // BLOCK)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if blocks == 1 or cores == 1:
        for block in range(blocks):
            kernel.advance(block, *arguments)
        return
    with ThreadPoolExecutor(min(blocks, cores)) as pool:
        for _ in pool.map(lambda block: kernel.advance(block, *arguments), range(blocks)):
            pass

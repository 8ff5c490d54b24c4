"""Compiles the model, once on each computer, while a verb still reads and tracks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def kernels_ahead(stage: Callable[[str], None]) -> Iterator[Callable[[], None]]:
    """Compiles in parallel to the block; the yielded function waits until the compiler is done."""
    from affine_model.warm import start_compiling

    compiler = start_compiling()

    def wait() -> None:
        if compiler is not None and compiler.poll() is None:
            stage("compiling the model for this computer (once)")
            compiler.wait()

    try:
        yield wait
    finally:
        if compiler is not None and compiler.poll() is None:
            compiler.terminate()
            compiler.wait()

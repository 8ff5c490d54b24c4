"""The compiled model, made ready while a verb still reads and tracks: the first run on a computer compiles it once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def kernels_ahead(stage: Callable[[str], None]) -> Iterator[Callable[[], None]]:
    """Compiles beside what the block does; the function that it gives waits until that is done."""
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

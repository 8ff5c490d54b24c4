"""Compiles what a verb runs, once on each computer, while the verb still reads, films or tracks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def kernels_ahead(stage: Callable[[str], None]) -> Iterator[Callable[[], None]]:
    """Compiles the model and its fit in parallel to the block; the yielded function waits until they are there."""
    with _compiled_ahead(["kernels", "fit"], stage, "compiling the model for this computer (once)") as wait:
        yield wait


@contextmanager
def tracking_ahead(stage: Callable[[str], None]) -> Iterator[Callable[[], None]]:
    """The same for the tracker: for a verb that has other work before it tracks."""
    with _compiled_ahead(["tracking"], stage, "compiling the tracker for this computer (once)") as wait:
        yield wait


@contextmanager
def _compiled_ahead(parts: list[str], stage: Callable[[str], None], words: str) -> Iterator[Callable[[], None]]:
    from affine_model.warm import not_compiled
    from validation.compile_ahead import start

    compiler = start(parts) if not_compiled() else None  # a computer without the kernels has not compiled the rest

    def wait() -> None:
        if compiler is not None and compiler.poll() is None:
            stage(words)
            compiler.wait()

    try:
        yield wait
    finally:
        if compiler is not None and compiler.poll() is None:
            compiler.terminate()
            compiler.wait()

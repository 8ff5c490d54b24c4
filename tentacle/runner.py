"""Many runs of one function: on this machine's processes or a Dask cluster, stored as they finish, never done twice.

A task is plain data (what JSON holds), a result plain data and arrays. A result's file is named by the hash of the
function's name, its version and the task, and appears whole or not at all: after a kill -9 the same call goes on where
it was. Files are JSON, or NPZ without pickle where there are arrays.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from tentacle.errors import InputError

Task = Mapping[str, Any]
Result = Mapping[str, Any]
Work = Callable[[Task], Result]


@dataclass(frozen=True)
class Runner:
    """Where tasks run and results lie.

    folder: of the result files; workers: processes (None: one a core); scheduler: address of a Dask scheduler instead
    ("tcp://127.0.0.1:8786"), whose workers must have the project installed; quiet: no progress bar.
    """

    folder: Path
    workers: int | None = None
    scheduler: str | None = None
    quiet: bool = False

    def run(self, work: Work, tasks: Sequence[Task], *, version: str = "1", words: str = "") -> list[Result]:
        """The results in the order of the tasks.

        work: a function at a module's top level; version: to be changed when what it computes changes; words: beside
        the progress bar. What a task raises is raised here, after the others that were under way are stored.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        files = [self.file_of(work, task, version) for task in tasks]
        found = [load_result(file) for file in files]
        missing = [index for index, result in enumerate(found) if result is None]
        with _progress(len(tasks), len(tasks) - len(missing), words, self.quiet) as advance:
            for index, result in self._finished(work, [(i, tasks[i]) for i in missing]):
                store_result(result, files[index])
                found[index] = load_result(files[index])  # as a later call would find it
                advance()
        return [result for result in found if result is not None]

    def file_of(self, work: Work, task: Task, version: str = "1") -> Path:
        """The path of a task's result, without its suffix: the hash of all that the result depends on."""
        try:
            text = json.dumps(
                [work.__module__, work.__qualname__, version, task], sort_keys=True, allow_nan=False, ensure_ascii=True
            )
        except (TypeError, ValueError) as error:
            raise InputError(f"a task is not plain data: {error}", expected="what JSON holds") from None
        return self.folder / hashlib.sha256(text.encode()).hexdigest()[:32]

    def _finished(self, work: Work, tasks: Sequence[tuple[int, Task]]) -> Iterator[tuple[int, Result]]:
        if not tasks:
            return
        yield from (self._on_dask if self.scheduler else self._on_processes)(work, tasks)

    def _on_processes(self, work: Work, tasks: Sequence[tuple[int, Task]]) -> Iterator[tuple[int, Result]]:
        # spawn, not fork: a forked child inherits the locks of numba's and Rerun's threads and can stand still
        workers = min(self.workers or os.cpu_count() or 1, len(tasks))
        pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"))
        try:
            waiting: dict[Future[Result], int] = {pool.submit(work, task): index for index, task in tasks}
            while waiting:
                done, _ = wait(waiting, return_when=FIRST_COMPLETED)
                good = [future for future in done if future.exception() is None]
                yield from ((waiting.pop(future), future.result()) for future in good)
                for future in done.difference(good):
                    future.result()  # raises what the task raised, now that its neighbours are stored
        finally:
            pool.shutdown(wait=True, cancel_futures=True)

    def _on_dask(self, work: Work, tasks: Sequence[tuple[int, Task]]) -> Iterator[tuple[int, Result]]:
        try:
            from distributed import Client, as_completed
        except ImportError:
            raise InputError("a scheduler needs Dask", expected="pip install 'tentacle-twin[cluster]'") from None
        try:
            client = Client(self.scheduler, timeout="10s", set_as_default=False)
        except OSError:
            raise InputError(f"no Dask scheduler answers at {self.scheduler}", field="--scheduler") from None
        with client:
            futures = {client.submit(work, dict(task), pure=False): index for index, task in tasks}
            for future in as_completed(list(futures), loop=client.loop):
                yield futures[future], future.result()


@contextmanager
def _progress(total: int, done: int, words: str, quiet: bool) -> Iterator[Callable[[], None]]:
    """A progress bar on stderr with the time left; what it yields is to be called once a finished task."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), disable=quiet) as progress:
        line = progress.add_task(words or "running", total=total, completed=done)
        yield lambda: progress.advance(line)


def store_result(result: Result, file: Path) -> Path:
    """Write a result beside `file`, .json, or .npz where it holds arrays; the file appears whole or not at all."""
    arrays = {name: value for name, value in result.items() if isinstance(value, np.ndarray)}
    plain = {name: value for name, value in result.items() if name not in arrays}
    suffix = ".npz" if arrays else ".json"
    partial = file.with_name(f".{file.name}.{os.getpid()}.partial{suffix}")
    text = json.dumps(plain)
    if arrays:
        if "plain" in arrays or any(value.dtype.hasobject for value in arrays.values()):
            raise ValueError("an array of a result is named `plain` or holds objects")
        contents: dict[str, Any] = {"plain": np.array(text), **arrays}
        np.savez_compressed(partial, **contents)
    else:
        partial.write_text(text, encoding="utf-8")
    final = file.with_name(file.name + suffix)
    partial.replace(final)
    return final


def load_result(file: Path) -> Result | None:
    """The result stored beside `file`; None where there is none."""
    plain, arrays = file.with_name(file.name + ".json"), file.with_name(file.name + ".npz")
    if plain.exists():
        return json.loads(plain.read_text(encoding="utf-8"))
    if not arrays.exists():
        return None
    with np.load(arrays, allow_pickle=False) as stored:
        values = {name: stored[name] for name in stored.files if name != "plain"}
        return {**json.loads(str(stored["plain"])), **values}

"""Many runs of one function, on this machine's processes or a Dask cluster; each result is stored at once and never
computed twice.

A task is plain data (what JSON holds), a result plain data and arrays. A result's file is named by the hash of the
function's name, its version and the task, and is complete or absent. After a kill -9 the same call continues. Files are
JSON, or NPZ without pickle where there are arrays.
"""

from __future__ import annotations

import hashlib
import json
import os
import signal
import socket
import sys
import threading
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import active_children, get_context, parent_process
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from tentacle.errors import InputError
from tentacle.held_signals import signals_held
from tentacle.io.written_file import written_file

Task = Mapping[str, Any]
Result = Mapping[str, Any]
Work = Callable[[Task], Result]
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
ANSWER = 10.0  # s; a scheduler that does not answer by then is taken for absent


@dataclass(frozen=True)
class Runner:
    """The place of tasks and results. folder: of the result files; workers: processes (None: one per core); scheduler:
    address of a Dask scheduler instead ("tcp://127.0.0.1:8786"), whose workers must have the project installed; quiet:
    no progress bar (only terminals have one).
    """

    folder: Path
    workers: int | None = None
    scheduler: str | None = None
    quiet: bool = False

    def run(self, work: Work, tasks: Sequence[Task], *, version: str = "1", words: str = "") -> list[Result]:
        """The results in the order of the tasks.

        work: a function at a module's top level; version: to be changed when what it computes changes; words: beside
        the progress bar. An exception of a task is raised here, after the results of the other running tasks are
        stored.
        """
        if self.workers is not None and self.workers < 1:
            raise InputError(f"{self.workers} is too few", field="--workers", expected="1 or more")
        files = [self.file_of(work, task, version) for task in tasks]
        self.folder.mkdir(parents=True, exist_ok=True)
        missing = {file: task for file, task in zip(files, tasks, strict=True) if not is_stored(file)}
        console = Console(stderr=True)
        with progress_bar(console, quiet=self.quiet or not console.is_terminal) as progress:
            stored = sum(file not in missing for file in files)
            line = progress.add_task(words or "running", total=stored + len(missing), completed=stored)
            if missing:
                stored_now = (
                    self._on_dask(self.scheduler, work, missing)
                    if self.scheduler
                    else self._on_processes(work, missing)
                )
                for _ in stored_now:
                    progress.advance(line)
        return [load_result(file) for file in files]

    def file_of(self, work: Work, task: Task, version: str = "1") -> Path:
        """The path of a task's result, without its suffix: the hash of all that the result depends on."""
        try:
            text = json.dumps(
                [work.__module__, work.__qualname__, version, task], sort_keys=True, allow_nan=False, ensure_ascii=True
            )
        except (TypeError, ValueError) as error:
            raise InputError(f"a task is not plain data: {error}", expected="what JSON holds") from None
        return self.folder / hashlib.sha256(text.encode()).hexdigest()[:32]

    def _on_processes(self, work: Work, tasks: Mapping[Path, Task]) -> Iterator[None]:
        """Yields once for every stored task. The workers store the results; this process only waits."""
        cores = os.cpu_count() or 1
        workers = min(self.workers or cores, len(tasks))
        others = active_children()
        with _threads_of_children(max(1, cores // workers)):
            # spawn, not fork: a forked child inherits the locks of numba's and Rerun's threads and can hang
            pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_begin_worker)
            try:
                with signals_held():
                    futures = [pool.submit(_work_and_store, work, task, file) for file, task in tasks.items()]
                for future in as_completed(futures):
                    yield future.result()
            except BrokenProcessPool:
                raise InputError(
                    "a worker process was killed (out of memory?)",
                    field="--workers",
                    expected="fewer of them; run again, and it goes on where it was",
                ) from None
            except (KeyboardInterrupt, GeneratorExit):
                for process in set(active_children()).difference(others):
                    process.terminate()  # stored results stay; interrupted tasks start again next time
                raise
            finally:
                pool.shutdown(wait=True, cancel_futures=True)

    def _on_dask(self, scheduler: str, work: Work, tasks: Mapping[Path, Task]) -> Iterator[None]:
        """Yields once for every task; the results are stored here, so that a cluster's workers need no access to this
        disk.
        """
        try:
            import distributed
            from distributed.comm.addressing import get_address_host_port
        except ImportError:
            raise InputError("a scheduler needs Dask", expected="pip install 'tentacle-twin[cluster]'") from None
        try:
            # A plain connection answers at once; a client first starts its own event loop.
            socket.create_connection(get_address_host_port(scheduler), timeout=ANSWER).close()
            client: Any = distributed.Client(scheduler, timeout=ANSWER, set_as_default=False)
        except (OSError, ValueError):
            raise InputError(
                f"no Dask scheduler answers at {scheduler}", field="--cluster", expected="tcp://HOST:PORT"
            ) from None
        with client:
            futures = {client.submit(work, dict(task), pure=False): file for file, task in tasks.items()}
            failed = None
            for future in distributed.as_completed(list(futures), loop=client.loop):
                if future.status == "finished":
                    store_result(future.result(), futures[future])
                    yield
                elif failed is None:
                    failed = future
                    under_way = {key for keys in client.processing().values() for key in keys}
                    client.cancel([other for other in futures if not other.done() and other.key not in under_way])
            if failed is not None:
                failed.result()  # raises the task's exception, after the other results are stored


def progress_bar(console: Console, quiet: bool = False, clock: Callable[[], float] | None = None) -> Progress:
    """Progress with the time taken and the time left; the clock [s] is for tests."""
    columns = (
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(),
        TextColumn("left"), TimeRemainingColumn(),
    )  # fmt: skip
    # The speed is that of the whole run: a task may take longer than the half minute that rich looks back.
    return Progress(
        *columns, console=console, disable=quiet, refresh_per_second=2, speed_estimate_period=1e6, get_time=clock
    )


@contextmanager
def _threads_of_children(count: int) -> Iterator[None]:
    """The environment in which started processes compute on that many threads each: together, one a core."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, str(count)))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _begin_worker() -> None:
    """Ctrl-C reaches every process of a terminal, but only the first one reacts. If that process is killed, its workers
    end.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)  # its unfinished task is not stored, and starts again next time


def _work_and_store(work: Work, task: Task, file: Path) -> None:
    store_result(work(task), file)


def is_stored(file: Path) -> bool:
    """Whether a sound result is beside `file`; a damaged one is removed and therefore computed again."""
    for suffix in (".json", ".npz"):
        stored = file.with_name(file.name + suffix)
        if not stored.exists():
            continue
        try:
            check_result(stored)
        except InputError as error:
            print(f"tentacle: {error.line()}: computed again", file=sys.stderr)
            stored.unlink()
            continue
        return True
    return False


def check_result(stored: Path) -> None:
    """InputError where a stored result does not agree with its checksum, or cannot be read."""
    try:
        load_result(stored.with_suffix(""))
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, zlib.error, EOFError) as error:
        raise InputError(f"damaged: {error}", file=stored, expected="a stored result as it was written") from None


def store_result(result: Result, file: Path) -> Path:
    """Write a result beside `file`, .json, or .npz where it holds arrays; the file appears whole or not at all.

    A .json ends with a line that holds the SHA-256 of what is before it; a .npz has its own CRC-32s.
    """
    arrays = {name: value for name, value in result.items() if isinstance(value, np.ndarray)}
    plain = {name: value for name, value in result.items() if name not in arrays}
    final = file.with_name(file.name + (".npz" if arrays else ".json"))
    text = json.dumps(plain)
    with written_file(final) as partial:
        if arrays:
            if "plain" in arrays or any(value.dtype.hasobject for value in arrays.values()):
                raise ValueError("an array of a result is named `plain` or holds objects")
            contents: dict[str, Any] = {"plain": np.array(text), **arrays}
            with partial.open("wb") as opened:
                np.savez_compressed(opened, **contents)
        else:
            partial.write_text(f"{text}\n{hashlib.sha256(text.encode()).hexdigest()}\n", encoding="utf-8")
    return final


def load_result(file: Path) -> Result:
    """The result stored beside `file`; FileNotFoundError if there is none, ValueError if it is damaged."""
    plain, arrays = file.with_name(file.name + ".json"), file.with_name(file.name + ".npz")
    if plain.exists():
        text, _, sha256 = plain.read_text(encoding="utf-8").partition("\n")
        if sha256.strip() not in ("", hashlib.sha256(text.encode()).hexdigest()):  # "": before there were checksums
            raise ValueError("it does not agree with its checksum")
        return json.loads(text)
    with np.load(arrays, allow_pickle=False) as stored:
        values = {name: stored[name] for name in stored.files if name != "plain"}
        return {**json.loads(str(stored["plain"])), **values}

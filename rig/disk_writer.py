"""All access to a run's file is in a separate thread, so that a hanging disk does not keep the board waiting.

The thread is a daemon: a disk that never answers does not keep the program from ending.
"""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from pathlib import Path

from rig.fault import Fault

SLOWEST_DISK = 4.0  # s; a disk that takes longer is lost


class DiskWriter:
    """Runs jobs one after the other. A job that fails, or takes longer than WITHIN, is a Fault("disk")."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._jobs: queue.SimpleQueue[tuple[Callable[[], None], Future[None]] | None] = queue.SimpleQueue()
        self._under_way: Future[None] | None = None
        self._begun_at = 0.0
        threading.Thread(target=self._run, name="recorder", daemon=True).start()

    def begin(self, job: Callable[[], None]) -> bool:
        """Begins a job without waiting for it; False if the previous job is still running. Fault("disk") if that job
        has failed, or takes too long.
        """
        if self._under_way is not None:
            if not self._under_way.done():
                if time.monotonic() - self._begun_at > SLOWEST_DISK:
                    raise self._late()
                return False
            self.wait()
        self._begun_at = time.monotonic()
        self._under_way = Future()
        self._jobs.put((job, self._under_way))
        return True

    def wait(self) -> None:
        """Until the running job is done. Fault("disk") if it fails, or takes too long."""
        under_way, self._under_way = self._under_way, None
        if under_way is None:
            return
        try:
            under_way.result(max(SLOWEST_DISK - (time.monotonic() - self._begun_at), 0.0))
        except TimeoutError:
            raise self._late() from None

    def close(self, last: Callable[[], None]) -> None:
        """Ends the thread once what is under way and then `last` are done. It is not waited for."""
        self._jobs.put((last, Future()))
        self._jobs.put(None)

    def _late(self) -> Fault:
        return Fault("disk", f"{self._path} was not written within {SLOWEST_DISK:g} s")

    def _run(self) -> None:
        while (entry := self._jobs.get()) is not None:
            job, future = entry
            try:
                job()
            except Fault as fault:
                future.set_exception(fault)
            except Exception as error:  # rerun raises its own, undocumented, kinds here
                words = getattr(error, "strerror", None) or str(error)
                with suppress(Exception):
                    future.set_exception(Fault("disk", f"{self._path} cannot be written: {words}"))
            else:
                future.set_result(None)

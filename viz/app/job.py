"""A verb that runs beside the page: its own process, the share it says is done, and a way to stop it."""

from __future__ import annotations

import asyncio
import os
import shlex
import sys
from collections import deque
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

LAST_WORDS = 1.0  # s for what an ended command has said to be read
JobState = Literal["waiting", "running", "done", "failed", "stopped"]


@dataclass
class Job:
    """One command line in a folder. share 0 to 1, words: what it is at, or how it ended; said: its output."""

    arguments: list[str]
    folder: Path
    state: JobState = "waiting"
    share: float = 0.0
    words: str = "waiting"
    said: list[str] = field(default_factory=list)
    _process: asyncio.subprocess.Process | None = None

    @property
    def line(self) -> str:
        """The command as one types it."""
        return shlex.join(["tentacle", *self.arguments])

    async def run(self) -> None:
        """Run it to its end."""
        if self.state == "stopped":
            return
        self.state, self.words = "running", "starting"
        told = {**os.environ, "TENTACLE_PROGRESS": "lines", "PYTHONUNBUFFERED": "1"}
        self._process = await asyncio.create_subprocess_exec(
            sys.executable, "-m", "tentacle", *self.arguments, cwd=self.folder, env=told,
            stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE,
        )  # fmt: skip
        errors: deque[str] = deque(maxlen=20)
        heard = [asyncio.create_task(self._read_progress(errors)), asyncio.create_task(self._read_output())]
        while (status := self._process.returncode) is None:  # wait() waits for the ends of its pipes, too
            await asyncio.sleep(0.05)
        await asyncio.wait(heard, timeout=LAST_WORDS)  # what it started may outlive it and hold its output open
        for reading in heard:
            reading.cancel()
        if self.state == "stopped":
            return
        if status == 0:
            self.state, self.share, self.words = "done", 1.0, "done"
        else:
            self.state, self.words = "failed", errors[-1] if errors else f"ended with status {status}"

    async def _read_progress(self, errors: deque[str]) -> None:
        assert self._process is not None
        assert self._process.stderr is not None
        async for raw in self._process.stderr:
            share, tab, words = raw.decode(errors="replace").rstrip().partition("\t")
            if tab:
                self.share, self.words = float(share), words
            elif share:
                errors.append(share)

    async def _read_output(self) -> None:
        assert self._process is not None
        assert self._process.stdout is not None
        async for raw in self._process.stdout:
            self.said.append(raw.decode(errors="replace").rstrip())

    def stop(self) -> None:
        """End it; what it has not written whole is not there."""
        if self.state in ("waiting", "running"):
            self.state, self.words = "stopped", "stopped"
            if self._process is not None and self._process.returncode is None:
                self._process.terminate()

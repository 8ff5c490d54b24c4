"""A headless Chromium that is told what to do over a pipe, so that a page may take its real time to load."""

from __future__ import annotations

import base64
import json
import os
import select
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

QUIET = ["--headless", "--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-sync"]
# WebGL without a GPU
DRAWING = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


class Tab:
    """One page of the browser: goes somewhere, and is photographed."""

    def __init__(self, asks: int, answers: int) -> None:
        self._asks, self._answers, self._heard, self._count = asks, answers, b"", 0
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]

    _session: str | None = None

    def ask(self, method: str, seconds: float = 60.0, **parameters: object) -> dict:
        """What the browser answers (the DevTools protocol: JSON, each message ended by a zero byte)."""
        self._count += 1
        said = {"id": self._count, "method": method, "params": parameters}
        if self._session is not None:
            said["sessionId"] = self._session
        os.write(self._asks, json.dumps(said).encode() + b"\0")
        deadline = time.monotonic() + seconds
        while True:
            while b"\0" not in self._heard:
                ready, _, _ = select.select([self._answers], [], [], max(0.0, deadline - time.monotonic()))
                assert ready, f"{method}: no answer"
                self._heard += os.read(self._answers, 1 << 20)
            message, _, self._heard = self._heard.partition(b"\0")
            answer = json.loads(message)
            if answer.get("id") == self._count:
                assert "error" not in answer, answer
                return answer["result"]

    def photograph(self) -> bytes:
        """A PNG of what is shown now."""
        return base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"])


@contextmanager
def browser(profile: Path, width: int = 1400, height: int = 900) -> Iterator[Tab]:
    """A tab of a Chromium that ends with the block."""
    (reads, asks), (answers, writes) = os.pipe(), os.pipe()
    options = [*QUIET, *DRAWING, "--remote-debugging-pipe", f"--user-data-dir={profile}", f"--window-size={width},{height}"]
    command = ["bash", "-c", f'exec chromium "$@" 3<&{reads} 4>&{writes}', "chromium", *options]
    process = subprocess.Popen(
        command, pass_fds=(reads, writes), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    os.close(reads)
    os.close(writes)
    try:
        yield Tab(asks, answers)
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        os.close(asks)
        os.close(answers)

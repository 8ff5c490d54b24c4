"""One case in a child of its own, with limits, and what became of it.

The parent has imported everything and run nothing, so a child starts in milliseconds and what it does ends with it.
"""

from __future__ import annotations

import faulthandler
import os
import re
import resource
import shutil
import signal
import sys
import time
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]
MEMORY = 12 * 2**30  # bytes of address space
GRACE = 15.0  # s within which a case that was asked to stop has ended
GOOD = ("done", "refused", "fault", "stopped")


@dataclass(frozen=True)
class Case:
    """A command on damaged inputs.

    inputs: names of the material that is copied into the case's folder, where the command runs; prepare damages them;
    verify says in a line what was changed without being told, "" where nothing was, after the command ended with 0;
    stop [s]: when it is asked to stop, by which signal; file_size [bytes]: the disk is full beyond it. Inputs, and
    the files `kept`, are to be afterwards what they were, however it ends.
    """

    name: str
    arguments: tuple[str, ...]
    inputs: tuple[str, ...] = ()
    prepare: Callable[[Path], None] = lambda _folder: None
    verify: Callable[[Path, str], str] | None = None
    stop: float = 40.0
    signal: signal.Signals = signal.SIGINT
    file_size: int | None = None
    environment: Mapping[str, str] = field(default_factory=dict)
    encoding: str | None = None
    must_refuse: bool = False
    kept: tuple[str, ...] = ()


@dataclass(frozen=True)
class Outcome:
    """What became of a case: one of GOOD, or what was bad; words: the first lines that it said; seconds it took."""

    name: str
    kind: str
    words: str
    seconds: float

    @property
    def good(self) -> bool:
        """Whether it was right, or refused in one line."""
        return self.kind in GOOD


def judge(case: Case, material: Path, place: Path) -> Outcome:
    """Runs a case in the folder `place`, which is made and removed."""
    place.mkdir(parents=True)
    for name in case.inputs:
        source = material / name
        shutil.copytree(source, place / name) if source.is_dir() else shutil.copy(source, place / name)
    case.prepare(place)
    before = {path: _content(path) for path in _kept(case, place)}
    place.with_suffix(".err").touch()
    begun = time.monotonic()
    child = os.fork()
    if child == 0:
        try:
            _run(case, place)
        finally:
            os._exit(71)  # whatever interrupts it: the parent's folders are not the child's to remove
    code = _waited(child, case.stop, case.signal)
    seconds = time.monotonic() - begun
    said = re.sub(r"Extension modules: .*", "", place.with_suffix(".err").read_text(errors="replace"))
    kind = _kind(case, code, said) if place.is_dir() else "removed its folder"
    if kind in GOOD and (changed := [path for path, content in before.items() if _content(path) != content]):
        kind, said = "overwritten", f"{changed[0].relative_to(place)}: {said}"
    left = [
        path.name
        for path in (place.iterdir() if place.is_dir() else ())
        if "partial" in path.name or re.match(r"\.(out|again)", path.name)
    ]
    if kind in GOOD and left:
        kind, said = "leftover", " ".join(left)
    if _others(child):
        kind, said = "left running" if kind in GOOD else kind, said
    shutil.rmtree(place, ignore_errors=True)
    return Outcome(case.name, kind, said.strip()[-2000:], seconds)


def _kept(case: Case, place: Path) -> list[Path]:
    """Regular files that the case was given."""
    given = [path for name in case.inputs for path in (place / name, *(place / name).rglob("*"))]
    return [
        path for path in (*given, *(place / name for name in case.kept)) if path.is_file() and not path.is_symlink()
    ]


def _content(path: Path) -> bytes | None:
    return path.read_bytes() if path.is_file() else None


def _run(case: Case, place: Path) -> None:
    """In the child: never returns."""
    code = 71
    try:
        os.setsid()
        for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):  # whoever started the trials may ignore them
            signal.signal(number, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        os.chdir(place)
        os.environ.update({"TENTACLE_TRACE": "1", **case.environment})
        faulthandler.enable(os.open(place.with_suffix(".err"), os.O_WRONLY | os.O_CREAT | os.O_APPEND))
        out = os.open(place.with_suffix(".out"), os.O_WRONLY | os.O_CREAT)
        err = os.open(place.with_suffix(".err"), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(out, 1)
        os.dup2(err, 2)
        encoding = case.encoding or "utf-8"
        sys.stdin = open(0, encoding=encoding, closefd=False)  # noqa: SIM115
        sys.stdout = open(1, "w", encoding=encoding, closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", encoding=encoding, errors="backslashreplace", closefd=False, buffering=1)  # noqa: SIM115
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if case.file_size is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (case.file_size, resource.RLIM_INFINITY))
        if case.arguments[0] == "view" and case.verify is None:
            # Rerun's threads wait on a queue that a forked child shares: what the child's viewer does there would
            # crash the parent. A program of its own has a queue of its own.
            os.environ.update({"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": encoding})
            os.execv(sys.executable, [sys.executable, "-m", "tentacle", *case.arguments])
        from tentacle.cli import main

        try:
            code = main(list(case.arguments))
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else 1
        sys.stdout.flush()
        if code == 0 and case.verify is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # the command has ended: what compares is not to be stopped
            changed = case.verify(place, place.with_suffix(".out").read_text(errors="replace"))
            if changed:
                print(changed, file=sys.stderr, flush=True)
                code = 72
    except BaseException:
        with suppress(BaseException):
            traceback.print_exc()
        code = 71
    with suppress(BaseException):
        sys.stderr.flush()
    os._exit(code)


def _waited(child: int, stop: float, number: signal.Signals) -> int:
    """The exit code, negative for a signal; -1000 where it did not end and was killed."""
    begun, asked = time.monotonic(), False
    while True:
        found, status = os.waitpid(child, os.WNOHANG)
        if found:
            return os.waitstatus_to_exitcode(status)
        taken = time.monotonic() - begun
        if taken > stop and not asked:
            asked = True
            os.kill(child, number)
        if taken > stop + GRACE:
            with suppress(ProcessLookupError):
                os.killpg(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return -1000
        time.sleep(0.003)


def _others(group: int) -> bool:
    """Whether something of the child's session still runs five seconds later; it is killed."""
    for _ in range(100):
        try:
            os.killpg(group, 0)
        except (ProcessLookupError, PermissionError):
            return False
        time.sleep(0.05)
    with suppress(ProcessLookupError):
        os.killpg(group, signal.SIGKILL)
    return True


def _kind(case: Case, code: int, said: str) -> str:
    lines = [line for line in said.splitlines() if line.strip()]
    stopped = {130: signal.SIGINT, 143: signal.SIGTERM, 129: signal.SIGHUP, 131: signal.SIGQUIT}
    if code == -1000:
        return "hang"
    if code == 72:
        return "silent"
    if "Traceback" in said or code in (70, 71):
        return "traceback"
    if code == -case.signal:
        return "stopped"  # before it had begun
    if code < 0:
        return f"abort {code}"
    if code == 0:
        return "accepted" if case.must_refuse else "done"
    if any("\x1b" in line for line in lines):
        return "escape"
    if code in (2, 3):
        told = [line for line in lines if line.startswith("tentacle")]
        return ("refused" if code == 2 else "fault") if len(lines) == len(told) == 1 else "lines"
    if stopped.get(code) == case.signal:
        return "stopped"
    return f"code {code}"

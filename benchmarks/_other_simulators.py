"""Other simulators of the same arm and motion, each in an environment of its own under a temporary folder.

One that cannot be installed is skipped, with the reason.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks._other_programs import PYELASTICA, SOROMOX, TORCHDIFFEQ

ROOT = Path(__file__).resolve().parents[1]
PATIENCE = 900.0  # s for an installation or a run


@dataclass(frozen=True)
class Other:
    """A simulator: its package, its program, what sets its accuracy (as the benchmark takes it, and far finer), how
    many runs it is given (a batch where it can), whether it needs our own packages, and how it differs.
    """

    package: str
    program: str
    accuracy: str
    coarse: float
    fine: float
    runs: int
    ours: bool
    says: str


OTHERS = (
    # 2e-5 s is unstable.
    Other("pyelastica", PYELASTICA, "step", 1e-5, 2.5e-6, 4, False, "20 elements, one run at a time; it also shears"),
    Other("soromox", SOROMOX, "tolerance", 1e-4, 1e-8, 50, False, "GVS order 1, drag through its Jacobians, Tsit5"),
    Other("torchdiffeq", TORCHDIFFEQ, "tolerance", 1e-4, 1e-8, 50, True, "our equations by torch, dopri5"),
)


@dataclass(frozen=True)
class Ran:
    """simulated seconds per second of wall time on all cores, and the tip's angle [rad] at the end of every run."""

    speed: float
    tip_angle: np.ndarray


@contextmanager
def environment(other: Other) -> Iterator[tuple[str, dict[str, str]]]:
    """Its interpreter and environment variables, while the temporary folder stands.

    Raises RuntimeError with the reason where it cannot be installed.
    """
    alone = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | {"OMP_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory(prefix="tentacle-benchmark-") as folder:
        if other.ours:  # it asks for torch, which stands here already
            python, options = sys.executable, ["--no-deps", "--target", folder]
            alone["PYTHONPATH"] = os.pathsep.join([folder, str(ROOT)])
        else:
            _run([sys.executable, "-m", "venv", folder], alone)
            python, options = str(Path(folder) / "bin" / "python"), []
        _run([python, "-m", "pip", "install", "--quiet", *options, other.package], alone)
        yield python, alone


def run(python: str, variables: dict[str, str], other: Other, arguments: dict[str, object], cores: list[int]) -> Ran:
    """Its runs shared out to one process for each core, all at once. Raises RuntimeError with the reason."""
    shares = np.array_split(np.arange(other.runs), min(len(cores), other.runs))
    motions = {name: np.array(arguments[name]) for name in ("amplitude", "frequency")}
    started = []
    for core, share in zip(cores, shares, strict=False):
        own = {**arguments, **{name: values[share].tolist() for name, values in motions.items()}}
        pinned = ["taskset", "-c", str(core)] if sys.platform == "linux" else []
        command = [*pinned, python, "-c", other.program, json.dumps(own)]
        started.append(
            subprocess.Popen(command, env=variables, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        )
    try:
        printed = [_answer(process) for process in started]
    finally:
        for process in started:
            process.kill()
    found = [json.loads(text.strip().splitlines()[-1]) for text in printed]
    simulated = [len(share) * float(str(arguments["seconds"])) for share in shares]
    speed = sum(length / one["seconds"] for length, one in zip(simulated, found, strict=True))
    return Ran(speed, np.concatenate([one["tip_angle"] for one in found]))


def _run(command: list[str], variables: dict[str, str]) -> None:
    _answer(subprocess.Popen(command, env=variables, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE))


def _answer(process: subprocess.Popen[str]) -> str:
    try:
        out, err = process.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired as expired:
        process.kill()
        raise RuntimeError(f"not done after {PATIENCE:.0f} s") from expired
    if process.returncode != 0:
        raise RuntimeError((err or out or "it failed").strip().splitlines()[-1])
    return out

"""An exported script run in its own program, by the interpreter that has it, beside the recording."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from affine_model.arm import parameter_vector
from affine_model.camera import sight_of
from mujoco_ref.export.script import Program, Script
from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.recording import Recording
from tentacle.signals import Array
from validation.export.start import Started, as_camera_has_it, distance_mm, start_of

BASE_STEP = 1e-3  # s, of the base's motion as samples: straight lines between them err by microradians
PATIENCE = 3600.0  # s for one recording


@dataclass(frozen=True)
class ScriptError:
    """rms distance to the recording's points [mm]: ours and the program's; frames judged; whether the fit of the common
    start converged.
    """

    name: str
    program: str
    ours_mm: float
    program_mm: float
    frames: int
    converged: bool = True

    def sentence(self) -> str:
        """Both errors."""
        return (
            f"{self.name}: ours {self.ours_mm:.3f} mm, {self.program} {self.program_mm:.3f} mm "
            f"({self.program_mm / self.ours_mm:.2f} times ours), rms over {self.frames} frames"
            f"{'' if self.converged else '; the fit of the start did not converge'}"
        )


def interpreter_with(program: Program, python: Path | None) -> str | None:
    """The interpreter that runs a program's script: the given one, else this one; None where it lacks the program.

    InputError where the given interpreter cannot be started.
    """
    command = [str(python or sys.executable), "-c", f"import {program.module}"]
    try:
        tried = subprocess.run(command, capture_output=True, timeout=PATIENCE, check=False)
    except OSError as error:
        raise InputError(
            error.strerror or str(error), field="--python", expected=f"an interpreter that has {program.name}"
        ) from None
    return command[0] if tried.returncode == 0 else None


def motion_numbers(model: Model, started: Started) -> dict[str, Any]:
    """The content of motion.json: the base's motion, the first state, the points and what was seen there (null: not
    seen), in the base frame of the arm.
    """
    t = np.arange(started.start - BASE_STEP, started.stop + 3.0 * BASE_STEP, BASE_STEP)
    sight, seen = sight_of(parameter_vector(model)), started.seen
    turn = np.array([[np.cos(sight.roll), -np.sin(sight.roll)], [np.sin(sight.roll), np.cos(sight.roll)]])
    offset = started.shift + model.specimen.length * np.array(sight.shift)
    points = (seen.xy - offset) @ turn / (1.0 + sight.excess)
    return {
        "start": started.start,
        "base": dict(zip(("t", "theta", "rate", "acceleration"), [t.tolist(), *started.base(t).tolist()], strict=True)),
        "q": started.q.tolist(),
        "q_rate": started.q_rate.tolist(),
        "times": started.t.tolist(),
        "s": seen.s.tolist(),
        "d": seen.d.tolist(),
        "points": np.where(np.isfinite(points), points, np.array(None, dtype=object)).tolist(),
    }


@dataclass(frozen=True)
class PreparedMotion:
    """A recording's start under a model, and the same as the content of motion.json."""

    model: Model
    recording: Recording
    started: Started
    motion: dict[str, Any]


def prepared(model: Model, recording: Recording) -> PreparedMotion:
    """Fit the start of a recording. InputError where it shows no arm."""
    started = start_of(model, recording)
    return PreparedMotion(model, recording, started, motion_numbers(model, started))


def script_error(made: Script, python: str, ready: PreparedMotion) -> ScriptError:
    """Run a script under a recording's base motion, from the common start."""
    started = ready.started
    shown = as_camera_has_it(ready.model, points_in_program(made, python, ready.motion), started.shift)
    return ScriptError(
        ready.recording.name,
        made.program.name,
        started.error_mm,
        distance_mm(started.seen.xy, shown),
        len(started.t),
        started.converged,
    )


def points_in_program(made: Script, python: str, motion: dict[str, Any]) -> Array:
    """Points (T, P, 2) [m] that the script finds. InputError with its last words where it fails."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made.write(folder)
        (folder / "motion.json").write_text(json.dumps(motion), encoding="utf-8")
        command = [python, "-I", made.program.script, "motion.json", "--out", "points.json"]
        try:
            ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE, check=False)
        except subprocess.TimeoutExpired:
            raise InputError(f"was not done after {PATIENCE:.0f} s", field=made.program.script) from None
        if ran.returncode != 0:
            last = (ran.stderr.strip() or "it failed without a word").splitlines()[-1]
            raise InputError(f"{made.program.name} says: {last}", field=made.program.script)
        return np.array(json.loads((folder / "points.json").read_text(encoding="utf-8")), dtype=float)

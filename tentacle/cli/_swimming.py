"""What `optimise` and `reproduce table2` share: gaits on the reference's rail, results as plain data, notes of a
running search.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

    from affine_model.simulate import Rail
    from affine_model.swim import Generation, Promise, Swimming
    from tentacle.gait import Gait
    from tentacle.model import Model

LEAD_IN_S, SETTLE_S, WINDOW_S, FPS = 1.0, 4.0, 16.0, 50.0


def reference_speed(model: Model, gait: Gait, rail: Rail | None = None) -> float:
    """Forward speed [m/s] of the MuJoCo reference under a gait, on the level rail of the affine trials."""
    from dataclasses import replace

    from affine_model.swim import PAPER_RAIL
    from mujoco_ref.mount import Rail as ReferenceRail
    from mujoco_ref.simulate import Setup, simulate

    rail = rail or PAPER_RAIL
    level = replace(model, gravity=replace(model.gravity, magnitude=0.0))
    carriage = ReferenceRail(rail.mass, viscous=rail.viscous, dry=rail.dry)
    run = simulate(level, gait, SETTLE_S + WINDOW_S, FPS, setup=Setup(rail=carriage, lead_in=LEAD_IN_S))
    start = round(SETTLE_S * FPS)
    # Forward is -y (affine_model.swim.trial).
    return -float((run.mount[-1, 1] - run.mount[start, 1]) / (run.t[-1] - run.t[start]))


def reference_thrust(model: Model, gait: Gait) -> float:
    """Mean forward thrust [N] of the MuJoCo reference under a gait, base clamped (eq. 17 averaged)."""
    import numpy as np

    from mujoco_ref.simulate import Setup, simulate

    run = simulate(model, gait, SETTLE_S + WINDOW_S, FPS, setup=Setup(lead_in=LEAD_IN_S))
    return -float(np.mean(run.thrust[round(SETTLE_S * FPS) :]))


def promise_table(promise: Promise) -> dict[str, Any]:
    """A promise as plain data, units in the names; a gait that does not swim has no cost of transport."""
    table = {
        "thrust_n": promise.thrust,
        "speed_m_s": promise.speed,
        "power_w": promise.power,
        "peak_torque_n_m": promise.torque,
    }
    return table if promise.speed <= 0.0 else {**table, "transport_j_m": promise.transport}


def result_tables(found: Swimming, waveform_table: Any) -> dict[str, Any]:
    """result.toml's tables: the gait as a [waveform] that every command reads, its promise, the sine, the search."""
    return {
        "waveform": waveform_table(found.gait),
        "promise": promise_table(found.promise),
        "sine": {"waveform": waveform_table(found.sine), "promise": promise_table(found.sine_promise)},
        "peaks": dict(zip(("angle_rad", "speed_rad_s", "acceleration_rad_s2"), found.peaks.tolist(), strict=True)),
        "search": {
            "objective": found.objective,
            "method": found.method,
            "seed": found.seed,
            "origin": found.origin,
            "evaluations": int(found.evaluations[-1]),
            "value": found.value,
            "sine_value": found.sine_value,
            "gain": found.gain,
        },
    }


def write_whole(path: Path, text: str) -> None:
    """Write a text file whole or not at all."""
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    partial.write_text(text, encoding="utf-8", newline="\n")
    partial.replace(path)


class SearchNotes:
    """The scores of a running search, one JSON line a generation, so that an interrupted one goes on where it was."""

    def __init__(self, path: Path, inputs: dict[str, Any]) -> None:
        """`inputs` name the search; notes of another search are put aside by overwriting."""
        self._path = path
        self.key = hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()

    def scores(self) -> Iterator[np.ndarray]:
        """The generations noted so far; the file is cut to its last whole line, and begun anew for another search."""
        import numpy as np

        self._path.parent.mkdir(parents=True, exist_ok=True)
        text = self._path.read_text(encoding="utf-8") if self._path.exists() else ""
        lines = text[: text.rfind("\n") + 1].splitlines()
        if not lines or lines[0] != json.dumps({"search": self.key}):
            lines = [json.dumps({"search": self.key})]
        write_whole(self._path, "\n".join(lines) + "\n")
        self._noted = len(lines) - 1
        return iter([np.array(json.loads(line)) for line in lines[1:]])

    def note(self, generation: Generation) -> None:
        """Add a generation, unless it was read from these notes."""
        if generation.number >= self._noted:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(generation.scores.tolist()) + "\n")

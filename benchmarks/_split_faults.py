"""Short runs written as the rig writes them, with faults on demand, and decisions without a diagnosis."""

from __future__ import annotations

import random
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rig.fault import Fault, RunEnd
from rig.motion import RigMotion
from rig.protocol import LoadSample
from rig.recorder import Recorder
from rig.setup_file import LoadCellCalibration
from rig.split_decision import Decision
from tentacle.io.declaration_file import declaration_tables
from tentacle.recording import Declaration
from tentacle.specimen import WATER, Cone, Specimen

CELL = LoadCellCalibration(1000.0, 180000.0)
DECLARED = declaration_tables(Declaration(Specimen(Cone(0.0125, 0.001), 0.14, 1070.0), WATER))
FAULTS = ("unplug", "overcurrent", "torn file", "kill", "disk full", "clock leap")
OUTCOMES: dict[str, RunEnd] = {"overcurrent": "overcurrent", "disk full": "disk", "clock leap": "watchdog"}
NEEDED = 4  # recordings after which the decisions below are split


class KilledError(Exception):
    """Stands for the end of the process: nothing after it runs."""


class FaultyBench:
    """Writes short runs; the faults (one for a run, "" for none) come in order, then none."""

    def __init__(self, faults: Sequence[str]) -> None:
        self.faults, self.made = list(faults), 0
        self.random = random.Random(len(self.faults))

    def make(self, motion: RigMotion, path: Path) -> Fault | None:
        """One run of a tenth of a second, and the fault that it met."""
        fault = self.faults.pop(0) if self.faults else ""
        self.made += 1
        start = {
            "name": path.stem, "recording": DECLARED, "lead_s": 0.0, "waveform": motion.description,
            "load_cell": {"offset_counts": CELL.offset, "counts_per_newton": CELL.slope},
        }  # fmt: skip
        if fault == "unplug":
            return Fault("link_lost", "the board is gone before the run begins")
        with Recorder(path, start, CELL.to_newtons) as recorder:
            recorder.begin(1_000_000)
            times = 1_000_000 + np.arange(0, 0.1, 0.0107) * 1e6
            recorder.samples([LoadSample(k, int(t), 1000 + self.made) for k, t in enumerate(times)])
            if fault == "kill":
                recorder.flush()
                raise KilledError
            outcome = OUTCOMES.get(fault, "complete")
            recorder.stop(outcome, {"start_us": 1_000_000, "rest_n": 0.0})
        if fault == "torn file":
            path.write_bytes(path.read_bytes()[: self.random.randrange(64, path.stat().st_size - 64)])
        return None if outcome == "complete" else Fault(outcome, fault)


def decided(runs: Sequence[Path]) -> Decision:
    """Two twins until NEEDED recordings, then one explanation."""
    split = len(runs) >= NEEDED
    motion = {"kind": "sine", "amplitude_rad": 0.2 + 0.05 * len(runs), "frequency_hz": 1.0}
    verdict = "effect" if split else "group"
    return Decision(verdict, "", ("drag",), 0.97 if split else 0.6, int(not split), motion, 9.0)

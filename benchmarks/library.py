"""A library of 2 000 simulated recordings: how long the index takes, a query, and what is diagnosed after a change.

The recordings are the reduced model's, 40 arms over 10 months. Their verdicts are written as a diagnosis would leave
them, not computed: 2 000 diagnoses take days of a processor, and what is measured here is the library. Then three
recordings change, and the tasks that a diagnosis would begin are counted. Memory: the most that a process of its own
held through refresh, query and page, less than 1 GB asked; query: table, condition and sort from files, < 1 s asked.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np

# benchmarks/vision.py must not stand for the room of that name.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from affine_model.curvature import midline
from affine_model.from_model import simulate_model
from affine_model.simulate import Timing
from benchmarks._figures import tell
from tentacle.io.library import conditions, open_library
from tentacle.io.library.layers import library_code_version, write_layer
from tentacle.io.recording_rrd import read_rrd, write_rrd
from tentacle.model import Estimate, Model
from tentacle.recording import Declaration, Recording
from tentacle.signals import Midline, MotorSignal
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Sine

RECORDINGS, ARMS, CHANGED = 2000, 40, 3
FPS, SECONDS = 30.0, 4.0
QUERY = ("verdict=effect", "effects~current", "confidence>0.9")


def make(folder: Path, count: int) -> None:
    """Recordings of ARMS arms, a few hours apart."""
    random, s = np.random.default_rng(0), np.linspace(0.0, 1.0, 11)
    arms = [Specimen(Cone(0.0125, 0.003), 0.12 + 0.002 * k, 1070.0) for k in range(ARMS)]
    shapes = []
    for specimen in arms:
        values = {"elasticity": {"E": 2e5}, "damping": {"eta": 1.5e3}, "drag": {"C_perp": 1.1}}
        exact = {effect: {n: Estimate.exact(v) for n, v in held.items()} for effect, held in values.items()}
        run = simulate_model(
            Model(specimen, WATER, parameters=exact), Sine(0.4, 1.0), SECONDS, timing=Timing(1 / 300, 10)
        )
        shapes.append((run.t, run.theta[:, 0], midline(run.q[:, :, 0], run.theta[:, 0], specimen.length, s)))
    for k in range(count):
        t, theta, xy = shapes[k % ARMS]
        seen = xy + 1e-4 * random.standard_normal(xy.shape)
        date = datetime(2026, 1, 5, tzinfo=UTC) + timedelta(hours=3.6 * k)
        recording = Recording(
            f"run {k:04d}", Declaration(arms[k % ARMS], WATER), motor=MotorSignal(t, theta, theta),
            midline=Midline(t, s, seen, np.full(seen.shape[:2], 1e-4)), notes={"date": date.isoformat()},
        )  # fmt: skip
        write_rrd(recording, folder / f"run_{k:04d}.rrd")


def stand_in_verdicts(folder: Path) -> None:
    """A layer for every recording that has none."""
    library, random = open_library(folder, settings={"seed": 0}), np.random.default_rng(1)
    for k, row in enumerate(library.table().to_pylist()):
        if row["state"] != "new":
            continue
        E, sd = 2e5 * (1.0 - 2e-5 * k), 2e3
        verdict, effects = ("effect", "current") if k % 5 == 0 else ("nothing_missing", "")
        layer = {
            "sha256": row["sha256"], "code": library_code_version(), "verdict": verdict, "effects": effects,
            "confidence": float(random.uniform(0.8, 1.0)), "before_mm": 0.3, "floor_mm": 0.14, "held_out": True,
            "after_mm": float(random.uniform(0.14, 0.2)), "failed": None,
            "residual_mm": random.uniform(0, 0.3, (16, 60)).tolist(),
            "parameters": [
                _parameter("elasticity", "E", E + sd * random.standard_normal(), sd, "Pa"),
                _parameter("damping", "eta", 1.5e3 + 40.0 * random.standard_normal(), 40.0, "Pa s"),
                _parameter("drag", "C_perp", 1.1 + 0.02 * random.standard_normal(), 0.02, "1"),
            ],
        }  # fmt: skip
        write_layer(layer, library.layer(row["sha256"]))


def _parameter(effect: str, name: str, value: float, sd: float, unit: str) -> dict[str, object]:
    return {
        "effect": effect,
        "parameter": name,
        "value": value,
        "low": value - 2 * sd,
        "high": value + 2 * sd,
        "unit": unit,
    }


def asked(folder: Path) -> dict[str, float]:
    """What a user does, in this process: refresh, query, page, and its memory."""
    from tentacle.cli.pages.library import write_library_page

    library = open_library(folder)
    found: dict[str, float] = {}
    start = time.perf_counter()
    read = library.refresh()
    found["library_refresh_s"], found["library_read_again"] = time.perf_counter() - start, float(read)
    start = time.perf_counter()
    table = library.table()
    chosen = table.filter(conditions(QUERY, table.schema)).sort_by([("after_mm", "descending")])
    found["library_query_s"], found["library_found"] = time.perf_counter() - start, float(chosen.num_rows)
    found["library_to_diagnose"] = float(sum(state == "new" for state in table.column("state").to_pylist()))
    start = time.perf_counter()
    page = write_library_page(library)
    found["library_page_s"], found["library_page_mb"] = time.perf_counter() - start, page.stat().st_size / 1e6
    found["library_memory_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    return found


def in_own_process(folder: Path) -> dict[str, float]:
    """asked(folder), where nothing else was loaded before."""
    command = [sys.executable, __file__, "--asked", str(folder)]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[-1])


def figures(folder: Path, count: int) -> dict[str, float]:
    """All figures of a library of that many recordings."""
    recordings = folder / "recordings"
    recordings.mkdir()
    make(recordings, count)
    found = {"library_first_index_s": in_own_process(recordings)["library_refresh_s"]}
    open_library(recordings, settings={"seed": 0}).refresh()
    stand_in_verdicts(recordings)
    found |= in_own_process(recordings)
    for k in range(CHANGED):
        file = recordings / f"run_{k:04d}.rrd"
        write_rrd(replace(read_rrd(file), name=f"run {k:04d} again"), file)
    after = in_own_process(recordings)
    return found | {
        "library_changed_read_again": after["library_read_again"],
        "library_changed_to_diagnose": after["library_to_diagnose"],
    }


def main() -> None:
    """Print the figures; --json writes them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--count", type=int, default=RECORDINGS, metavar="N", help="recordings, default: 2000")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="an empty folder to work in, which is left there")
    parser.add_argument("--asked", type=Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.asked is not None:
        print(json.dumps(asked(arguments.asked)))
        return
    with tempfile.TemporaryDirectory() as folder:
        found = figures(arguments.keep or Path(folder), arguments.count)
    tell(found, arguments.json)


if __name__ == "__main__":
    main()

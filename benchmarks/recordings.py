"""Recordings in and out: seconds and megabytes for a run of 39 s, and how well its base motion is known.

python benchmarks/recordings.py --json FILE [--short]
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tentacle.base_motion import fit_samples
from tentacle.io.import_folder import read_folder
from tentacle.io.recording_rrd import read_rrd, write_rrd
from tentacle.io.write_folder import write_folder
from tentacle.recording import Declaration, Recording
from tentacle.signals import LoadCellSignal, Midline, MotorSignal
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Multisine

MOTION = Multisine((0.5, 0.2, 0.1), (0.6, 1.3, 2.2), (0.0, 1.0, 2.0))
NOISE = 1e-3  # rad, a servo's potentiometer
REPEATS = 3


def a_run(seconds: float) -> Recording:
    """The paper's run: 60 fps, 41 points, motor at 100 Hz, load cell at 80 Hz; numbers with all their digits."""
    rng = np.random.default_rng(0)
    frames, motor, load_cell = (np.arange(0.0, seconds, 1.0 / rate) for rate in (60.0, 100.0, 80.0))
    angle = MOTION(motor)[0]
    xy = rng.normal(0.0, 0.03, (len(frames), 41, 2))
    return Recording(
        "run",
        Declaration(Specimen(Cone(0.0125, 0.001), 0.14, 1070.0), WATER),
        MotorSignal(motor, angle, angle + rng.normal(0.0, NOISE, len(motor))),
        LoadCellSignal(load_cell, rng.normal(0.0, 0.01, len(load_cell))),
        Midline(frames, np.linspace(0.0, 1.0, 41), xy, rng.uniform(1e-5, 1e-4, xy.shape[:2])),
    )


def best_of(work: Callable[[], object]) -> float:
    """The shortest of a few runs [s]."""
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return min(seconds)


def files(seconds: float) -> dict[str, float]:
    """Seconds to write and read a folder and an .rrd, and the latter's size."""
    run = a_run(seconds)
    with tempfile.TemporaryDirectory() as name:
        folder, rrd = Path(name) / "run", Path(name) / "run.rrd"
        write_folder(run, folder)
        write_rrd(run, rrd)
        return {
            "folder_read_s": best_of(lambda: read_folder(folder)),
            "rrd_write_s": best_of(lambda: write_rrd(run, rrd)),
            "rrd_read_s": best_of(lambda: read_rrd(rrd)),
            "rrd_mb": rrd.stat().st_size / 1e6,
        }


def base_motion(rates: tuple[int, ...]) -> dict[str, float]:
    """The acceleration's rms error over its rms, from noisy samples of 20 s at several rates; seconds at the last."""
    figures = {}
    for rate in rates:
        t = np.arange(0.0, 20.0, 1.0 / rate)
        angle = MOTION(t)[0] + np.random.default_rng(1).normal(0.0, NOISE, len(t))
        start = time.perf_counter()
        motion = fit_samples(t, angle)
        figures[f"base_fit_s_{rate}_hz"] = time.perf_counter() - start
        judged = np.linspace(0.5, 19.5, 5000)
        true = MOTION(judged)[2]
        error = np.sqrt(np.mean((motion(judged)[2] - true) ** 2) / np.mean(true**2))
        figures[f"base_acceleration_error_{rate}_hz"] = float(error)
    return figures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True, metavar="FILE")
    parser.add_argument("--short", action="store_true", help="5 s of recording, one rate")
    arguments = parser.parse_args()
    figures = files(5.0 if arguments.short else 39.0)
    figures |= base_motion((50,) if arguments.short else (50, 200, 1000))
    for name, value in figures.items():
        print(f"{name:36s} {value:.4g}")
    arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

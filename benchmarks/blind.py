"""Blind trials at scale: how often the loop names what was hidden, how sure it rightly is, what is left, how long it
takes.

python benchmarks/blind.py --json FILE [--short] [--trials N] [--workers W] [--results DIR] [--seed S]
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from discovery.diagnose import diagnose
from tentacle.runner import Runner
from validation.trials.design import KINDS
from validation.trials.figures import figures
from validation.trials.recording import trial_recording
from validation.trials.series import run_series, series

FULL, SHORT = 400, 8
TARGETS = {
    "top1": ">= .95", "false_alarm": "<= .02", "unknown_recall": ">= .95", "pairs": ">= .8",
    "calibration_gap": "<= .05", "after_over_floor": "<= 1.2", "diagnose_s": "<= 30",
}  # fmt: skip


def diagnose_seconds(seed: int) -> float:
    """Wall time of one 39 s recording with its midline, the whole catalogue searched; kernels compiled before."""
    design = series(1, seed, ("single",), 0.0)[0]
    short, _ = trial_recording(replace(design, duration=12.0))
    diagnose([short], seed=seed)
    recording, _ = trial_recording(replace(design, duration=39.0))
    begin = time.perf_counter()
    diagnose([recording], seed=seed)
    return time.perf_counter() - begin


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--short", action="store_true", help=f"{SHORT} trials without video instead of {FULL}")
    parser.add_argument("--trials", type=int, help="how many instead")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--results", type=Path, help="folder of results, so that a stopped run goes on")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    count = arguments.trials or (SHORT if arguments.short else FULL)
    found = series(count, arguments.seed, KINDS, 0.0 if arguments.short else 0.25)
    with TemporaryDirectory() as fresh:
        runner = Runner(arguments.results or Path(fresh), workers=arguments.workers)
        outcomes, refused = run_series(found, runner)
    values = {name: value for name, value in figures(outcomes).items() if value is not None}
    values["refused"] = float(len(refused))
    values["diagnose_s"] = diagnose_seconds(arguments.seed)
    for name, value in values.items():
        print(f"{name:32s} {value:9.3f}  {TARGETS.get(name, '')}")
    arguments.json.write_text(json.dumps({"figures": values}, indent=1) + "\n")


if __name__ == "__main__":
    main()

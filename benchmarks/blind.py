"""Blind trials at scale: how often the loop names what was hidden, how sure it rightly is, what is left, how long it
takes.

python benchmarks/blind.py --json FILE [--short] [--trials N] [--plant NAME ...] [--workers W] [--results DIR]
                           [--seed S]
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

# benchmarks/vision.py must not stand for the room of that name.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tentacle.runner import Runner
from validation.trials.figures import figures
from validation.trials.plant_design import DRAWN_PLANTS, plant_designs
from validation.trials.series import run_series

FULL, SHORT = 400, 8
TARGETS = {
    "top1": ">= .95", "false_alarm": "<= .02", "unknown_recall": ">= .95", "pairs": ">= .85",
    "calibration_gap_60": "<= .05", "after_over_floor": "<= 1.2", "diagnose_s": "<= 30",
}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--short", action="store_true", help=f"{SHORT} trials without video instead of {FULL}")
    parser.add_argument("--trials", type=int, help="how many instead")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--results", type=Path, help="folder of results, so that a stopped run goes on")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--plant", nargs="+", default=DRAWN_PLANTS, help=f"drawn from for each trial (default {' '.join(DRAWN_PLANTS)})"
    )
    arguments = parser.parse_args()
    count = arguments.trials or (SHORT if arguments.short else FULL)
    share = 0.0 if arguments.short else 0.25
    found = plant_designs(count, arguments.seed, plants=arguments.plant, video_share=share)
    with TemporaryDirectory() as fresh:
        runner = Runner(arguments.results or Path(fresh), workers=arguments.workers)
        outcomes, refused = run_series(found, runner)
    values = {name: value for name, value in figures(outcomes).items() if value is not None}
    values["refused"] = float(len(refused))
    values["diagnose_s"] = float(np.median([o.seconds for o in outcomes]))
    values["diagnose_s_worst"] = max(o.seconds for o in outcomes)
    for name, value in values.items():
        print(f"{name:32s} {value:9.3f}  {TARGETS.get(name, '')}")
    arguments.json.write_text(json.dumps({"figures": values}, indent=1) + "\n")


if __name__ == "__main__":
    main()

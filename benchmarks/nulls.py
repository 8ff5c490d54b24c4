"""The declared model fitted to recordings of each plant in which nothing is hidden: rms error against the stated floor.

python benchmarks/nulls.py --json FILE [--plants NAME ...] [--runs 10] [--seconds 8]

The error is that of the midline after the fit; the floor is the recording's noise. A ratio of 1: the plant's arm moves
as the fitted model does, to less than the noise shows.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

import tentacle
from tentacle.errors import InputError
from validation.plants import PLANTS, make
from validation.plants.draw import Filming

WITHIN = 1.1  # times the floor


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True, metavar="FILE")
    parser.add_argument("--plants", nargs="+", choices=tuple(PLANTS), default=tuple(PLANTS), metavar="NAME")
    parser.add_argument("--runs", type=int, default=10, help="seeds from 0 on, of each plant (default 10)")
    parser.add_argument("--seconds", type=float, default=8.0, help="of film (default 8)")
    arguments = parser.parse_args()
    figures: dict[str, float] = {}
    ratios: dict[str, list[float]] = {}
    for plant in arguments.plants:
        ratios[plant] = []
        for seed in range(arguments.runs):
            try:
                recording, truth = make(plant, seed, effects=(), filming=Filming(arguments.seconds))
            except InputError as problem:
                print(f"{plant}: left out, {problem}")
                break
            fitted = tentacle.identify(recording)
            error = fitted.errors.midline_mm or np.nan
            floor = truth["noise_mm"] * np.sqrt(2.0)
            ratios[plant].append(error / floor)
            print(f"{plant:9s} {seed:3d}  {error:.3f} mm, floor {floor:.3f} mm: {error / floor:.3f}", flush=True)
        if ratios[plant]:
            figures[f"{plant}_within_floor"] = float(np.mean(np.array(ratios[plant]) < WITHIN))
            figures[f"{plant}_worst_over_floor"] = max(ratios[plant])
    arguments.json.write_text(json.dumps({"figures": figures, "ratios": ratios}, indent=1) + "\n")


if __name__ == "__main__":
    main()

"""The loop on recordings of a simulator that shares nothing with it (_discrete_rod.py), one effect hidden at a time.

python benchmarks/stranger.py --json FILE [--short] [--only CASE ...]: every case's verdict, its errors before and
after, and how many are right: the truth named first, or in the named group.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import lfilter

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from affine_model.base_signal import play_operator
from benchmarks._discrete_rod import PIECES, STEP, Rod, move
from discovery.diagnose import diagnose
from tentacle.diagnosis import Diagnosis
from tentacle.recording import Declaration, Recording
from tentacle.signals import Array, Midline, MotorSignal
from tentacle.specimen import Cone, Fluid, Specimen

FPS, SECONDS, SIGMA = 50.0, 20.0, 1.5e-4  # 1/s, s, m of a midline point's coordinate
SETTLED = 2.0  # s before the first frame: the motor's log begins earlier than the camera
SHORT = ("nothing", "current", "servo_lag")
CASES: dict[str, dict[str, float]] = {  # effect of the catalogue -> what the rod, or what is seen of it, does
    "nothing": {},
    "current": {"current": 0.05},
    "sloshing": {"sloshing": 0.04},
    "added_mass": {"carried": 1.0},
    "linear_drag": {"linear_drag": 0.15},
    "buoyancy": {"heavier": 0.05},
    "tip_mass": {"tip_mass": 0.004},
    "gravity_tilt": {"tilt": 0.1},
    "cubic_stiffness": {"cubic": 0.5},
    "intrinsic_curvature": {"bent": 0.15},
    "viscoelasticity": {"branch": 8e4},
    "dry_friction": {"friction": 0.3},
    "stiffness_drift": {"drift": 0.005},
    "servo_lag": {"lag": 0.06},
    "backlash": {"play": 0.06},
    "time_offset": {"offset": 0.02},
    "camera_roll": {"roll": 0.04},
    "camera_scale": {"scale": 1.03},
}


def recording(hidden: dict[str, float], seconds: float = SECONDS, seed: int = 0) -> Recording:
    """A chirp from 0.3 to 2 Hz, filmed; `hidden` overrides the rod, or bends base and camera (lag [s], play [rad],
    offset [s], roll [rad], scale).
    """
    seen = {"lag": 0.0, "play": 0.0, "offset": 0.0, "roll": 0.0, "scale": 1.0}
    rod = replace(Rod(), **{name: value for name, value in hidden.items() if name not in seen})
    seen |= {name: value for name, value in hidden.items() if name in seen}
    every = round(1.0 / (FPS * STEP))
    step = 1.0 / (FPS * every)
    t = step * np.arange(round(seconds / step) + 1)
    ramp = np.clip(t, 0.0, 1.0)
    command = 0.35 * np.sin(2 * np.pi * (0.3 * t + 0.85 * t**2 / seconds)) * ramp**2 * (3.0 - 2.0 * ramp)
    theta = command if seen["play"] == 0.0 else play_operator(command, seen["play"])
    if seen["lag"] > 0.0:
        share = step / seen["lag"]
        theta = np.asarray(lfilter([share], [1.0, share - 1.0], theta))
    places = move(rod, theta, step, every)
    s = np.linspace(0.0, 1.0, 31)
    xy = CubicSpline(np.linspace(0.0, 1.0, PIECES + 1), places, axis=1)(s)
    xy = seen["scale"] * _rolled(xy, seen["roll"])
    xy = xy + SIGMA * np.random.default_rng(seed).standard_normal(xy.shape)
    frames = np.arange(len(places)) / FPS
    kept = frames > SETTLED
    midline = Midline(frames[kept] + seen["offset"], s, xy[kept], np.full(xy[kept].shape[:2], SIGMA))
    specimen = Specimen(Cone(rod.base_radius, rod.tip_radius), rod.length, rod.density)
    logged = command[::every][: frames.size]
    return Recording("stranger", Declaration(specimen, Fluid(rod.water)), MotorSignal(frames, logged, logged),
                     midline=midline)  # fmt: skip


def _rolled(xy: Array, roll: float) -> Array:
    cos, sin = np.cos(roll), np.sin(roll)
    return np.stack([cos * xy[..., 0] - sin * xy[..., 1], sin * xy[..., 0] + cos * xy[..., 1]], axis=-1)


def right(case: str, found: Diagnosis) -> bool:
    """Whether the truth is named first, or in the named group; of nothing hidden: whether nothing is named."""
    named = [name for name in found.effects if name != "third_curvature"]
    if case == "nothing":
        return not named and found.verdict != "unknown"
    return bool(named) and (named[0] == case or (found.verdict == "group" and case in named))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True, metavar="FILE")
    parser.add_argument("--short", action="store_true", help=f"{', '.join(SHORT)}, of 12 s each")
    parser.add_argument("--only", nargs="+", choices=tuple(CASES), metavar="CASE", help="these alone")
    arguments = parser.parse_args()
    cases = arguments.only or (SHORT if arguments.short else tuple(CASES))
    answers: dict[str, Any] = {}
    for case in cases:
        found = diagnose([recording(CASES[case], 12.0 if arguments.short else SECONDS)])
        answers[case] = right(case, found)
        values = {f"{effect}.{name}": round(estimate.value, 5)
                  for effect, table in found.parameters.items() for name, estimate in table.items()}  # fmt: skip
        print(f"{'ok ' if answers[case] else 'NOT'} {case:20s} {found.verdict:16s} {' + '.join(found.effects):50s} "
              f"{found.before.midline_mm:.3f} to {found.after.midline_mm:.3f} mm (floor {found.floor.midline_mm:.3f}) "
              f"{values}", flush=True)  # fmt: skip
    figures = {"right": sum(answers.values()) / len(answers), "cases": len(answers)}
    print(f"right: {sum(answers.values())} of {len(answers)}")
    arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")


if __name__ == "__main__":
    main()

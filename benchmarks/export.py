"""How well an exported arm shows the recordings that its model was diagnosed from: MuJoCo's error over ours.

Five recordings of the reference, each with another effect that its declaration leaves out, are diagnosed; the model
that the diagnosis wrote is exported and run under the recording's base motion. Asked: at most 1.1.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

# benchmarks/vision.py must not stand for the room of that name.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks._figures import tell
from discovery.diagnose import diagnose
from mujoco_ref.export.mjcf import export_mjcf
from mujoco_ref.undeclared import Noise, Scenario, make_recording
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Chirp
from validation.export.in_mujoco import export_error

HIDDEN = ({}, {"added_mass": "visible"}, {"current": "visible"}, {"tip_mass": "visible"}, {"linear_drag": "visible"})
SECONDS, FPS = 12.0, 60.0


def arm() -> Model:
    values = {"elasticity": {"E": 2e5}, "damping": {"eta": 300.0}, "drag": {"C_perp": 1.1}}
    exact = {effect: {name: Estimate.exact(v) for name, v in held.items()} for effect, held in values.items()}
    return Model(Specimen(Cone(0.0125, 0.0015), 0.14, 1070.0), WATER, order=2, parameters=exact)


def figures() -> dict[str, float]:
    model, wave = arm(), Chirp(0.5, 0.3, 2.2, SECONDS)
    ratios, alone = [], []
    for seed, hidden in enumerate(HIDDEN):
        name = "+".join(hidden) or "nothing"
        recording, _ = make_recording(
            hidden, Scenario(model, wave, SECONDS, FPS), seed, Noise(midline=1.5e-4), name=name
        )
        found = diagnose([recording], [], [], seed=seed)
        answer = found.augmented_model
        made = export_mjcf(answer)
        error = export_error(made.xml, answer, recording)
        print(
            f"{found.verdict} {'+'.join(found.effects)}; {error.sentence()}; left: {sorted(made.carried.left)}",
            flush=True,
        )
        ratios.append(error.with_forces_mm / error.ours_mm)
        alone.append(error.alone_mm / error.ours_mm)
    return {"export_ratio_worst": max(ratios), "export_alone_ratio_worst": max(alone)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    found = figures()
    tell(found, arguments.json)


if __name__ == "__main__":
    main()

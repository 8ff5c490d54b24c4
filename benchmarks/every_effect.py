"""A model file of every effect of the catalogue, at its nominal strength, through the verbs that take a model file.

python benchmarks/every_effect.py --json FILE [--only EFFECT ...] [--links-too]

Each is written as model.toml and read back, simulated in the reference, held beside the reduced model, and a gait is
checked on the reference, clamped and on a rail, as `optimise` does. --links-too: all rungs of `compare` (minutes each).
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

import tentacle
from affine_model.effects import catalogue
from tentacle.errors import InputError
from tentacle.gait import Gait
from tentacle.io.model_file import read_model, write_model
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Ramped, Sine
from validation.model_pair import affine_twin, reference_twin, shape_error
from validation.reference_swim import reference_speed, reference_thrust

BASE = {"elasticity": {"E": 2e5}, "damping": {"eta": 1.5e3}, "drag": {"C_perp": 1.1}}
WAVE = Ramped(Sine(0.35, 1.2), 0.8)
ORDER, SECONDS = 4, 3.0
GAIT = Gait((0.4, 0.0, 0.0, 8.0, 8.0, 8.0, 0.0, 0.0, 0.0))


def model_with(name: str) -> Model:
    """A silicone cone in water with the base effects and this one."""
    tables = {**BASE, **({} if name in BASE else {name: {p.name: p.nominal for p in catalogue()[name].parameters}})}
    exact = {key: {p: Estimate.exact(v) for p, v in table.items()} for key, table in tables.items()}
    return Model(Specimen(Cone(0.0125, 0.004), 0.14, 1070.0), WATER, Gravity(), ORDER, exact)


def twins_apart(model: Model) -> float:
    """Rms distance of the two models' midlines [mm] in the second half of a driven motion."""
    pair = affine_twin(model, ORDER, WAVE, SECONDS, 50.0), reference_twin(model, WAVE, SECONDS, 50.0, links=40)
    return shape_error(*pair, 0.5 * SECONDS)[0]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True, metavar="FILE")
    parser.add_argument("--only", nargs="+", choices=tuple(catalogue()), metavar="EFFECT", help="these alone")
    parser.add_argument("--links-too", action="store_true", help="all rungs of compare, too")
    arguments = parser.parse_args()
    steps: dict[str, Callable[[Model], object]] = {
        "simulate": lambda m: tentacle.simulate(m, WAVE, duration=SECONDS, fps=50.0),
        "twins": twins_apart,
        "thrust": lambda m: reference_thrust(m, GAIT),
        "speed": lambda m: reference_speed(m, GAIT),
    }
    if arguments.links_too:
        steps["compare"] = tentacle.compare
    rows: dict[str, dict[str, object]] = {}
    for name in arguments.only or catalogue():
        with tempfile.TemporaryDirectory() as folder:
            write_model(model_with(name), Path(folder) / "model.toml")
            model = read_model(Path(folder) / "model.toml")
        row: dict[str, object] = {}
        for verb, act in steps.items():
            try:
                done = act(model)
                row[verb] = float(done) if isinstance(done, float | np.floating) else "ran"
            except (InputError, FloatingPointError, NotImplementedError, ValueError) as problem:
                row[verb] = f"failed: {problem}"
        rows[name] = row
        print(name, row, flush=True)
    failed = sum(str(value).startswith("failed") for row in rows.values() for value in row.values())
    arguments.json.write_text(json.dumps({"figures": {"effects": len(rows), "failed": failed}, "rows": rows}, indent=1))


if __name__ == "__main__":
    main()

"""SoRoMoX and PyElastica in benchmarks/precision.py: the scripts that `tentacle export` writes, each in the interpreter
that has its program.

The child is timed from inside, in processor seconds; what it compiles before is not counted. Neither gives a thrust:
the midline alone is judged. PyElastica's rod shears and stretches (here as much as its material does), which the truth
does not: its error has a floor that no setting lowers.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks._precision_programs import FRAMES, Case, Run, S
from mujoco_ref.export.script import export_script
from tentacle.model import Estimate, Model
from tentacle.specimen import Fluid, Gravity

PATIENCE = 900.0  # s for one setting
SAMPLES = 1e-3  # s, of the base's motion
# Each child prints {"seconds": of processor for the whole motion, "points": ...} as its last line.
SOROMOX = """
import json, sys, time
sys.path.insert(0, ".")
import arm_soromox as script
arm, motion = (json.load(open(name)) for name in ("arm.json", "motion.json"))
solve, first, show = script.solver(arm, motion, int(sys.argv[1]), float(sys.argv[2]))
solve(first).block_until_ready()
begin = time.process_time()
found = solve(first).block_until_ready()
spent = time.process_time() - begin
print(json.dumps({"seconds": spent, "points": show(found).tolist()}))
"""
PYELASTICA = """
import json, sys, time
sys.path.insert(0, ".")
import arm_pyelastica as script
script.STIFFER, script.SAFETY = 1.0, script.SAFETY * float(sys.argv[2])
arm, motion = (json.load(open(name)) for name in ("arm.json", "motion.json"))
script.simulate(arm, dict(motion, times=motion["times"][:1]), int(sys.argv[1]))
begin = time.process_time()
found = script.simulate(arm, motion, int(sys.argv[1]))
print(json.dumps({"seconds": time.process_time() - begin, "points": found.tolist()}))
"""
CHILDREN = {"soromox": SOROMOX, "pyelastica": PYELASTICA}
# SoRoMoX: curvatures, tolerance. PyElastica: elements, steps over the script's own (a quarter of the stable one).
SETTINGS: dict[str, tuple[tuple[float, ...], ...]] = {
    "soromox": tuple((order, tolerance) for order in (2, 3, 4, 5) for tolerance in (1e-2, 1e-4)),
    "pyelastica": tuple((elements, 3.0) for elements in (4, 8, 16, 32, 64)),
}


def model_of(case: Case) -> Model:
    """The case's arm as a model."""
    named = {"elasticity": {"E": case.material.modulus}, "damping": {"eta": case.material.viscosity}}
    named["drag"] = {"C_perp": case.material.drag}
    values = {effect: {k: Estimate.exact(v) for k, v in own.items()} for effect, own in named.items()}
    return Model(case.material.specimen, Fluid(case.density), Gravity(0.0, 0.0), 2, values)


def motion_of(case: Case) -> dict[str, Any]:
    """The case's motion from rest, with its frames after half of the time, as motion.json."""
    t = np.arange(-SAMPLES, case.motion.seconds + 3.0 * SAMPLES, SAMPLES)
    frames = np.arange(case.motion.periods // 2 * FRAMES, case.motion.periods * FRAMES + 1)
    return {
        "start": 0.0,
        "base": dict(
            zip(("t", "theta", "rate", "acceleration"), [t.tolist(), *case.motion(t).tolist()], strict=True)
        ),
        "q": [0.0, 0.0], "q_rate": [0.0, 0.0],
        "times": (frames / (case.motion.frequency * FRAMES)).tolist(),
        "s": S.tolist(), "d": [0.0] * len(S), "points": None,
    }  # fmt: skip


def rod(case: Case, *setting: float, to: str, python: str) -> Run:
    """One setting of a program, run by an interpreter, on a case.

    FloatingPointError where it runs away or is not done in time.
    """
    quiet = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | {
        "OMP_NUM_THREADS": "1", "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false", "JAX_PLATFORMS": "cpu",
    }  # fmt: skip
    pinned = ["taskset", "-c", str(min(os.sched_getaffinity(0)))] if sys.platform == "linux" else []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        export_script(model_of(case), to).write(folder)
        (folder / "motion.json").write_text(json.dumps(motion_of(case)), encoding="utf-8")
        command = [*pinned, python, "-c", CHILDREN[to], *map(str, setting)]
        try:
            ran = subprocess.run(
                command, cwd=folder, env=quiet, capture_output=True, text=True, timeout=PATIENCE, check=False
            )
        except subprocess.TimeoutExpired as late:
            raise FloatingPointError("not done in time") from late
    if ran.returncode != 0:
        last = (ran.stderr.strip() or "failed").splitlines()[-1]
        if "ran away" in last or "max_steps" in last or "nan" in last.lower():
            raise FloatingPointError(last)
        raise RuntimeError(f"{to}: {last}")
    found = json.loads(ran.stdout.strip().splitlines()[-1])
    return Run(np.array(found["points"]), np.nan, found["seconds"] / case.motion.seconds)

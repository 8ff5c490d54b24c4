"""Figures of the reference: speed, added mass, order of convergence, momentum, sweeps, and PyElastica's opinion.

    python benchmarks/reference.py --json FILE [--short]

pyelastica_f1_gap is measured where PyElastica is installed (pip install pyelastica), and left out elsewhere.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from mujoco_ref.chain_state import ChainState
from mujoco_ref.engine import mujoco
from mujoco_ref.modes import natural_frequencies
from mujoco_ref.simulate import Setup, make_stepper, simulate
from mujoco_ref.third_opinion import first_frequency, is_installed
from tentacle.model import Estimate, Model
from tentacle.runner import Runner
from tentacle.specimen import AIR, WATER, Cone, Fluid, Gravity, Specimen
from tentacle.waveform import Chirp, Sine

CONE = Specimen(Cone(0.0125, 0.001), 0.14, 1070.0)
WEIGHTLESS = Gravity(0.0, 0.0)


def model_of(specimen: Specimen, fluid: Fluid, gravity: Gravity, **effects: Mapping[str, float]) -> Model:
    exact = {effect: {name: Estimate.exact(v) for name, v in values.items()} for effect, values in effects.items()}
    return Model(specimen, fluid, gravity, 2, exact)


def swimmer() -> Model:
    """20 links, drag, skin drag, added mass: what `sim_s_per_core_s` is about."""
    effects = {"elasticity": {"E": 2e5}, "damping": {"eta": 300.0}, "drag": {"C_perp": 1.1}}
    return model_of(CONE, WATER, Gravity(), **effects, added_mass={"C_a": 1.0}, skin_drag={"C_t": 0.05})


def speed(short: bool) -> dict[str, float]:
    """Simulated seconds a second of one core (its own time, whatever else runs), at 60 frames/s, and what the step
    costs in accuracy."""
    model, duration = swimmer(), 5.0 if short else 40.0
    wave = Chirp(0.5, 0.3, 2.2, duration)
    run = simulate(model, wave, 0.1, 60.0)  # compiles
    best = np.inf
    for _ in range(2 if short else 5):
        begin = time.process_time()
        run = simulate(model, wave, duration, 60.0)
        best = min(best, time.process_time() - begin)
    fine = simulate(model, wave, duration, 60.0, setup=Setup(longest_step=5e-4))
    error = np.sqrt(np.mean(np.sum((run.midline.xy - fine.midline.xy) ** 2, axis=2)))
    return {"sim_s_per_core_s": duration / best, "step_error_mm": 1e3 * float(error)}


def added_mass_ratio() -> dict[str, float]:
    """First frequency in water over that in air, C_a = 1, 40 links: .719 without rotary inertia."""
    bare = model_of(CONE, AIR, WEIGHTLESS, elasticity={"E": 2e5})
    wet = replace(bare, fluid=Fluid(1000.0)).with_effect("added_mass", C_a=Estimate.exact(1.0))
    found = [natural_frequencies(make_stepper(model, links=40), count=1)[0] for model in (wet, bare)]
    return {"added_mass_ratio": float(found[0] / found[1])}


def order_in_links() -> dict[str, float]:
    """Smallest observed order of convergence in n = 10, 20, 40, 80 over frequencies, elastica and a swim."""
    bare = model_of(CONE, AIR, WEIGHTLESS, elasticity={"E": 2e5})
    frequencies = np.array([natural_frequencies(make_stepper(bare, links=n)) for n in (10, 20, 40)])
    orders = list(np.log2((frequencies[1] - frequencies[0]) / (frequencies[2] - frequencies[1])))
    wave = Sine(0.5, 1.0)
    runs = [simulate(swimmer(), wave, 1.5, 50.0, setup=Setup(links=n, lead_in=0.5)) for n in (10, 20, 40, 80)]
    steps = [np.sqrt(np.mean((a.midline.xy - b.midline.xy) ** 2)) for a, b in pairwise(runs)]
    swim = float(np.log2(steps[-2] / steps[-1]))
    return {"order_links": float(min([*orders, swim])), "order_links_swim": swim}


def momentum() -> dict[str, float]:
    """Largest force that is missing in the balance of MuJoCo's own momentum [N], servo, drag and weight acting."""
    model = replace(swimmer(), parameters={k: v for k, v in swimmer().parameters.items() if k != "added_mass"})
    stepper, wave, step = make_stepper(model), Sine(0.5, 1.3), 1e-3
    compiled, data = stepper.chain.model, mujoco.MjData(stepper.chain.model)
    state, total = ChainState.at_rest(stepper.chain.links), float(stepper.chain.model.body_mass.sum())
    carried = (
        total - compiled.body_mass[1] - model.fluid.density * stepper.body.links[:, 1].sum()
    ) * compiled.opt.gravity[:2]
    momenta, forces = [], []
    for i in range(800):
        data.qpos[:], data.qvel[:] = state.q, state.v
        mujoco.mj_kinematics(compiled, data)
        mujoco.mj_comPos(compiled, data)
        mujoco.mj_comVel(compiled, data)
        mujoco.mj_subtreeVel(compiled, data)
        momenta.append(total * data.subtree_linvel[0, :2].copy())
        stepper.step(state, wave((i + np.array([0.0, 0.5, 1.0])) * step).T, step, 4 if i == 0 else 1)
        forces.append(stepper.reading[:2] + stepper.reading[2:4] + carried)
    missing = np.diff(momenta, axis=0) / step - np.array(forces)[:-1]
    return {"momentum_n": float(np.abs(missing[100:]).max())}


def short_run(task: Mapping[str, Any]) -> dict[str, Any]:
    """One run of a sweep: mean thrust over a sine."""
    model, wave = swimmer(), Sine(task["amplitude"], task["frequency"])
    run = simulate(model, wave, task["duration"], 30.0)
    return {"thrust": float(np.mean(run.thrust))}


def sweep(short: bool) -> dict[str, float]:
    """Share of the ideal that two workers reach, starting them included.

    Ideal: half the processor time of the same tasks one after another in this process, warm. On a busy machine the
    wall clock tells of the others, so sweep_cpu_share says what of all the processor time that the sweep took, starting
    and storing included, was the tasks' own: an upper bound of the efficiency that others cannot disturb.
    """
    count, duration = (60, 10.0) if short else (1000, 10.0)
    random = np.random.default_rng(0)
    draws = random.uniform((0.1, 0.3), (0.8, 2.0), (count, 2))
    tasks = [{"amplitude": float(a), "frequency": float(f), "duration": duration} for a, f in draws]
    short_run(tasks[0])
    begin = time.process_time()
    alone = [short_run(task) for task in tasks]
    ideal = time.process_time() - begin
    with tempfile.TemporaryDirectory() as folder:
        begin, used = time.perf_counter(), _processor_time()
        results = Runner(Path(folder), workers=2, quiet=True).run(short_run, tasks)
        wall, spent = time.perf_counter() - begin, _processor_time() - used
    if [result["thrust"] for result in results] != [result["thrust"] for result in alone]:
        raise SystemExit("a worker's result differs from this process's")
    return {
        "sweep_efficiency": 0.5 * ideal / wall,
        "sweep_cpu_share": ideal / spent,
        "sweep_runs": float(count),
        "sweep_wall_s": wall,
        "sweep_ideal_s": 0.5 * ideal,
    }


def _processor_time() -> float:
    """Of this process and its finished children [s]."""
    used = os.times()
    return used.user + used.system + used.children_user + used.children_system


def pyelastica_gap() -> dict[str, float]:
    """First frequency of the cone in air: PyElastica's rod, which shears, against the chain, relative."""
    if not is_installed():
        print("pyelastica: not installed, left out")
        return {}
    bare = model_of(CONE, AIR, WEIGHTLESS, elasticity={"E": 2e5})
    ours = float(natural_frequencies(make_stepper(bare, links=40), count=1)[0])
    theirs = first_frequency(CONE, 2e5, ours)
    return {"pyelastica_f1_gap": abs(theirs / ours - 1.0), "pyelastica_f1_hz": theirs, "chain_f1_hz": ours}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--short", action="store_true")
    arguments = parser.parse_args()
    figures: dict[str, float] = {}
    for part in (
        lambda: speed(arguments.short),
        added_mass_ratio,
        order_in_links,
        momentum,
        lambda: sweep(arguments.short),
        pyelastica_gap,
    ):
        found = part()
        for name, value in found.items():
            print(f"{name:20s} {value:.6g}", flush=True)
        figures |= found
    if arguments.json is not None:
        arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

"""The reduced model's speed, errors and identification, beside MuJoCo with 20 links in fluid on the same cores.

python benchmarks/affine.py --json FILE [--short]. Speeds are taken in turns, best of several, so that other
work on the machine touches both sides alike. --short: fewer and shorter runs, for a smoke test; its figures are no
measurement.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from affine_model.simulate import Timing
from affine_model.swim.search import SearchPlan

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from affine_model.arm import Arm, parameter_index  # noqa: E402
from affine_model.simulate import simulate  # noqa: E402
from affine_model.swim.limits import GaitLimits, search_box  # noqa: E402
from affine_model.swim.objectives import weighted  # noqa: E402
from affine_model.swim.search import search  # noqa: E402
from affine_model.swim.trial import GaitTrial  # noqa: E402
from benchmarks._affine_arm import ARM, SPECIMEN, STEP, TRUTH, parameters  # noqa: E402
from benchmarks._identification import identification  # noqa: E402
from benchmarks._other_simulators import OTHERS, environment, run  # noqa: E402
from benchmarks.mujoco_chain import chain_model, roll  # noqa: E402
from tentacle.signals import Array  # noqa: E402
from tentacle.specimen import WATER, Gravity  # noqa: E402

MUJOCO_STEP = 2e-3  # s: 10 ms is stable too; both are printed with their errors
OWN_CORES = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else range(os.cpu_count() or 1)
CORES = len(OWN_CORES)


def motions(count: int, seconds: float, step: float) -> Array:
    """theta and derivatives (3, S, B) at the middles of the steps: two sines each, as a gait has them, seed 0."""
    rng = np.random.default_rng(0)
    amplitude, frequency = rng.uniform(0.2, 0.8, count), rng.uniform(0.4, 2.0, count)
    second, phase = rng.uniform(0.0, 0.15, count), rng.uniform(0.0, 6.28, count)
    t = (np.arange(round(seconds / step)) + 0.5)[:, None] * step
    w = 2.0 * np.pi * frequency
    angle, other = w * t, 2.0 * w * t + phase
    return np.stack(
        [
            amplitude * np.sin(angle) + second * np.sin(other),
            w * (amplitude * np.cos(angle) + 2.0 * second * np.cos(other)),
            -(w**2) * (amplitude * np.sin(angle) + 4.0 * second * np.sin(other)),
        ]
    )


def ours(base: Array, step: float, arm: Arm = ARM, average_from: float = 0.0) -> Array:
    rows = np.repeat(parameters()[:, None], base.shape[2], axis=1)
    return simulate(arm, rows, base, Timing(step, 0, average_from)).mean_thrust


def timed(work, repeats: int) -> float:
    """Best of several wall times [s]."""
    best = np.inf
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return best


def ratios(short: bool, figures: dict[str, float]) -> None:
    """Simulated seconds per second, ours over MuJoCo's; peak arithmetic beside it."""
    seconds, mujoco_count = (1.0, 4) if short else (10.0, 50)
    model = chain_model(SPECIMEN, *TRUTH[:2], WATER.density, MUJOCO_STEP)
    command = motions(mujoco_count, seconds if short else 4.0, MUJOCO_STEP)[0].T
    for count in (50, 4096):
        base = motions(count, seconds, STEP)
        ours(base, STEP)  # compiled, or loaded from the cache
        rounds = 2 if short else 3
        pairs = []
        for _ in range(rounds):  # in turns
            pairs.append((timed(lambda b=base: ours(b, STEP), 2), timed(lambda: roll(model, command, CORES), 1)))
        own, other = (min(pair[k] for pair in pairs) for k in (0, 1))
        speed, reference = count * seconds / own, command.size * MUJOCO_STEP / other
        figures[f"ratio_mujoco_{count}"] = speed / reference
        print(f"batch {count}: ours {speed:.0f}, MuJoCo (2 ms) {reference:.1f} simulated s per s", end="")
        print(f": ratio {speed / reference:.0f}")
        figures[f"simulated_s_per_s_{count}"] = speed
    coarse = chain_model(SPECIMEN, *TRUTH[:2], WATER.density, 1e-2)
    slow = timed(lambda: roll(coarse, motions(mujoco_count, seconds, 1e-2)[0].T, CORES), 2)
    coarse_speed = mujoco_count * seconds / slow
    over_coarse = figures["simulated_s_per_s_4096"] / coarse_speed
    print(f"MuJoCo at 10 ms: {coarse_speed:.1f} simulated s per s: ratio {over_coarse:.0f} for 4096")
    figures["ratio_mujoco_10ms_4096"] = over_coarse
    half = timed(lambda: ours(motions(2048, seconds, STEP), STEP), 2)
    short_run = timed(lambda: ours(motions(4096, 0.5 * seconds, STEP), STEP), 2)
    whole = timed(lambda: ours(motions(4096, seconds, STEP), STEP), 2)
    print(f"time over half the batch {whole / half:.2f}, over half the duration {whole / short_run:.2f} (linear: 2)")
    matrix = np.ones((1500, 1500))
    peak = 2.0 * 1500**3 / timed(lambda: matrix @ matrix, 5)
    done = operations_per_step(ARM.nodes, ARM.order) * figures["simulated_s_per_s_4096"] / STEP
    figures["fraction_of_peak"] = done / peak
    print(f"arithmetic: {done / 1e9:.1f} of {peak / 1e9:.0f} GFLOP/s that a matrix product reaches: {done / peak:.0%}")


def operations_per_step(nodes: int, order: int) -> float:
    """Floating-point operations of one step of one individual, counted in the kernel's text (with added mass)."""
    angles = 4 * 2 * order + 2 * order + 45 + 8
    jacobian = (order + 1) * 4 * nodes
    motion = 4 * nodes + 4 * (order + 1) + 12
    forces = 25 + 12 + 55 + 6 * order
    sums = (order + 1) * 8 + order * (order + 1) // 2 * 11
    return nodes * (angles + jacobian + motion + forces + sums) + 20 * order + order**3


def errors(short: bool, figures: dict[str, float]) -> None:
    """Error of each side against its own converged solution, on the same motions."""
    count, seconds = (8, 4.0) if short else (50, 10.0)
    fine = Arm(SPECIMEN, WATER, Gravity(0.0), order=2, nodes=8)
    truth = ours(motions(count, seconds, 1 / 3000), 1 / 3000, fine, 0.4 * seconds)
    error = np.abs(ours(motions(count, seconds, STEP), STEP, ARM, 0.4 * seconds) / truth - 1.0)
    figures["thrust_error"] = float(np.median(error))
    print(f"mean thrust, median error {np.median(error):.1e}, worst {error.max():.1e} (where thrust is near zero)")
    few, span = 2 if short else 4, 0.5 if short else 2.0
    finest = 1e-4
    model = chain_model(SPECIMEN, *TRUTH[:2], WATER.density, finest)
    exact = roll(model, motions(few, span, finest)[0].T, CORES)
    for step in (MUJOCO_STEP, 1e-2):
        angle = roll(chain_model(SPECIMEN, *TRUTH[:2], WATER.density, step), motions(few, span, step)[0].T, CORES)
        gap = angle - exact[:, round(step / finest) - 1 :: round(step / finest)]
        share = np.sqrt(np.mean(gap**2)) / np.std(exact)
        print(f"MuJoCo at {1e3 * step:g} ms: tip angle, rms error {share:.1e} of its rms")


def bare_arm(order: int = 2) -> Arm:
    """The arm without weight, as the other simulators have it."""
    return Arm(SPECIMEN, WATER, Gravity(0.0, 0.0), order=order, nodes=6 if order == 2 else 10)


def bare_parameters() -> Array:
    vector = parameters()
    vector[parameter_index("added_mass", "C_a")] = 0.0
    return vector


def tip_angles(order: int, amplitude: Array, frequency: Array, seconds: float) -> Array:
    """(B,) [rad] at the end of sines from rest, ours, converged in time."""
    step = 1 / 5000
    t, w = (np.arange(round(seconds / step)) + 0.5)[:, None] * step, 2.0 * np.pi * frequency
    base = np.stack([amplitude * np.sin(w * t), amplitude * w * np.cos(w * t), -amplitude * w**2 * np.sin(w * t)])
    rows = np.repeat(bare_parameters()[:, None], len(amplitude), axis=1)
    found = simulate(bare_arm(order), rows, base, Timing(step, len(t)))
    share = 1.0 / np.arange(1, order + 1)  # alpha(1) = sum q_j / j
    return amplitude * np.sin(w * seconds) + share @ found.q[-1]


def others(short: bool, figures: dict[str, float]) -> None:
    """Speed and error of other simulators on sines; skipped with the reason.

    The error is against each one's own finer solution; beside it stands the gap to ours: of the affine order, and of
    order 5 where the other is a rod. The sines start with a jerk, which throws the thin tip: where it is hard the
    orders 2, 5 and the rod all differ, where it is soft they agree to 1 %. Ratios are of simulated seconds per second,
    batches counted; ours has added mass and weight besides, and its batch of 50.
    """
    seconds = 0.05 if short else 1.0
    rng = np.random.default_rng(0)
    amplitude, frequency = rng.uniform(0.2, 0.8, 50), rng.uniform(0.4, 2.0, 50)
    given = {
        "length": SPECIMEN.length, "r0": 0.0125, "r1": 0.001, "density": SPECIMEN.density, "fluid": WATER.density,
        "E": TRUTH[0], "eta": TRUTH[1], "C_perp": TRUTH[2], "seconds": seconds,
    }  # fmt: skip
    for other in OTHERS:
        own = {**given, "amplitude": amplitude[: other.runs].tolist(), "frequency": frequency[: other.runs].tolist()}
        try:
            with environment(other) as (python, variables):
                found, exact = (
                    run(python, variables, other, {**own, other.accuracy: value}, sorted(OWN_CORES))
                    for value in (other.coarse, other.fine)
                )
        except RuntimeError as reason:
            print(f"{other.package}: skipped ({reason})")
            continue
        scale = np.sqrt(np.mean(exact.tip_angle**2))
        orders = (2, 5) if other.package == "pyelastica" else (2,)
        own_tips = [tip_angles(order, amplitude[: other.runs], frequency[: other.runs], seconds) for order in orders]
        error = np.sqrt(np.mean((exact.tip_angle - found.tip_angle) ** 2))
        ratio = figures["simulated_s_per_s_50"] / found.speed
        figures[f"ratio_{other.package}"] = ratio
        print(f"{other.package} ({other.says}; {other.accuracy} {other.coarse:g}): {found.speed:.3g}", end="")
        print(f" simulated s per s: ratio {ratio:.3g}; tip angle off by {error / scale:.1e} of its rms,", end="")
        gaps = (np.median(np.abs(exact.tip_angle - tips)) / scale for tips in own_tips)
        print(
            " from ours by a median of " + ", ".join(f"{g:.1e} (order {o})" for o, g in zip(orders, gaps, strict=True))
        )


def paper_search(short: bool, figures: dict[str, float]) -> None:
    """The paper's optimisation: 50 gaits, 100 generations, 10 s each."""
    trial = GaitTrial(ARM, parameters()[:, None], settle=4.0, window=6.0, step=STEP)
    generations = 4 if short else 100
    start = time.perf_counter()
    for _ in search(
        trial, weighted(0.0), search_box(GaitLimits()), SearchPlan("ga", evaluations=50 * generations, seed=0)
    ):
        pass
    figures["paper_ga_s"] = (time.perf_counter() - start) * 100 / generations
    print(f"the paper's GA, 50 x 100 evaluations of 10 s: {figures['paper_ga_s']:.2f} s")


def peak_memory(figures: dict[str, float]) -> None:
    """Peak resident memory of a process of its own that runs 4096 x 10 s and keeps no trajectories."""
    code = "import benchmarks.affine as a; print(a.own_peak())"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    figures["peak_gb_4096"] = float(done.stdout.split()[-1])
    print(f"peak memory, 4096 x 10 s: {figures['peak_gb_4096']:.2f} GB, base motions of 0.15 GB and libraries included")


def own_peak() -> float:
    """GB. Linux says since when: getrusage's peak also knows that of the process that started this one."""
    ours(motions(4096, 10.0, STEP), STEP)
    status = Path("/proc/self/status")
    if not status.exists():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9
    (line,) = (line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) * 1024 / 1e9


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--short", action="store_true")
    arguments = parser.parse_args()
    figures: dict[str, float] = {}
    print(f"{CORES} cores, step {STEP:.5f} s, {ARM.nodes} nodes, order {ARM.order}")
    errors(arguments.short, figures)
    ratios(arguments.short, figures)
    others(arguments.short, figures)
    paper_search(arguments.short, figures)
    peak_memory(figures)
    identification(arguments.short, figures)
    arguments.json.write_text(json.dumps({"figures": figures}, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

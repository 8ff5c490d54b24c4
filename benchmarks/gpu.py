"""The fused kernel on a CUDA device: its answers against the CPU's, its rate over the batch, its share of the peak.

    python benchmarks/gpu.py --json FILE [--largest 1000000]

Figures: gpu_error: largest difference of mean thrust from the CPU kernel, over the largest thrust; gpu_gaits_per_s: of
10 s each, in the largest batch, from numpy array to numpy array; gpu_kernel_gaits_per_s: the same with both on the
device; cpu_gaits_per_s: all cores of this machine in the same run; gpu_fp64_peak, gpu_fp32_peak: measured, of chains of
fused multiply-adds [flop/s]; gpu_share_of_fp64_peak, gpu_share_of_fp32_peak: the kernel's arithmetic (counted in its
text) over it; gpu_single_gaits_per_s, gpu_single_error: the same kernel in single precision, which the program does not
use; gpu_seed_gap: largest relative difference between devices of the optimised thrust and of the best of every
generation, over seeds and methods; gpu_gradient_gap: of the gradient of thrust, speed and power by genes;
gpu_many_gaits, gpu_many_s: gaits of the large search of an arm and their time; gpu_many_over_default,
gpu_many_over_default_least: its best gait over that of the program's own search of 5000, most and least over the arms
of Table II, by thrust and by speed.
Without a device it says so and writes no figure.
"""

from __future__ import annotations

import argparse
import ast
import json
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

# benchmarks/vision.py and benchmarks/rig.py must not stand for the rooms of those names.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from affine_model.advance import Pace
from affine_model.swim import (
    OBJECTIVES,
    SearchPlan,
    assumed_model,
    optimise_gait,
    paper_cone,
    run,
    search_box,
    trial_of,
)
from affine_model.swim.limits import Box
from affine_model.swim.methods.genetic import GeneticAlgorithm
from affine_model.swim.methods.random_search import RandomSearch
from affine_model.swim.objectives import Objective, gait_scores
from affine_model.swim.optimise import climb, for_objective
from affine_model.swim.trial import GaitTrial

Searcher = tuple[Any, int]  # a method of affine_model.swim.methods, and how many gaits it may try

SECONDS = 10.0
BATCHES = (256, 1024, 4096, 16384, 65536, 262144)
CHAINS, ROUNDS, LANES = 8, 20_000, 132 * 2048
POPULATION, DRAWN, BRED = 262_144, 10_000_000, 25 * 262_144
ROOT = 10  # operations of an inverse square root: a start and two iterations


def kernel_seconds(work: Callable[[], object]) -> float:
    """Median seconds of three calls after one, the device waited for."""
    import torch

    times = []
    for _ in range(4):
        torch.cuda.synchronize()
        begin = time.perf_counter()
        work()
        torch.cuda.synchronize()
        times.append(time.perf_counter() - begin)
    return statistics.median(times[1:])


def chain_source(kind: str) -> str:
    """A Warp kernel of independent chains of fused multiply-adds, in float32 or float64."""
    chain = [f"        x{k} = x{k} * a + b" for k in range(CHAINS)]
    return "\n".join(
        [
            "import warp as wp",
            "@wp.kernel(enable_backward=False)",
            f"def chains(a: wp.{kind}, b: wp.{kind}, rounds: int, out: wp.array(dtype=wp.{kind})):",
            "    i = wp.tid()",
            *(f"    x{k} = wp.{kind}(i + {k})" for k in range(CHAINS)),
            "    for _ in range(rounds):",
            *chain,
            *(["    total = x0"] + [f"    total = total + x{k}" for k in range(1, CHAINS)]),
            "    out[i] = total",
            "",
        ]
    )


def measured_peak(kind: str) -> float:
    """Floating-point operations a second of the chains."""
    import torch

    from affine_model.gpu import warp
    from affine_model.kernel.load import module_of

    wp = warp()
    kernel = module_of(f"chains_{kind}", chain_source(kind)).chains
    out = torch.zeros(LANES, dtype=getattr(torch, kind), device="cuda")
    inputs = [0.999, 1e-3, ROUNDS, wp.from_torch(out)]
    seconds = kernel_seconds(lambda: wp.launch(kernel, dim=LANES, inputs=inputs, device="cuda"))
    return 2.0 * CHAINS * ROUNDS * LANES / seconds


def swimming() -> GaitTrial:
    """The paper's arm of 21 cm, gaits of 10 s."""
    return replace(trial_of(assumed_model(paper_cone(0.21), "dragon-skin-10")), settle=4.0, window=6.0, device="cuda")


def compared(trial: GaitTrial, figures: dict[str, float]) -> None:
    """Both devices on the same gaits."""
    alpha = search_box(trial.limits).alpha(np.random.default_rng(1).random((9, 4096)))
    own = replace(trial, device="cpu")
    run(own, alpha[:, :16])
    begin = time.perf_counter()
    expected = run(own, alpha).thrust
    figures["cpu_gaits_per_s"] = alpha.shape[1] / (time.perf_counter() - begin)
    found = run(trial, alpha).thrust
    figures["gpu_error"] = float(np.max(np.abs(found - expected)) / np.max(np.abs(expected)))
    print(f"4096 gaits: {figures['cpu_gaits_per_s']:.0f} gaits/s on the CPU; difference {figures['gpu_error']:.1e}")


def measured(trial: GaitTrial, largest: int, figures: dict[str, float]) -> None:
    """The rate over the batch."""
    import torch

    from affine_model.swim.torch_evaluate import population, swum

    box, draws = search_box(trial.limits), np.random.default_rng(0)
    parameters = torch.from_numpy(trial.parameters)
    own, timing = (trial.arm, trial.drive), (Pace(trial.step, 2, trial.settled), trial.steps)
    bounds = trial.limits.bounds
    for gaits in (*(count for count in BATCHES if count < largest), largest):
        alpha = box.alpha(draws.random((9, gaits)))
        genes = population(np.ascontiguousarray(alpha.T), "cuda")
        inside = kernel_seconds(lambda g=genes: swum(*own, g, parameters, bounds, timing))
        whole = kernel_seconds(lambda a=alpha: run(trial, a))
        figures["gpu_kernel_gaits_per_s"], figures["gpu_gaits_per_s"] = gaits / inside, gaits / whole
        print(f"{gaits} gaits: {gaits / inside:.0f} a second on the device, {gaits / whole:.0f} from array to array")


def operations(text: str) -> float:
    """Floating-point operations of one step of the generated kernel: additions, multiplications and divisions of
    doubles in its loops over the steps, a sine's polynomial and an inverse root's iteration included.
    """
    kernel = next(node for node in ast.parse(text).body if getattr(node, "name", "") == "swim")
    loops = [node for node in ast.walk(kernel) if isinstance(node, ast.For) and ast.unparse(node.target) == "step"]
    arithmetic = (ast.Add, ast.Sub, ast.Mult, ast.Div)
    found = 0
    for node in (inner for loop in loops for inner in ast.walk(loop)):
        whole = "step" in ast.unparse(node) or "quadrant" in ast.unparse(node)
        found += isinstance(node, ast.BinOp) and isinstance(node.op, arithmetic) and not whole
        found += ROOT if isinstance(node, ast.Call) and ast.unparse(node.func) == "inverse_root" else 0
    return float(found)


def shares(trial: GaitTrial, gaits: int, figures: dict[str, float]) -> None:
    """Shares of the peak; the kernel in single precision beside it."""
    import torch

    from affine_model.gpu import THREADS, prepared_swim, warp
    from affine_model.kernel.load import module_of

    wp = warp()
    prepared = prepared_swim(trial.arm, trial.drive, trial.parameters[:, 0], trial.limits.bounds, trial.step)
    done = operations(prepared.text) * trial.steps * gaits
    figures["gpu_share_of_fp64_peak"] = done * figures["gpu_kernel_gaits_per_s"] / gaits / figures["gpu_fp64_peak"]
    single = prepared.text.replace("float64", "float32")
    own = module_of("swim_single", single).swim
    alpha = search_box(trial.limits).alpha(np.random.default_rng(0).random((9, gaits)))
    genes = torch.from_numpy(np.ascontiguousarray(alpha.T)).float().cuda()
    found = torch.zeros(6, gaits, device="cuda")
    values = wp.types.vector(length=len(prepared.table), dtype=wp.float32)(*prepared.table)
    inputs = [wp.from_torch(genes), trial.steps, 1, trial.settled, wp.from_torch(found), values]
    seconds = kernel_seconds(lambda: wp.launch(own, dim=gaits, inputs=inputs, device="cuda", block_dim=THREADS))
    expected = run(trial, alpha).thrust[:, 0]
    figures["gpu_single_gaits_per_s"] = gaits / seconds
    figures["gpu_share_of_fp32_peak"] = done / seconds / figures["gpu_fp32_peak"]
    wrong = np.abs(found[0].cpu().numpy() - expected)
    figures["gpu_single_error"] = float(np.max(wrong) / np.max(np.abs(expected)))
    print(f"single precision: {gaits / seconds:.0f} gaits/s, error {figures['gpu_single_error']:.1e}")


def searched(trial: GaitTrial, figures: dict[str, float]) -> None:
    """Searches of a seed on both devices: the gait's thrust, and the best of every generation."""
    gaps = []
    for method in ("cmaes", "ga", "random"):
        for seed in range(3):
            plan = SearchPlan(method, 2000, seed)
            one, other = (optimise_gait(replace(trial, device=d), OBJECTIVES["thrust"], plan) for d in ("cpu", "cuda"))
            course = float(np.max(np.abs(other.best / one.best - 1.0)))
            gaps.append(max(course, abs(other.promise.thrust / one.promise.thrust - 1.0)))
            far = float(np.max(np.abs(np.subtract(one.gait.alpha, other.gait.alpha))))
            print(f"{method}, seed {seed}: {1e3 * one.promise.thrust:.4f} mN, gap {gaps[-1]:.1e}, gait {far:.1e}")
    figures["gpu_seed_gap"] = max(gaps)


def gradients(trial: GaitTrial, figures: dict[str, float]) -> None:
    """Exact gradients on both devices."""
    import torch

    from affine_model.swim.torch_evaluate import swum

    short = replace(trial, settle=0.5, window=1.0)
    genes = search_box(trial.limits).alpha(np.random.default_rng(2).random((9, 4))).T.copy()
    timing = Pace(short.step, 2, short.settled), short.steps
    slopes = []
    for device in ("cpu", "cuda"):
        given = torch.from_numpy(genes).to(device).requires_grad_(True)
        parameters = torch.from_numpy(short.parameters).to(device)
        rows = swum(short.arm, short.drive, given, parameters, short.limits.bounds, timing)
        slopes += [
            torch.stack([torch.autograd.grad(rows[k].sum(), given, retain_graph=True)[0].cpu() for k in range(3)])
        ]
    scale = slopes[0].abs().amax(dim=(1, 2), keepdim=True)
    figures["gpu_gradient_gap"] = float(((slopes[1] - slopes[0]) / scale.clamp_min(1e-300)).abs().max())
    print(f"gradients: gap {figures['gpu_gradient_gap']:.1e}")


def many(figures: dict[str, float]) -> None:
    """Chance and the genetic algorithm with millions of gaits, against the program's own search."""
    ratios, seconds = [], []
    for length in (0.14, 0.21, 0.25):
        trial = replace(trial_of(assumed_model(paper_cone(length), "dragon-skin-10")), device="cuda")
        for objective in (OBJECTIVES["thrust"], OBJECTIVES["speed"]):
            usual = optimise_gait(trial, objective, SearchPlan(evaluations=5000))
            ready, box = for_objective(trial, objective), search_box(trial.limits)
            begin = time.perf_counter()
            found = max((best_of(ready, objective, box, one) for one in (drawn(), bred())), key=lambda pair: pair[0])
            both, _ = climb(ready, objective, box, found[1])
            seconds.append(time.perf_counter() - begin)
            fine = ready.refined()
            ratios.append(float(np.max(gait_scores(objective, fine, run(fine, both)))) / usual.value)
            print(f"{100 * length:.0f} cm, {objective.name}: {ratios[-1]:.4f} times the usual search's, {usual.origin}")
    figures["gpu_many_gaits"], figures["gpu_many_s"] = float(DRAWN + BRED), statistics.median(seconds)
    figures["gpu_many_over_default"], figures["gpu_many_over_default_least"] = max(ratios), min(ratios)


def drawn() -> Searcher:
    """Ten million gaits by chance."""
    return RandomSearch(7, 1_000_000), DRAWN


def bred() -> Searcher:
    """The paper's genetic algorithm with a population of a quarter million."""
    return GeneticAlgorithm(3, population=POPULATION), BRED


def best_of(trial: GaitTrial, objective: Objective, box: Box, search: Searcher) -> tuple[float, Any]:
    """The best score and its point (9,) of the unit cube."""
    method, wanted = search
    best, tried = (-np.inf, np.zeros(9)), 0
    while tried < wanted:
        unit = method.ask()
        scores = gait_scores(objective, trial, run(trial, box.alpha(unit)))
        method.tell(unit, scores)
        tried += scores.size
        leader = int(np.argmax(scores))
        best = max(best, (float(scores[leader]), unit[:, leader]), key=lambda pair: pair[0])
    return best


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--largest", type=int, default=1_000_000)
    arguments = parser.parse_args()
    figures: dict[str, Any] = {}
    import torch

    if not torch.cuda.is_available():
        print("not measured: there is no CUDA device")
        return
    print(torch.cuda.get_device_name(0))
    trial = swimming()
    compared(trial, figures)
    for kind in ("float64", "float32"):
        figures[f"gpu_fp{kind[-2:]}_peak"] = measured_peak(kind)
        print(f"{kind}: {figures[f'gpu_fp{kind[-2:]}_peak'] / 1e12:.1f} Tflop/s in chains of fused multiply-adds")
    measured(trial, arguments.largest, figures)
    shares(trial, min(arguments.largest, 262144), figures)
    searched(trial, figures)
    gradients(trial, figures)
    many(figures)
    arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()

"""Swimming: the paper's Table II ratios on the reference, time of one optimisation, CMA-ES against the paper's GA and
chance.

    python benchmarks/swim.py --json FILE [--short]

Figures: speedup_14, speedup_21, speedup_25: optimised gait over the best sine of the same amplitude and fundamental
(the paper's comparison; it prints 5.5, 2.2, 3.2), speeds by MuJoCo on the rail; speedup_*_servo: the same with all that
the servo can do; promise_gap: largest |affine / MuJoCo - 1| of those speeds; optimise_s: one arm from model to checked
gait, on this machine (optimise_cpu_s: its
processor time); cmaes_over_ga, random_over_ga: best thrust at equal evaluations, medians over seeds; gaits_per_s:
evaluations a second in batches of 4096; gpu_gaits_per_s, gpu_share_of_bandwidth: the largest batch (to 1e6) that a CUDA
device holds, and how near that comes to reading and writing every state and base angle once a step at the bandwidth of
a plain copy (both absent without a device); robust_gain: worst-quarter thrust of the robust gait over that of the plain
one.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from affine_model.swim import (
    METHODS,
    OBJECTIVES,
    assumed_model,
    optimise,
    paper_cone,
    robust_trial,
    run,
    search,
    search_box,
    trial_of,
)
from affine_model.swim.gaits import gait_tables
from affine_model.swim.objectives import scores
from affine_model.swim.table2 import HEADER, REMARKS, cells, ratios, table2
from tentacle.cli._swimming import reference_speed

SILICONE = "dragon-skin-10"
EVALUATIONS = 5000  # the paper's 50 x 100


def measure_table2(figures: dict[str, float], evaluations: int) -> None:
    rows = table2(evaluations=evaluations, seed=1, reference=reference_speed)
    print(*HEADER, sep=" | ")
    gaps = []
    for line in cells(rows):
        print(*line, sep=" | ")
    print(*REMARKS, sep="\n")
    for row in rows:
        assert row.reference is not None
        name = f"speedup_{100 * row.length:.0f}"
        figures[name], figures[f"{name}_servo"] = ratios(row.reference)
        # The slow sines creep at 0.1 mm/s, where a ratio says nothing: the gap is that of the motions that swim.
        gaps += [abs(one / other - 1.0) for one, other in zip(row.affine[2:], row.reference[2:], strict=True)]
    figures["promise_gap"] = max(gaps)


def measure_time(figures: dict[str, float], evaluations: int) -> None:
    trial = trial_of(assumed_model(paper_cone(0.21), SILICONE))
    optimise(trial, OBJECTIVES["thrust"], evaluations=50, seed=0)  # loads the compiled kernels
    begin, cpu = time.perf_counter(), time.process_time()
    found = optimise(trial, OBJECTIVES["thrust"], evaluations=evaluations, seed=0)
    figures["optimise_s"] = time.perf_counter() - begin
    figures["optimise_cpu_s"] = time.process_time() - cpu
    print(
        f"one arm, {evaluations} gaits: {figures['optimise_s']:.2f} s, {figures['optimise_cpu_s']:.2f} s of processor "
        f"time; {found.gain:.3f} times the best sine's thrust, climbed from: {found.origin}"
    )


def measure_methods(figures: dict[str, float], evaluations: int, seeds: int) -> None:
    trial = trial_of(assumed_model(paper_cone(0.21), SILICONE))
    box, medians = search_box(trial.limits), {}
    for method in METHODS:
        bests = []
        for seed in range(seeds):
            *_, last = search(trial, OBJECTIVES["thrust"], box, method, evaluations=evaluations, seed=seed)
            bests.append(last.best_score)
        medians[method] = statistics.median(bests)
        print(f"{method}: median {1e3 * medians[method]:.2f} mN, {1e3 * min(bests):.2f} to {1e3 * max(bests):.2f}")
    figures["cmaes_over_ga"] = medians["cmaes"] / medians["ga"]
    figures["random_over_ga"] = medians["random"] / medians["ga"]


def measure_throughput(figures: dict[str, float], gaits: int) -> None:
    trial = trial_of(assumed_model(paper_cone(0.21), SILICONE))
    alpha = search_box(trial.limits).alpha(np.random.default_rng(0).random((9, gaits)))
    run(trial, alpha[:, :16])
    begin = time.perf_counter()
    run(trial, alpha)
    figures["gaits_per_s"] = gaits / (time.perf_counter() - begin)
    seconds = trial.settle + trial.window
    print(f"{gaits} gaits of {seconds:g} s: {figures['gaits_per_s']:.0f} gaits/s")


def measure_gpu(figures: dict[str, float], largest: int) -> None:
    """Batches on a CUDA device, to `largest` or as many as it holds; says so where there is none."""
    if importlib.util.find_spec("torch") is None:
        print("GPU: not measured, PyTorch is not installed")
        return
    import torch

    if not torch.cuda.is_available():
        print("GPU: not measured, there is no CUDA device")
        return
    from affine_model.torch_operator import mean_thrust

    trial = trial_of(assumed_model(paper_cone(0.21), SILICONE))
    box, device = search_box(trial.limits), "cuda"
    block = torch.empty(2**27, dtype=torch.float64, device=device)
    bandwidth = 2 * 8 * block.numel() / gpu_seconds(block.clone)
    # Once a step: three numbers of the base read, the state (order + 2 coordinates, their rates) read and written.
    least = trial.steps * 8.0 * (3 + 4 * (trial.arm.order + 2))
    for gaits in (count for count in (4096, 65536, largest) if count <= largest):
        if 3 * 8 * trial.steps * gaits * 1.5 > torch.cuda.mem_get_info()[0]:
            print(f"GPU: {gaits} gaits do not fit into its memory")
            break
        alpha = box.alpha(np.random.default_rng(0).random((9, min(gaits, 4096))))
        table, _ = gait_tables(alpha, trial.steps, trial.step, trial.limits.bandwidth, 0.5 * trial.step)
        base = torch.as_tensor(table, device=device).repeat(1, 1, -(-gaits // alpha.shape[1]))[:, :, :gaits]
        parameters = torch.as_tensor(trial.parameters, device=device).repeat(1, gaits)
        seconds = gpu_seconds(lambda p=parameters, b=base: mean_thrust(trial.arm, p, b, trial.step))
        figures["gpu_gaits_per_s"] = gaits / seconds
        figures["gpu_share_of_bandwidth"] = least * gaits / seconds / bandwidth
        share = 100 * figures["gpu_share_of_bandwidth"]
        print(f"GPU: {gaits} gaits: {gaits / seconds:.0f} gaits/s, {share:.2f} % of what its memory allows")


def gpu_seconds(work: Callable[[], object]) -> float:
    """Seconds of the second call of two, the device waited for."""
    import torch

    work()
    torch.cuda.synchronize()
    begin = time.perf_counter()
    work()
    torch.cuda.synchronize()
    return time.perf_counter() - begin


def measure_robust(figures: dict[str, float], evaluations: int, samples: int) -> None:
    model = assumed_model(paper_cone(0.21), SILICONE)
    trial, thrust = trial_of(model), OBJECTIVES["thrust"]
    plain = optimise(trial, thrust, evaluations=evaluations, seed=0)
    robust = optimise(robust_trial(trial, model, samples, seed=0), thrust, evaluations=evaluations, seed=0)
    judges = robust_trial(trial, model, 64, seed=99)
    both = np.array([robust.gait.alpha, plain.gait.alpha]).T
    of_robust, of_plain = scores(thrust, judges, run(judges, both))
    figures["robust_gain"] = float(of_robust / of_plain)
    print(f"worst quarter of 64 fresh arms: robust {1e3 * of_robust:.1f} mN, plain {1e3 * of_plain:.1f} mN")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--short", action="store_true", help="fewer seeds and samples")
    arguments = parser.parse_args()
    figures: dict[str, float] = {}
    measure_time(figures, EVALUATIONS)
    measure_table2(figures, EVALUATIONS)
    measure_methods(figures, EVALUATIONS, 3 if arguments.short else 7)
    measure_throughput(figures, 512 if arguments.short else 4096)
    measure_gpu(figures, 65536 if arguments.short else 1_000_000)
    measure_robust(figures, 480 if arguments.short else 2000, 8 if arguments.short else 16)
    arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()

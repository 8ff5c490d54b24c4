"""Swimming: the paper's Table II ratios on the reference, time of one optimisation, CMA-ES against the paper's GA and
chance.

    python benchmarks/swim.py --json FILE [--short]

Figures: speedup_14, speedup_21, speedup_25: optimised gait over the best sine of the same amplitude and fundamental
(the paper's comparison; it prints 5.5, 2.2, 3.2), speeds by MuJoCo on the rail; speedup_*_servo: the same with all that
the servo can do; promise_gap: largest |affine / MuJoCo - 1| of those speeds; optimise_s: one arm from model to checked
gait, on this machine (optimise_cpu_s: its processor time); cmaes_over_ga, ga_individual_over_ga, random_over_ga: best
thrust at equal evaluations, medians over seeds; gaits_per_s: evaluations a second in batches of 4096 (on a CUDA device:
benchmarks/gpu.py); robust_gain: worst-quarter thrust of the robust gait over that of the plain one;
free_speed: speed of the best gait with a free hull [m/s], free_gain: over the best sine, free_gap: |affine / MuJoCo -
1| of it; promise_covered_good, promise_covered_poor: share of 95 % intervals of the posterior in which the thrust of
the plant lies (recordings as usual, and short and noisy), promise_ratio_good, promise_ratio_poor: largest |delivered /
promised - 1|.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from pathlib import Path

import numpy as np

# benchmarks/vision.py and benchmarks/rig.py must not stand for the rooms of those names.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from affine_model.swim import (
    METHODS,
    OBJECTIVES,
    SearchPlan,
    assumed_model,
    optimise_gait,
    paper_cone,
    robust_trial,
    run,
    search,
    search_box,
    trial_of,
)
from affine_model.swim.objectives import gait_scores
from affine_model.swim.table2 import REMARKS, TABLE2_HEADER, cells, ratios, table2
from validation.plants import Filming
from validation.reference_swim import reference_free, reference_speed
from validation.swim_promise import promises_kept

SILICONE = "dragon-skin-10"
EVALUATIONS = 5000  # the paper's 50 x 100


def measure_table2(figures: dict[str, float], evaluations: int) -> None:
    rows = table2(evaluations=evaluations, seed=1, reference=reference_speed)
    print(*TABLE2_HEADER, sep=" | ")
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
    optimise_gait(trial, OBJECTIVES["thrust"], SearchPlan(evaluations=50))  # loads the compiled kernels
    begin, cpu = time.perf_counter(), time.process_time()
    found = optimise_gait(trial, OBJECTIVES["thrust"], SearchPlan(evaluations=evaluations))
    figures["optimise_s"] = time.perf_counter() - begin
    figures["optimise_cpu_s"] = time.process_time() - cpu
    print(
        f"one arm, {evaluations} gaits: {figures['optimise_s']:.2f} s, {figures['optimise_cpu_s']:.2f} s of processor "
        f"time; {found.gain:.3f} times the best sine's thrust, start of the climb: {found.origin}"
    )


def measure_methods(figures: dict[str, float], evaluations: int, seeds: int) -> None:
    trial = trial_of(assumed_model(paper_cone(0.21), SILICONE))
    box, medians = search_box(trial.limits), {}
    for method in METHODS:
        bests = []
        for seed in range(seeds):
            *_, last = search(trial, OBJECTIVES["thrust"], box, SearchPlan(method, evaluations, seed))
            bests.append(last.best_score)
        medians[method] = statistics.median(bests)
        print(f"{method}: median {1e3 * medians[method]:.2f} mN, {1e3 * min(bests):.2f} to {1e3 * max(bests):.2f}")
    figures["cmaes_over_ga"] = medians["cmaes"] / medians["ga"]
    figures["ga_individual_over_ga"] = medians["ga-individual"] / medians["ga"]
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


def measure_robust(figures: dict[str, float], evaluations: int, samples: int) -> None:
    model = assumed_model(paper_cone(0.21), SILICONE)
    trial, thrust = trial_of(model), OBJECTIVES["thrust"]
    plain = optimise_gait(trial, thrust, SearchPlan(evaluations=evaluations))
    robust = optimise_gait(robust_trial(trial, model, samples, seed=0), thrust, SearchPlan(evaluations=evaluations))
    judges = robust_trial(trial, model, 64, seed=99)
    both = np.array([robust.gait.alpha, plain.gait.alpha]).T
    of_robust, of_plain = gait_scores(thrust, judges, run(judges, both))
    figures["robust_gain"] = float(of_robust / of_plain)
    print(f"worst quarter of 64 fresh arms: robust {1e3 * of_robust:.1f} mN, plain {1e3 * of_plain:.1f} mN")


def measure_free(figures: dict[str, float], evaluations: int) -> None:
    model = assumed_model(paper_cone(0.21), SILICONE)
    found = optimise_gait(trial_of(model), OBJECTIVES["free"], SearchPlan(evaluations=evaluations))
    speed, drift = reference_free(model, found.gait)
    figures["free_speed"], figures["free_gain"] = found.value, found.gain
    figures["free_gap"] = abs(found.value / speed - 1.0)
    print(
        f"free hull: {100 * found.value:.2f} cm/s, {found.gain:.3f} times the best sine, yaw drift "
        f"{found.promise.yaw_drift:.4f} rad/s; MuJoCo {100 * speed:.2f} cm/s, {drift:.4f} rad/s"
    )


def measure_promise(figures: dict[str, float], evaluations: int, seeds: int) -> None:
    """Gaits on models of recordings of the MuJoCo plant, and what the plant delivers."""
    print("recording | seed | gait | promised [mN] | 95 % | of independent estimates | the plant | kept | ratio")
    for name, filming in (("good", Filming()), ("poor", Filming(4.0, 20.0, 1e-3))):
        found = [one for seed in range(1, seeds + 1) for one in promises_kept(seed, filming, evaluations, 16)]
        for one in found:
            both = [f"{1e3 * low:.2f} to {1e3 * high:.2f}" for low, high in (one.interval, one.independent)]
            numbers = (f"{1e3 * one.promised:.2f}", *both, f"{1e3 * one.delivered:.2f}")
            print(name, one.seed, one.words, *numbers, one.kept, f"{one.ratio:.3f}", sep=" | ", flush=True)
        figures[f"promise_covered_{name}"] = statistics.mean(one.kept for one in found)
        figures[f"promise_ratio_{name}"] = max(abs(one.ratio - 1.0) for one in found)


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
    measure_robust(figures, 480 if arguments.short else 2000, 8 if arguments.short else 16)
    measure_free(figures, 480 if arguments.short else EVALUATIONS)
    measure_promise(figures, 480 if arguments.short else 2000, 2 if arguments.short else 8)
    arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()

"""The tables of measured figures, from what the benchmarks wrote: no number is typed by hand.

    python benchmarks/readme_table.py [NAME=FILE.json ...]

NAME=FILE.json: what `benchmarks/NAME.py --json FILE.json` wrote (hostile: `python -m tests.hostile.run`); kept in
docs/figures.json, figure by figure, with the commit where it is told. From there the rows between README.md's marks and
all rows between docs/measured.md's are made anew; a row that misses its limit is marked, and explained below the table.
Without arguments the tables alone are made anew.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
README, MEASURED, KEPT = ROOT / "README.md", ROOT / "docs" / "measured.md", ROOT / "docs" / "figures.json"
BEGIN, END = "<!-- figures -->", "<!-- /figures -->"
COMMITS = "commits"  # in docs/figures.json: benchmark -> commit
IN_PARTS = ("first_hour", "vision")  # what was measured before and is not now stays
ELSEWHERE = {"hostile": "make hostile"}  # not in benchmarks/
# The README's: benchmark, figure, words (with figures of the same benchmark by name), unit. Where NAME_low and
# NAME_high are known, the 95 % interval is shown.
FIVE = (
    ("blind", "top1", "one hidden effect at least as large as the noise: named first, or in its group", ""),
    ("blind", "false_alarm", "nothing hidden, but an effect was named", ""),
    ("blind", "unknown_recall", "a hidden effect outside the catalogue, answered with unknown", ""),
    ("vision", "worm_median_px", "midline of a real worm: distance from an independent reference, median", "px"),
    (
        "soak",
        "soak_lost_untold",
        "samples lost without a report in ten minutes of the emulated rig with random faults",
        "",
    ),
    (
        "hostile",
        "hostile_bad",
        "of {hostile_cases:.0f} hostile trials: neither right nor refused in one line",
        "",
    ),
)
# Why a row misses its limit: (benchmark, figure) -> sentences.
WHY = {
    ("hostile", "hostile_bad"): """\
A seed that had not been run before found nine: five tracebacks, two crashes of the compiler under an interrupt, one
answer of several lines, and a film whose reader never ended. Each cause is mended; these cases and 156 new kinds of
input ran again without a bad one. The whole run was not repeated since.""",
    ("vision", "other_renderer_over_limit"): """\
Five of 20 films: a wave along a tail whose tip fades (no five coordinates follow it: the tip errs by up to 1.6 px, and
the stated error says so), dirt on the ground of 13 % of the contrast (2.9 times; the limit knows the dirt's spectrum),
two tails whose base nothing shows (2.1 and 2.4), and a film of 100 x 90 px (2.2), in which the unused 3 px beside the
tip are a twentieth of the arm. With seed 7 (`--seed 7`) the base of a tail slid along it by 2.7 px.""",
    ("blind", "calibration_gap"): """\
The stated confidence is too low for midlines: .85 in the mean, where .96 of the answers are right (R of 1 or more).
For films it is too high. One number corrects both, and it lies between ([why](loop_trials.md#films)).""",
    ("blind", "diagnose_s"): """\
Two diagnoses ran at once on two cores. Half of the time goes into refits of each set with and without the shapes in
which published laws differ.""",
    ("first_hour", "first_verdict_s"): """\
In this time the demo draws its film, tracks it and diagnoses it. Two fifths of the sampled time was compiling tracker,
filter and models; that now runs beside the rest.""",
    ("first_hour", "setup_mb"): """\
Nothing in it can be left out from film to report:
[the sizes of all its parts](#the-set-up-before-and-after). The viewer alone is 170 MB.""",
}
# benchmark, figure, words, unit, what was asked for; a row is shown once its figure is there
ROWS = (
    ("stranger", "right", "effects named right in a simulator that shares nothing with the models, 18 cases", "", ""),
    (
        "blind",
        "trials",
        "blind trials: recordings with something hidden, or nothing, diagnosed without the answer",
        "",
        "",
    ),
    ("blind", "top1", "a single effect of R >= 1 named first, or in its group", "", ""),
    ("blind", "false_alarm", "something named, or unknown, where nothing was hidden", "", "0.02"),
    ("blind", "unknown_recall", "an effect outside the catalogue called unknown", "", ""),
    ("blind", "pairs", "both of a pair named", "", ""),
    (
        "blind",
        "calibration_gap",
        "stated confidence minus hit rate, worst bin",
        "",
        "0.05",
    ),
    (
        "blind",
        "calibration_gap_by_chance",
        "the same by chance alone, if every confidence were true",
        "",
        "",
    ),
    ("blind", "after_over_floor", "held-out error after, over its floor, median", "", "1.2"),
    ("blind", "diagnose_s", "diagnosis of 39 s at 60 frames/s, the whole catalogue", "s", "30"),
    ("vision", "rms_over_limit_max", "tracking error over the Cramer-Rao limit of the recording, worst look", "", "2"),
    ("vision", "z_rms_min", "its error over the stated standard deviation, lowest look", "", ""),
    ("vision", "z_rms_max", "the same, highest look", "", "1.3"),
    ("vision", "worm_median_px", "midline of a real worm: distance from an independent reference, median", "px", "0.8"),
    (
        "vision",
        "other_renderer_films",
        "films drawn by a renderer that shares nothing with the tracker",
        "",
        "",
    ),
    ("vision", "other_renderer_accepted", "their frames with nothing hidden: accepted", "", ""),
    ("vision", "other_renderer_false", "their accepted frames: wrong by over 2 px and 4 stated errors", "", "0.001"),
    (
        "vision",
        "other_renderer_over_limit",
        "error over what the film's own noise allows, worst film",
        "",
        "2",
    ),
    ("vision", "other_renderer_over_limit_median", "the same, median of the films", "", ""),
    (
        "vision",
        "other_renderer_picked",
        "films of which `track --pick` proposes base, length and direction right",
        "",
        "",
    ),
    (
        "vision",
        "other_renderer_plain",
        "films that `track --length --base-radius` tracks without other numbers",
        "",
        "",
    ),
    ("vision", "fps_720p", "tracking at 720p", "frames/s", ""),
    ("vision", "fps_4k", "tracking at 4K", "frames/s", ""),
    ("library_joint", "joint_found", "libraries of 200 in which an effect of R = 0.3 in 20 of them is found", "", ""),
    ("library_joint", "joint_f1_median", "the recordings that have it, F1, median of ten libraries", "", ""),
    (
        "library_joint",
        "joint_f1_90",
        "libraries in which it is found, alone or in a group, with an F1 of 0.9 or more",
        "",
        "",
    ),
    (
        "library_joint",
        "joint_alone_and_f1_90",
        "libraries with F1 of 0.9 or more and one effect named",
        "",
        "",
    ),
    ("library_joint", "joint_false_libraries", "libraries without an effect in which one is found", "", "0.05"),
    (
        "library_joint",
        "joint_E_interval_holds",
        "intervals of a stiffness that falls by 4 % that hold the truth",
        "",
        "",
    ),
    (
        "export",
        "export_ratio_worst",
        "five diagnosed recordings: error of MuJoCo with the exported forces over ours, worst",
        "",
        "1.1",
    ),
    ("precision", "ratio_at_3_percent", "speed over the best other program at 3 % error, worst case", "times", ""),
    ("precision", "ratio_at_1_percent", "the same at 1 %", "times", ""),
    ("precision", "ratio_at_03_percent", "the same at 0.3 %", "times", ""),
    ("precision", "ratio_at_3_percent_single", "the same at 3 %, one arm alone, not a batch", "times", ""),
    ("precision", "floor_order_2", "least error of two coordinates, worst case of arms and motions", "", ""),
    ("precision", "floor_order_5", "the same of five", "", ""),
    ("affine", "fraction_of_peak", "the compiled model's arithmetic over a matrix product's", "", ""),
    ("affine", "paper_ga_s", "the paper's search: 5000 gaits of 10 s", "s", "5"),
    ("affine", "peak_gb_4096", "peak memory, 4096 runs of 10 s", "GB", "1"),
    ("affine", "thrust_error", "mean thrust of two coordinates: the step's own error, median", "", "0.001"),
    ("affine", "coverage_95", "95 % intervals that hold the truth", "", ""),
    ("affine", "identify_s", "identification, 39 s at 25 frames/s", "s", "3"),
    (
        "reference",
        "sim_s_per_core_s",
        "MuJoCo reference, 20 links, fluid, added mass: simulated seconds per second and core",
        "",
        "",
    ),
    ("reference", "added_mass_ratio", "its first frequency in water over air (theory .719)", "", ""),
    ("reference", "order_links", "its observed order of convergence in the links", "", ""),
    ("reference", "momentum_n", "its momentum balance at the mount closes to", "N", "0.0001"),
    ("reference", "pyelastica_f1_gap", "its first frequency, difference from PyElastica", "", "0.02"),
    ("reference", "sweep_efficiency", "1000 runs on two workers, over ideal", "", ""),
    ("swim", "speedup_14", "optimised gait over sine in the paper's map, 14 cm arm (paper: 5.5)", "", ""),
    ("swim", "speedup_21", "the same, 21 cm (paper: 2.2)", "", ""),
    ("swim", "speedup_25", "the same, 25 cm (paper: 3.2)", "", ""),
    ("swim", "speedup_14_servo", "the same within a hobby servo's limits, 14 cm", "", ""),
    ("swim", "speedup_21_servo", "the same, 21 cm", "", ""),
    ("swim", "speedup_25_servo", "the same, 25 cm", "", ""),
    ("swim", "cmaes_over_ga", "CMA-ES over the paper's GA, thrust at equal evaluations", "", ""),
    ("swim", "free_gain", "with a hull that swims freely: optimised gait over sine, 21 cm arm", "", ""),
    ("swim", "free_gap", "the same gait's speed, difference from MuJoCo", "", ""),
    ("swim", "promise_covered_good", "thrust of a gait on the MuJoCo plant within the model's 95 % interval", "", ""),
    ("swim", "promise_ratio_good", "the same, largest difference from the promise", "", ""),
    ("swim", "promise_covered_poor", "the same of short noisy recordings: within the interval", "", ""),
    ("swim", "promise_ratio_poor", "the same, largest difference from the promise", "", ""),
    ("swim", "optimise_s", "one arm from model to checked gait", "s", "5"),
    ("gpu", "gpu_gaits_per_s", "a million gaits of 10 s on one NVIDIA H100, from array to array", "gaits/s", ""),
    ("gpu", "cpu_gaits_per_s", "4096 of them on the 16 CPU cores of the same machine", "gaits/s", ""),
    ("gpu", "gpu_error", "largest difference of thrust between the two", "", "1e-06"),
    ("gpu", "gpu_share_of_fp64_peak", "the fused kernel's arithmetic over the device's measured peak in FP64", "", ""),
    ("gpu", "gpu_single_gaits_per_s", "the same kernel in single precision", "gaits/s", ""),
    ("gpu", "gpu_share_of_fp32_peak", "its arithmetic over the measured peak in FP32", "", ""),
    ("gpu", "gpu_single_error", "its error of thrust", "", ""),
    (
        "gpu",
        "gpu_seed_gap",
        "nine searches: largest difference of the gait's thrust from the CPU's",
        "",
        "1e-06",
    ),
    ("gpu", "gpu_many_gaits", "gaits of a large search on the device, of each arm and objective", "", ""),
    ("gpu", "gpu_many_s", "its time, median", "s", ""),
    ("gpu", "gpu_many_over_default", "its best gait over that of the usual search of 5000, most of six", "", ""),
    ("gpu", "gpu_many_over_default_least", "the same, least of six", "", ""),
    ("gpu", "gpu_gradient_gap", "gradients by genes: largest difference from the CPU's", "", "1e-06"),
    ("rig", "samples_lost", "samples lost or doubled in 10 minutes on the emulated rig", "", "0"),
    ("soak", "soak_runs", "runs of the emulated rig in ten minutes, each with a random fault", "", ""),
    ("soak", "soak_unreadable", "recordings of these that cannot be read", "", "0"),
    ("soak", "soak_lost_untold", "samples lost in these without a report", "", "0"),
    ("hostile", "hostile_cases", "hostile trials: damaged inputs, full disks, signals, damaged caches", "", ""),
    ("hostile", "hostile_bad", "of these neither right nor refused in one line", "", "0"),
    ("film", "film_minutes", "putting a camera's frames into the recording's film: length of the film", "min", ""),
    ("film", "film_fps", "speed of that, 720p, while other programs ran on the two cores", "frames/s", ""),
    ("film", "film_peak_mb", "peak memory of that", "MB", "500"),
    ("film", "film_before_mb", "memory before it", "MB", ""),
    ("film", "film_read_peak_mb", "reading that recording and its film: peak memory of both processes", "MB", "500"),
    ("rig", "clock_ms", "difference between host and board clocks, worst", "ms", "1"),
    ("rig", "camera_offset_ms", "error of the camera's delay", "ms", "3"),
    ("rig", "wrong_accepted", "wrong samples accepted from damaged lines", "", "0"),
    ("rig", "neutral_s", "host killed (-9): time until the arm is at neutral", "s", "0.5"),
    ("rig", "tail_lost_s", "host killed (-9): end of the recording that is lost", "s", "0.3"),
    ("rig", "faults_survived", "faults survived, of 15 tried", "", ""),
    (
        "rig",
        "gap_after_30_reidentified",
        "gait after 30 trials on the rig with re-identified models, distance from the best",
        "",
        "0.05",
    ),
    ("rig", "gap_after_30", "the same without re-identification", "", "0.05"),
    ("first_hour", "setup_s", "`make demo`: set-up from an empty cache", "s", "60"),
    ("first_hour", "setup_mb", "`make demo`: download", "MB", "450"),
    ("first_hour", "before_s", "the earlier, larger set-up, in the same run", "s", ""),
    ("first_hour", "before_mb", "download of the earlier set-up", "MB", ""),
    (
        "first_hour",
        "first_verdict_s",
        "from there to the demo's first verdict, the model compiled on the way",
        "s",
        "60",
    ),
    ("first_hour", "app_paint_s", "`tentacle app` to its page drawn in a browser", "s", ""),
    ("first_hour", "import_s", "`import tentacle`", "s", "0.5"),
    ("first_hour", "help_s", "`tentacle --help`", "s", "0.7"),
    ("first_hour", "rrd_mb_39s", "session of a 39 s recording", "MB", "20"),
    ("first_hour", "report_mb", "its report", "MB", "3"),
    ("first_hour", "path_minutes", "from clone to verdict, without downloads", "min", ""),
)


def _shown(value: float) -> str:
    """Three digits, and thousands without a power of ten; counts in full."""
    if float(value).is_integer() and abs(value) < 1e6:
        return f"{value:.0f}"
    return f"{value:.3g}" if abs(value) < 1000.0 else f"{float(f'{value:.3g}'):.0f}"


def is_missed(value: float, limit: str) -> bool:
    """Whether a figure is over what was asked for."""
    return bool(limit) and value > float(limit)


def table(figures: dict[str, dict[str, Any]]) -> str:
    """All rows as Markdown, of the figures that are known; a sentence where none is."""
    known = [row for row in ROWS if row[1] in figures.get(row[0], {})]
    if not known:
        return "No figure has been measured yet: `python benchmarks/readme_table.py NAME=FILE.json` puts them here."
    rows, notes = [], []
    for benchmark, name, words, unit, limit in known:
        value = figures[benchmark][name]
        missed = is_missed(value, limit)
        if missed:
            notes.append(f"**Missed: {words}.** {WHY.get((benchmark, name), 'Not explained yet.')}")
        mark = " (missed)" if missed else ""
        made = f"`{ELSEWHERE.get(benchmark, f'{benchmark}.py')}`"
        commit = figures.get(COMMITS, {}).get(benchmark)
        at = f" at `{commit}`" if commit else ""
        rows.append(f"| {words} | {_with_unit(value, unit)}{mark} | {limit} | {made}{at} |")
    lines = ["| what | measured | at most | by benchmarks/ |", "|---|---|---|---|", *rows]
    return "\n\n".join(["\n".join(lines), *notes])


def five(figures: dict[str, dict[str, Any]]) -> str:
    """The README's rows as Markdown, each with its 95 % interval where one is known."""
    rows = []
    for benchmark, name, words, unit in FIVE:
        known = figures.get(benchmark, {})
        if name in known:
            ends = [known.get(f"{name}_{end}") for end in ("low", "high")]
            between = "" if None in ends else f" ({_shown(ends[0])} to {_shown(ends[1])})"  # type: ignore[arg-type]
            rows.append(f"| {words.format(**known)} | {_with_unit(known[name], unit)}{between} |")
    return "\n".join(["| what | measured (95 % interval) |", "|---|---|", *rows])


def _with_unit(value: float, unit: str) -> str:
    return f"{_shown(value)} {unit}".rstrip()


def with_rows(page: str, rows: str) -> str:
    """The page with what stands between its marks made anew. ValueError where the marks are missing."""
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"the page lacks {BEGIN} or {END}")
    return f"{before}{BEGIN}\n{rows}\n{END}{after}"


def kept() -> dict[str, dict[str, Any]]:
    """What is known so far: benchmark -> figure -> value."""
    return json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}


def main() -> None:
    """Take the results named, and write all three files."""
    figures = kept()
    for argument in sys.argv[1:]:
        name, _, file = argument.partition("=")
        if not file or (name not in ELSEWHERE and not (ROOT / "benchmarks" / f"{name}.py").exists()):
            raise SystemExit(f"{argument}: expected NAME=FILE.json, NAME one of benchmarks/NAME.py")
        written = json.loads(Path(file).read_text(encoding="utf-8"))
        taken = {key: value for key, value in written["figures"].items() if isinstance(value, int | float)}
        if written.get("commit"):
            figures.setdefault(COMMITS, {})[name] = written["commit"]
        figures[name] = {**(figures.get(name, {}) if name in IN_PARTS else {}), **taken}
    KEPT.write_text(json.dumps(figures, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    for page, rows in ((README, five(figures)), (MEASURED, table(figures))):
        page.write_text(with_rows(page.read_text(encoding="utf-8"), rows), encoding="utf-8")


if __name__ == "__main__":
    main()

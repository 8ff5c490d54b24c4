"""The README's table of measured figures, from what the benchmarks wrote: no number is typed by hand.

    python benchmarks/readme_table.py [NAME=FILE.json ...]

NAME=FILE.json: what `benchmarks/NAME.py --json FILE.json` wrote; it is kept in docs/figures.json, figure by figure, and
the table between README.md's marks is made anew from there. Without arguments the table alone is made anew.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
README, KEPT = ROOT / "README.md", ROOT / "docs" / "figures.json"
BEGIN, END = "<!-- figures -->", "<!-- /figures -->"
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
        "stated confidence off the hit rate, worst bin, by the map that the series before made",
        "",
        "0.05",
    ),
    (
        "blind",
        "calibration_gap_by_chance",
        "the same by luck alone in as many trials, were every confidence true",
        "",
        "",
    ),
    ("blind", "after_over_floor", "held-out error after, over its floor, median", "", "1.2"),
    ("blind", "diagnose_s", "diagnosis of 39 s at 60 frames/s, the whole catalogue", "s", "30"),
    ("vision", "rms_over_limit_max", "tracking error over the Cramer-Rao limit of the recording, worst look", "", "2"),
    ("vision", "z_rms_min", "its error over the stated standard deviation: least of all looks", "", ""),
    ("vision", "z_rms_max", "and largest", "", "1.3"),
    ("vision", "worm_median_px", "midline of a real worm from its outside reference, median", "px", "0.8"),
    ("vision", "fps_720p", "tracking at 720p", "frames/s", ""),
    ("vision", "fps_4k", "tracking at 4K", "frames/s", ""),
    ("affine", "ratio_mujoco_50", "compiled model over MuJoCo (20 links, fluid, 2 ms), batch of 50", "times", ""),
    ("affine", "ratio_mujoco_4096", "the same, batch of 4096", "times", ""),
    ("affine", "ratio_mujoco_10ms_4096", "the same, MuJoCo at 10 ms", "times", ""),
    ("affine", "ratio_soromox", "the same over SoRoMoX (GVS order 1, drag), batch of 50", "times", ""),
    ("affine", "fraction_of_peak", "its arithmetic over a matrix product's", "", ""),
    ("affine", "paper_ga_s", "the paper's search: 5000 gaits of 10 s", "s", "5"),
    ("affine", "peak_gb_4096", "peak memory, 4096 runs of 10 s", "GB", "1"),
    ("affine", "thrust_error", "mean thrust of the compiled model, relative error, median", "", "0.001"),
    ("affine", "coverage_95", "95 % intervals that hold the truth", "", ""),
    ("affine", "identify_s", "identification, 39 s at 25 frames/s", "s", "3"),
    (
        "reference",
        "sim_s_per_core_s",
        "MuJoCo reference, 20 links, fluid, added mass, simulated s a s and core",
        "",
        "",
    ),
    ("reference", "added_mass_ratio", "its first frequency in water over air (theory .719)", "", ""),
    ("reference", "order_links", "its observed order of convergence in the links", "", ""),
    ("reference", "momentum_n", "its momentum balance at the mount closes to", "N", "0.0001"),
    ("reference", "pyelastica_f1_gap", "its first frequency from PyElastica's", "", "0.02"),
    ("reference", "sweep_efficiency", "1000 runs on two workers, over ideal", "", ""),
    ("swim", "speedup_14", "optimised gait over sine in the paper's map, 14 cm arm (paper: 5.5)", "", ""),
    ("swim", "speedup_21", "the same, 21 cm (paper: 2.2)", "", ""),
    ("swim", "speedup_25", "the same, 25 cm (paper: 3.2)", "", ""),
    ("swim", "speedup_14_servo", "the same, all that a servo can do allowed to both, 14 cm", "", ""),
    ("swim", "speedup_21_servo", "the same, 21 cm", "", ""),
    ("swim", "speedup_25_servo", "the same, 25 cm", "", ""),
    ("swim", "cmaes_over_ga", "CMA-ES over the paper's GA, thrust at equal evaluations", "", ""),
    ("swim", "optimise_s", "one arm from model to checked gait", "s", "5"),
    ("rig", "samples_lost", "samples lost or doubled in 10 minutes on the emulated rig", "", "0"),
    ("soak", "soak_runs", "runs of the emulated rig in a ten-minute soak, a fault drawn at random for each", "", ""),
    ("soak", "soak_unreadable", "recordings of them that cannot be read", "", "0"),
    ("soak", "soak_lost_untold", "samples lost in them without being told", "", "0"),
    ("hostile", "hostile_cases", "hostile trials: damaged inputs, full disks, signals, torn caches", "", "600"),
    ("hostile", "hostile_bad", "of them neither right nor refused in one line", "", "0"),
    ("rig", "clock_ms", "host and board clocks apart, worst", "ms", "1"),
    ("rig", "camera_offset_ms", "camera's delay, error", "ms", "3"),
    ("rig", "wrong_accepted", "wrong samples accepted from damaged lines", "", "0"),
    ("rig", "neutral_s", "host killed -9: arm at neutral after", "s", "0.5"),
    ("rig", "tail_lost_s", "and lost of the recording", "s", "0.3"),
    ("rig", "faults_survived", "faults survived, of 15 tried", "", ""),
    (
        "rig",
        "gap_after_30_reidentified",
        "gait after 30 trials on the rig, models re-identified, short of the best",
        "",
        "0.05",
    ),
    ("rig", "gap_after_30", "the same without re-identification", "", "0.05"),
    ("first_hour", "import_s", "`import tentacle`", "s", "0.5"),
    ("first_hour", "help_s", "`tentacle --help`", "s", "0.7"),
    ("first_hour", "rrd_mb_39s", "session of a 39 s recording", "MB", "20"),
    ("first_hour", "report_mb", "its report", "MB", "3"),
    ("first_hour", "path_minutes", "clone to verdict, downloads apart", "min", ""),
)


def _shown(value: float) -> str:
    """Three digits, and thousands without a power of ten."""
    return f"{value:.3g}" if abs(value) < 1000.0 else f"{float(f'{value:.3g}'):.0f}"


def table(figures: dict[str, dict[str, float]]) -> str:
    """The table as Markdown, of the figures that are known; a sentence where none is."""
    rows = [
        f"| {words} | {_shown(figures[benchmark][name])}{f' {unit}' if unit else ''} | {limit} | `{benchmark}.py` |"
        for benchmark, name, words, unit, limit in ROWS
        if name in figures.get(benchmark, {})
    ]
    if not rows:
        return "No figure has been measured yet: `python benchmarks/readme_table.py NAME=FILE.json` puts them here."
    return "\n".join(["| what | measured | at most | by benchmarks/ |", "|---|---|---|---|", *rows])


def with_table(readme: str, figures: dict[str, dict[str, float]]) -> str:
    """The README with its table made anew. ValueError where the marks are missing."""
    before, begin, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"README.md lacks {BEGIN} or {END}")
    return f"{before}{BEGIN}\n{table(figures)}\n{END}{after}"


def kept() -> dict[str, dict[str, float]]:
    """What is known so far: benchmark -> figure -> value."""
    return json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}


def main() -> None:
    """Take the results named, and write both files."""
    figures = kept()
    for argument in sys.argv[1:]:
        name, _, file = argument.partition("=")
        if not file or not (ROOT / "benchmarks" / f"{name}.py").exists():
            raise SystemExit(f"{argument}: expected NAME=FILE.json, NAME one of benchmarks/NAME.py")
        found = json.loads(Path(file).read_text(encoding="utf-8"))["figures"]
        figures[name] = {key: value for key, value in found.items() if isinstance(value, int | float)}
    KEPT.write_text(json.dumps(figures, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    README.write_text(with_table(README.read_text(encoding="utf-8"), figures), encoding="utf-8")


if __name__ == "__main__":
    main()

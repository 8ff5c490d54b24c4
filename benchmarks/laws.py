"""Hidden laws and nulls: how often the search after an unknown finds the law that a plant hides, and how often it
invents one.

python benchmarks/laws.py --json FILE [--laws N] [--nulls N] [--seed S] [--only KIND ...] [--results FILE.jsonl]

Laws are drawn from the grammar by a seed and hidden by the stranger (validation.trials.law_trial), 39 s of midline at
.15 mm, 2 to 20 noise deviations large. A law is exact where its form is right, its power within .1 and its place within
5 % of the length; naming the effect of the catalogue that the drawn law is counts as exact. Seeds below 1000 are for
development. A stopped run goes on from its results; a row holds all that was proposed.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

# benchmarks/vision.py must not stand for the room of that name.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from discovery.diagnose import diagnose
from tentacle.diagnosis import Diagnosis
from validation.trials.law_trial import CLASSES, IN_DISGUISE, law_recording, met

LAWS, NULLS = 60, 60
HELD_OUT_LIMIT = 1.2  # of the floor
TARGETS = {
    "exact_first": ">= .50", "exact_in_five": ">= .75", "held_out_within": ">= .80", "invented": "<= 1 of 60",
    "cpu_s": "<= 600 s on two cores",
}  # fmt: skip


def trial(seed: int, kind: str) -> dict[str, Any]:
    """One trial's row."""
    recording, truth = law_recording(seed, kind)
    begin = time.process_time(), time.perf_counter()
    found = diagnose([recording])
    cpu, wall = time.process_time() - begin[0], time.perf_counter() - begin[1]
    near = met(truth, found.missing.laws)
    return {
        "seed": seed, "kind": kind, "numbers": truth["numbers"], "length": truth["arm"]["length"],
        "R": truth["moved_mm"] / truth["noise_mm"], "verdict": found.verdict, "effects": list(found.effects),
        "disguise": found.verdict in ("effect", "group") and IN_DISGUISE.get(kind) in found.effects,
        "laws": [{**asdict(one), "exact": one.exact, "values": law.values, "evidence": law.evidence}
                 for one, law in zip(near, found.missing.laws, strict=True)],
        "before_mm": found.before.midline_mm, "held_out_mm": _held_out(found), "floor_mm": found.floor.midline_mm,
        "cpu_s": cpu, "wall_s": wall,
    }  # fmt: skip


def _held_out(found: Diagnosis) -> float | None:
    """Of the best law, or of the named effects where no law was sought."""
    return found.missing.laws[0].held_out_midline_mm if found.missing.laws else found.after.midline_mm


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Counts, shares with their 95 % intervals, and medians."""
    hidden, nulls = ([row for row in rows if (row["kind"] == "nothing") == bare] for bare in (False, True))
    counts = {
        "exact_first": [row["disguise"] or (bool(row["laws"]) and row["laws"][0]["exact"]) for row in hidden],
        "exact_in_five": [row["disguise"] or any(law["exact"] for law in row["laws"]) for row in hidden],
        "form_first": [row["disguise"] or (bool(row["laws"]) and row["laws"][0]["form"]) for row in hidden],
        "held_out_within": [bool(row["held_out_mm"]) and row["held_out_mm"] <= HELD_OUT_LIMIT * row["floor_mm"]
                            for row in hidden],
        "called_unknown": [row["verdict"] == "unknown" for row in hidden],
        "invented": [bool(row["laws"]) for row in nulls],
    }  # fmt: skip
    found: dict[str, Any] = {}
    for name, right in counts.items():
        if right:
            low, high = binomtest(sum(right), len(right)).proportion_ci(method="wilson")
            found[name] = {"right": sum(right), "of": len(right), "low": float(low), "high": float(high)}
    for name in ("cpu_s", "wall_s"):
        if hidden:
            found[name] = float(np.median([row[name] for row in hidden]))
            found[f"{name}_worst"] = max(row[name] for row in hidden)
    return found


def line_of(row: dict[str, Any]) -> str:
    """A row in a line."""
    marks = [(law["name"], " EXACT" if law["exact"] else " form" if law["form"] else "") for law in row["laws"]]
    best = [name + mark for name, mark in marks]
    held = "-" if row["held_out_mm"] is None else f"{row['held_out_mm']:.3f}"
    floor = "-" if row["floor_mm"] is None else f"{row['floor_mm']:.3f}"
    named = "+".join(row["effects"]) + (" (the law in disguise)" if row["disguise"] else "")
    trial = f"{row['seed']:7d} {row['kind']:16s} R {row['R']:5.1f}  {row['verdict']} {named}"
    return (f"{trial}: {', '.join(best) or 'no law'}; held out {held} mm, floor {floor}; "
            f"{row['cpu_s']:.0f} s CPU")  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True, metavar="FILE")
    parser.add_argument("--laws", type=int, default=LAWS, metavar="N")
    parser.add_argument("--nulls", type=int, default=NULLS, metavar="N")
    parser.add_argument("--seed", type=int, default=0, help="of the first trial; the others follow it")
    parser.add_argument("--only", nargs="+", choices=CLASSES, default=CLASSES, metavar="KIND", help="these in turn")
    parser.add_argument("--results", type=Path, metavar="FILE", help="rows; a stopped run goes on from them")
    arguments = parser.parse_args()
    results = arguments.results or arguments.json.with_suffix(".jsonl")
    rows = [json.loads(line) for line in results.read_text().splitlines()] if results.exists() else []
    done = {(row["seed"], row["kind"]) for row in rows}
    hidden = [(arguments.seed + k, arguments.only[k % len(arguments.only)]) for k in range(arguments.laws)]
    nulls = [(arguments.seed + arguments.laws + k, "nothing") for k in range(arguments.nulls)]
    for seed, kind in mixed(hidden, nulls):
        if (seed, kind) in done:
            continue
        row = trial(seed, kind)
        rows.append(row)
        with results.open("a") as file:
            file.write(json.dumps(row) + "\n")
        print(line_of(row), flush=True)
    wanted = set(hidden) | set(nulls)
    figures = summary([row for row in rows if (row["seed"], row["kind"]) in wanted])
    for name, value in figures.items():
        shown = (f"{value['right']} of {value['of']} ({100 * value['low']:.0f} to {100 * value['high']:.0f} %)"
                 if isinstance(value, dict) else f"{value:.0f}")  # fmt: skip
        print(f"{name:18s} {shown:26s} {TARGETS.get(name, '')}")
    arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")


def mixed(one: list[tuple[int, str]], other: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """Both in turn, so that a run that is stopped has some of each."""
    found: list[tuple[int, str]] = []
    for k in range(max(len(one), len(other))):
        found += [part[k] for part in (one, other) if k < len(part)]
    return found


if __name__ == "__main__":
    main()

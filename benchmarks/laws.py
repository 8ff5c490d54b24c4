"""Hidden laws and nulls: how often the search after an unknown finds the law that a plant hides, and how often it
invents one.

python benchmarks/laws.py --json FILE [--laws N] [--nulls N] [--seed S] [--only KIND ...] [--workers N]

Laws are drawn from the grammar by a seed and hidden by the stranger (validation.trials.law_trial), 39 s of midline at
.15 mm, 2 to 20 noise deviations large. A law is exact where its form is right, its power within .1 and its place within
5 % of the length; naming the effect of the catalogue that the drawn law is counts as exact. Seeds below 1000 are for
development. The kinds take turns, so a part of a series is balanced over them. Each worker has one core. A stopped run
goes on from its results (FILE.jsonl, or --results); a row holds all that was proposed, and the commit. A trial that
ends with an error counts as a miss.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

# benchmarks/vision.py must not stand for the room of that name.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from affine_model.cores import processor_seconds
from benchmarks._commit import commit_of
from discovery.diagnose import diagnose
from tentacle.diagnosis import Diagnosis
from tentacle.errors import InputError
from validation.trials.law_trial import CLASSES, IN_DISGUISE, law_recording, met

LAWS, NULLS = 60, 60
HELD_OUT_LIMIT = 1.2  # of the floor
TARGETS = {
    "exact_first": ">= .50", "exact_in_five": ">= .75", "held_out_within": ">= .80", "invented": "<= 1 of 60",
    "cpu_s": "<= 600 s on two cores",
}  # fmt: skip


def trial(asked: tuple[int, str]) -> dict[str, Any]:
    """One trial's row; with the error alone where it ends with one."""
    seed, kind = asked
    try:
        return _row(seed, kind)
    except (InputError, ArithmeticError, ValueError, RuntimeError) as error:
        return {"seed": seed, "kind": kind, "error": f"{type(error).__name__}: {error}"}


def _row(seed: int, kind: str) -> dict[str, Any]:
    recording, truth = law_recording(seed, kind)
    begin = processor_seconds(), time.perf_counter()
    found = diagnose([recording])
    cpu, wall = processor_seconds() - begin[0], time.perf_counter() - begin[1]
    near = met(truth, found.missing.laws)
    return {
        "seed": seed, "kind": kind, "commit": commit_of(Path(__file__).parent), "numbers": truth["numbers"],
        "length": truth["arm"]["length"],
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


def right(row: dict[str, Any], mark: str, first: bool) -> bool:
    """Whether the first law, or one of all, has this mark ("exact" or "form"); the law in disguise counts as both."""
    laws = row.get("laws", [])[: 1 if first else None]
    return bool(row.get("disguise")) or any(law[mark] for law in laws)


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Counts, shares with their 95 % intervals, and medians."""
    hidden, nulls = ([row for row in rows if (row["kind"] == "nothing") == bare] for bare in (False, True))
    counts = {
        "exact_first": [right(row, "exact", True) for row in hidden],
        "exact_in_five": [right(row, "exact", False) for row in hidden],
        "form_first": [right(row, "form", True) for row in hidden],
        "held_out_within": [bool(row.get("held_out_mm")) and row["held_out_mm"] <= HELD_OUT_LIMIT * row["floor_mm"]
                            for row in hidden],
        "called_unknown": [row.get("verdict") == "unknown" for row in hidden],
        "invented": [bool(row.get("laws")) for row in nulls],
        "ended_with_an_error": ["error" in row for row in rows],
    }  # fmt: skip
    found: dict[str, Any] = {}
    for name, marks in counts.items():
        if marks:
            low, high = binomtest(sum(marks), len(marks)).proportion_ci(method="wilson")
            found[name] = {"right": sum(marks), "of": len(marks), "low": float(low), "high": float(high)}
    for name in ("cpu_s", "wall_s"):
        times = [row[name] for row in hidden if name in row]
        if times:
            found[name] = float(np.median(times))
            found[f"{name}_worst"] = max(times)
    found["exact_first_by_kind"] = {
        kind: f"{sum(right(row, 'exact', True) for row in own)} of {len(own)}"
        for kind in CLASSES if (own := [row for row in hidden if row["kind"] == kind])
    }  # fmt: skip
    return found


def line_of(row: dict[str, Any]) -> str:
    """A row in a line."""
    if "error" in row:
        return f"{row['seed']:7d} {row['kind']:16s} {row['error']}"
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
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="processes, of one core each")
    parser.add_argument("--results", type=Path, metavar="FILE", help="rows; a stopped run goes on from them")
    arguments = parser.parse_args()
    results = arguments.results or arguments.json.with_suffix(".jsonl")
    rows = [json.loads(line) for line in results.read_text().splitlines()] if results.exists() else []
    done = {(row["seed"], row["kind"]) for row in rows}
    hidden = [(arguments.seed + k, arguments.only[k % len(arguments.only)]) for k in range(arguments.laws)]
    nulls = [(arguments.seed + arguments.laws + k, "nothing") for k in range(arguments.nulls)]
    for row in _rows([one for one in mixed(hidden, nulls) if one not in done], arguments.workers):
        rows.append(row)
        with results.open("a") as file:
            file.write(json.dumps(row) + "\n")
        print(line_of(row), flush=True)
    wanted = set(hidden) | set(nulls)
    figures = summary([row for row in rows if (row["seed"], row["kind"]) in wanted])
    for name, value in figures.items():
        print(f"{name:20s} {_shown(value):28s} {TARGETS.get(name, '')}")
    arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")


def _shown(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.0f}"
    if "of" in value:
        return f"{value['right']} of {value['of']} ({100 * value['low']:.0f} to {100 * value['high']:.0f} %)"
    return ", ".join(f"{kind} {share}" for kind, share in value.items())


def _rows(asked: list[tuple[int, str]], workers: int) -> Iterator[dict[str, Any]]:
    """The trials' rows as they come."""
    if workers == 1:
        yield from map(trial, asked)
        return
    context = multiprocessing.get_context("spawn")
    cores = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
    free = context.Queue()
    for k in range(workers):
        free.put(cores[k % len(cores)] if cores else None)
    with context.Pool(workers, _on_one_core, (free,)) as pool:
        yield from pool.imap_unordered(trial, asked)


def _on_one_core(free: Any) -> None:
    """Keep this worker on one core: its simulations then use one thread."""
    core = free.get()
    if core is not None:
        os.sched_setaffinity(0, {core})


def mixed(one: list[tuple[int, str]], other: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """Both in turn, so that a run that is stopped has some of each."""
    found: list[tuple[int, str]] = []
    for k in range(max(len(one), len(other))):
        found += [part[k] for part in (one, other) if k < len(part)]
    return found


if __name__ == "__main__":
    main()

"""The series of blind midlines as a table and a list of what went wrong, from the committed results of every trial.

python benchmarks/series.py [--write]

--write puts both between the marks of docs/loop_trials.md. In series before FIRST_SEED the R of arms that carry water
was wrong (docs/loop_trials.md). The confidence is stated with the present temperature. "right" counts trials of any R.
Of two effects, R is that of each by itself; where the answer is wrong, R of each beside the other is shown too
(benchmarks/beside.py).
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.readme_table import with_rows
from discovery.calibration import tempered
from validation.trials.outcome import Outcome, scored
from validation.trials.plant_design import DRAWN_PLANTS
from validation.trials.rounds import TRIAL_KINDS
from validation.trials.scores import VISIBLE, Share, counting, share

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benchmarks" / "results"
BESIDE = RESULTS / "beside.jsonl"
PAGE = ROOT / "docs" / "loop_trials.md"
MARK = "series"
FIRST_SEED = 1_200_001
KINDS = {"single": "one effect", "null": "nothing hidden", "unknown": "outside", "pair": "two effects"}


@dataclass(frozen=True)
class Series:
    """One series: its seed, the commit that made it, every trial that ended, and the kinds that were drawn.

    beside: index of a trial that hides two effects -> R of each beside the other.
    """

    seed: int
    commit: str
    outcomes: tuple[Outcome, ...]
    kinds: tuple[str, ...] = TRIAL_KINDS
    beside: Mapping[int, tuple[float, ...]] = field(default_factory=dict)


def read_beside() -> dict[tuple[int, int], list[float]]:
    """(Seed, index) -> R of each of two hidden effects beside the other; empty where none was measured."""
    lines = BESIDE.read_text(encoding="utf-8").splitlines()[1:] if BESIDE.exists() else []
    return {(row["seed"], row["index"]): row["beside"] for row in map(json.loads, lines)}


def all_series(folder: Path = RESULTS) -> list[Series]:
    """The series of midlines in the two plants that are drawn by default, the latest first."""
    found, measured = [], read_beside()
    for file in folder.glob("blind_*.jsonl"):
        seed = int(file.stem.removeprefix("blind_"))
        if seed < FIRST_SEED:
            continue
        header, *trials = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
        midlines = all(trial["seen"] == "midline" for trial in trials)
        if midlines and set(header["plants"]) == set(DRAWN_PLANTS):
            beside = {index: tuple(r) for (of, index), r in measured.items() if of == seed}
            outcomes = tuple(_outcome(trial) for trial in trials)
            kinds = tuple(header.get("kinds", TRIAL_KINDS))
            found.append(Series(seed, header["commit"], outcomes, kinds, beside))
    return sorted(found, key=lambda series: -series.seed)


def _outcome(trial: dict) -> Outcome:
    answer = {**trial["answer"], "cosines": {}}
    answer["confidence"] = tempered(answer["uncalibrated"])
    more = {"baselines": {}, "seconds": trial["seconds"]}
    return scored(trial["index"], trial["truth"], trial["seen"], answer, **more)


def counted(outcomes: Sequence[Outcome]) -> dict[str, Share]:
    """Right answers of each kind; with effects those whose R is VISIBLE or more."""
    return {kind: share(outcomes, kind, lambda o: o.hit, VISIBLE) for kind in KINDS}


def table(series: Sequence[Series]) -> Iterator[str]:
    """The lines of the table in Markdown."""
    yield f"| seed | commit | {' | '.join(KINDS.values())} | stated, right | processor time: median, worst |"
    yield "|---|---|---|---|---|---|---|---|"
    for one in series:
        seconds = [o.seconds for o in one.outcomes]
        link = f"[{one.seed}](../benchmarks/results/blind_{one.seed}.jsonl)"
        counts = " | ".join(_words(found) for found in counted(one.outcomes).values())
        times = f"{np.median(seconds):.0f}, {max(seconds):.0f} s"
        yield f"| {link} | {one.commit[:8]} | {counts} | {_stated_and_right(one.outcomes)} | {times} |"
    together = [o for one in series for o in one.outcomes]
    counts = " | ".join(f"{_words(found)} ({_interval(found)})" for found in counted(together).values())
    yield f"| together | | {counts} | {_stated_and_right(together)} | |"


def misses(series: Sequence[Series]) -> Iterator[str]:
    """A list in Markdown of the wrong answers of each kind where R is VISIBLE or more."""
    for kind, words in KINDS.items():
        lines = [
            f"- {one.seed}, {o.index}: {_hidden(o, one.beside.get(o.index, ()))}: {_answer(o)}"
            for one in series
            for o in counting(one.outcomes, kind, VISIBLE)
            if not o.hit
        ]
        if lines:
            yield from (
                f"Wrong, {words} (seed, trial: what was hidden, by which law, its R{_besides(kind)}: the answer):",
                "",
                *lines,
                "",
            )


def _besides(kind: str) -> str:
    return "; its R beside the other" if kind == "pair" else ""


def _hidden(o: Outcome, beside: Sequence[float]) -> str:
    besides = [f"; {r:.1f}" for r in beside] or [""] * len(o.hidden)
    parts = zip(o.hidden, o.r, besides, strict=True)
    return " and ".join(f"`{name}` ({o.laws[name]}, {r:.1f}{other})" for name, r, other in parts) or "nothing"


def _answer(o: Outcome) -> str:
    words = {"effect": " and ", "group": " or "}.get(o.verdict)
    named = o.verdict.replace("_", " ") if words is None else words.join(f"`{name}`" for name in o.named)
    return f"{named} ({_short(o.confidence)})"


def _stated_and_right(outcomes: Sequence[Outcome]) -> str:
    stated, right = np.mean([(o.confidence, o.hit) for o in outcomes], axis=0)
    return f"{_short(stated)}, {_short(right)}"


def _words(found: Share) -> str:
    return f"{found.hits} of {found.count}" if found.count else "-"


def _interval(found: Share) -> str:
    return " to ".join(_short(end) for end in found.interval)


def _short(value: float) -> str:
    return f"{value:.2f}".removeprefix("0")


def shown() -> str:
    """What stands between the marks of the page."""
    series = all_series()
    return "\n".join([*table(series), "", *misses(series)]).strip()


def main() -> None:
    """Print, or write into the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--write", action="store_true", help="put the table and the list into docs/loop_trials.md")
    if parser.parse_args().write:
        PAGE.write_text(with_rows(PAGE.read_text(encoding="utf-8"), shown(), MARK), encoding="utf-8")
    else:
        print(shown())


if __name__ == "__main__":
    main()

"""Statistics of a series of trials: shares with their intervals, the confusion matrix, errors against the floor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import binomtest

from tentacle.signals import Array
from validation.trials.outcome import Outcome

VISIBLE = 1.0  # noise sigmas: from this R on a single effect must be named
R_EDGES = (0.0, 1.0, 3.0, 10.0, np.inf)


@dataclass(frozen=True)
class Share:
    """hits of count, with the 95 % interval of Clopper and Pearson (1934)."""

    hits: int
    count: int

    @property
    def value(self) -> float:
        """The share; NaN of nothing."""
        return self.hits / self.count if self.count else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """Low and high end; 0 to 1 of nothing."""
        if not self.count:
            return 0.0, 1.0
        found = binomtest(self.hits, self.count).proportion_ci(0.95, method="exact")
        return float(found.low), float(found.high)


def counting(outcomes: Sequence[Outcome], kind: str, least_r: float = 0.0) -> list[Outcome]:
    """The trials of a kind whose hidden effects all have R >= least_r; all of those that hide none of the catalogue."""
    return [o for o in outcomes if o.kind == kind and (kind in ("null", "unknown") or o.smallest_r >= least_r)]


def share(outcomes: Sequence[Outcome], kind: str, right: Callable[[Outcome], bool], least_r: float = 0.0) -> Share:
    """Of these trials of a kind: how many are right."""
    chosen = [right(o) for o in counting(outcomes, kind, least_r)]
    return Share(sum(chosen), len(chosen))


@dataclass(frozen=True)
class Scores:
    """The shares. top1, exact: of singles with R >= 1; false_alarm: of nulls; unknown_recall; pairs:
    with R >= 1 each; needless_groups: of all trials. after_over_floor: median over trials that named what was hidden,
    NaN without any; by_r: (low, high, share of singles) over R_EDGES; by_seen, by_plant: shares of all
    kinds; seconds: median of a diagnosis."""

    top1: Share
    exact: Share
    false_alarm: Share
    unknown_recall: Share
    pairs: Share
    needless_groups: Share
    after_over_floor: float
    by_r: tuple[tuple[float, float, Share], ...]
    by_seen: tuple[tuple[str, Share], ...]
    by_plant: tuple[tuple[str, Share], ...]
    seconds: float


def scores(outcomes: Sequence[Outcome]) -> Scores:
    """The shares over a series of trials."""
    ratios = [o.after / o.floor for o in outcomes if o.kind in ("single", "pair") and o.hit and o.floor > 0.0]
    by_r = []
    for low, high in pairwise(R_EDGES):
        within = [o.hit for o in outcomes if o.kind == "single" and low <= o.smallest_r < high]
        by_r.append((low, high, Share(sum(within), len(within))))
    return Scores(
        top1=share(outcomes, "single", lambda o: o.hit, VISIBLE),
        exact=share(outcomes, "single", lambda o: o.exact, VISIBLE),
        false_alarm=share(outcomes, "null", lambda o: not o.hit),
        unknown_recall=share(outcomes, "unknown", lambda o: o.hit),
        pairs=share(outcomes, "pair", lambda o: o.hit, VISIBLE),
        needless_groups=Share(sum(o.needless_group for o in outcomes), len(outcomes)),
        after_over_floor=float(np.nanmedian(ratios)) if ratios else float("nan"),
        by_r=tuple(by_r),
        by_seen=_right_by(outcomes, lambda o: o.seen),
        by_plant=_right_by(outcomes, lambda o: o.plant),
        seconds=float(np.median([o.seconds for o in outcomes])) if outcomes else float("nan"),
    )


def _right_by(outcomes: Sequence[Outcome], group: Callable[[Outcome], str]) -> tuple[tuple[str, Share], ...]:
    """Each group's name and its share of right answers, of all kinds."""
    found = []
    for name in sorted({group(o) for o in outcomes}):
        right = [o.hit for o in outcomes if group(o) == name]
        found.append((name, Share(sum(right), len(right))))
    return tuple(found)


def confusion(outcomes: Sequence[Outcome]) -> tuple[tuple[str, ...], tuple[str, ...], Array]:
    """Counts (rows, columns) of singles, nulls and unknowns: rows the truth, columns the answer, a group that holds
    the truth counted as the truth. All unnamed effects share the row "unknown"."""
    rows = [(_row(o), o.answer) for o in outcomes if o.kind != "pair"]
    last = ("unknown", "nothing")
    names = sorted({name for row in rows for name in row} - set(last))
    truths = tuple(name for name in (*names, *last) if any(row[0] == name for row in rows))
    answers = tuple(names) + last
    counts = np.zeros((len(truths), len(answers)))
    for truth, answer in rows:
        counts[truths.index(truth), answers.index(answer)] += 1
    return truths, answers, counts


def _row(o: Outcome) -> str:
    if o.kind == "single":
        return o.hidden[0]
    return "unknown" if o.kind == "unknown" else "nothing"


def baseline_hit(o: Outcome, method: str) -> bool:
    """Whether a method that names at most one effect named a hidden one, or none on a null. It cannot answer
    unknown.
    """
    named = o.baselines.get(method, ())
    if o.kind in ("null", "unknown"):
        return not named
    return bool(named) and named[0] in o.hidden

"""The figures of a series of blind trials, and its results as plain data."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from validation.trials.outcome import Outcome
from validation.trials.reliability import (
    calibration_gap,
    cross_calibrated,
    gap_by_chance,
    reliability,
)
from validation.trials.scores import VISIBLE, Share, baseline_hit, scores, share

BASELINE_METHODS = (
    ("regression", "the paper's regression (eq. 18-19), best column"),
    ("weak_form", "weak form of the same columns, best column"),
    ("pysindy", "PySINDy (STLSQ) over all columns of the weak form"),
    ("score_test", "trajectory score test alone, its first"),
)


INTERVALS = ("top1", "false_alarm", "unknown_recall", "pairs")  # shares that are stated with their 95 % interval
MANY_IN_A_BIN = 60  # trials, of which a share of .9 has a standard error of .04


def figures(outcomes: Sequence[Outcome]) -> dict[str, float | None]:
    """The benchmark's figures; None for those without a trial."""
    found, bins = scores(outcomes), reliability(outcomes)
    values = {
        "top1": found.top1.value,
        "exact": found.exact.value,
        "false_alarm": found.false_alarm.value,
        "unknown_recall": found.unknown_recall.value,
        "pairs": found.pairs.value,
        "needless_groups": found.needless_groups.value,
        "calibration_gap": calibration_gap(bins),
        "calibration_gap_60": calibration_gap([b for b in bins if b.right.count >= MANY_IN_A_BIN]),
        "calibration_gap_beyond_chance": max((b.gap_beyond_chance for b in bins), default=float("nan")),
        "calibration_gap_by_chance": gap_by_chance(outcomes),
        "calibration_gap_cross": calibration_gap(reliability(cross_calibrated(outcomes))),
        "after_over_floor": found.after_over_floor,
        "trials": float(len(outcomes)),
        **{
            f"{name}_{end}": value
            for name in INTERVALS
            for end, value in zip(("low", "high"), _interval(getattr(found, name)), strict=True)
        },
        **_by_plant(outcomes),
        **{f"{method}_top1": _top1(outcomes, method) for method, _ in BASELINE_METHODS},
    }
    return {name: value if value == value else None for name, value in values.items()}


def _by_plant(outcomes: Sequence[Outcome]) -> dict[str, float]:
    """top1 and false_alarm of every plant."""
    values = {}
    for plant in sorted({o.plant for o in outcomes}):
        found = scores([o for o in outcomes if o.plant == plant])
        values |= {f"top1_{plant}": found.top1.value, f"false_alarm_{plant}": found.false_alarm.value}
    return values


def _interval(found: Share) -> tuple[float, float]:
    """The 95 % interval of a share; NaN without a trial."""
    return found.interval if found.value == found.value else (float("nan"), float("nan"))


def _top1(outcomes: Sequence[Outcome], method: str) -> float:
    """The share of a baseline; NaN if it was not run."""
    return share([o for o in outcomes if method in o.baselines], "single", hits(method), VISIBLE).value


def hits(method: str) -> Callable[[Outcome], bool]:
    """Whether a baseline was right, as a function of the trial."""
    return lambda o: baseline_hit(o, method)


def results(outcomes: Sequence[Outcome], refused: Sequence[tuple[int, str]]) -> dict[str, Any]:
    """results.json: the figures, every trial's truth beside its answer, and the trials that could not be run."""
    trials = [
        {
            "trial": o.index, "kind": o.kind, "hidden": list(o.hidden), "r": [_plain(value) for value in o.r],
            "seen": o.seen, "plant": o.plant, "laws": o.laws, "declared_added_mass": o.added_mass,
            "verdict": o.verdict, "named": list(o.named), "confidence": o.confidence,
            "uncalibrated": o.uncalibrated,
            "right": o.hit, "before_mm": _plain(o.before), "after_mm": _plain(o.after), "floor_mm": _plain(o.floor),
            "baselines": {method: list(names) for method, names in o.baselines.items()},
        }
        for o in outcomes
    ]  # fmt: skip
    not_run = [{"trial": k, "why": why} for k, why in refused]
    return {"figures": figures(outcomes), "trials": trials, "refused": not_run}


def _plain(value: float) -> float | None:
    return value if value == value else None

"""Spearman's rank correlation of two series."""

from __future__ import annotations

from scipy.stats import spearmanr

from tentacle.signals import Array


def rank_correlation(a: Array, b: Array) -> float:
    """-1 to 1, for a (N,) and b (N,): 1 if both have the same order."""
    return float(spearmanr(a, b).statistic)  # type: ignore[attr-defined]

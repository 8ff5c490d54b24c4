"""A diagnosis as plain data for a library's index: verdict, errors, every fitted parameter, a small residual map."""

from __future__ import annotations

from typing import Any

import numpy as np

from tentacle.diagnosis import Diagnosis
from tentacle.signals import Array

MAP_PLACES, MAP_TIMES = 16, 60  # of the residual map: what a thumbnail shows


def layer_of(diagnosis: Diagnosis, content: str, code: str) -> dict[str, Any]:
    """The layer's data. content, code: hashes of the recording and of the code."""
    parameters = [
        {"effect": effect, "parameter": name, "value": e.value, "low": e.low, "high": e.high, "unit": e.unit}
        for effect, values in diagnosis.augmented_model.parameters.items()
        for name, e in values.items()
    ]
    return {
        "sha256": content,
        "code": code,
        "verdict": diagnosis.verdict,
        "effects": " ".join(diagnosis.effects) if diagnosis.verdict in ("effect", "group") else "",
        "confidence": diagnosis.confidence,
        "before_mm": diagnosis.before.midline_mm,
        "after_mm": diagnosis.after.midline_mm,
        "floor_mm": diagnosis.floor.midline_mm,
        "held_out": diagnosis.held_out,
        "failed": None,
        "parameters": parameters,
        "residual_mm": residual_map(diagnosis),
    }


def failed_layer(words: str, content: str, code: str) -> dict[str, Any]:
    """The layer of a recording that could not be diagnosed, and why."""
    return {"sha256": content, "code": code, "failed": words, "parameters": []}


def residual_map(diagnosis: Diagnosis) -> list[list[float | None]]:
    """Distance of the augmented model to the measured points [mm], places by times; None where nothing was seen."""
    if not diagnosis.runs:
        return []
    run = diagnosis.runs[0]
    away = 1e3 * np.linalg.norm(run.augmented - run.measured, axis=2)
    order = np.argsort(run.s, kind="stable")
    small = _coarse(_coarse(away[:, order], MAP_TIMES).T, MAP_PLACES)
    return [[None if np.isnan(value) else round(float(value), 4) for value in row] for row in small]


def _coarse(values: Array, rows: int) -> Array:
    """Means over about equal groups of rows, what is NaN left out."""
    groups = np.array_split(values, min(rows, len(values)))
    return np.array([_mean(group) for group in groups])


def _mean(group: Array) -> Array:
    seen = np.isfinite(group)
    count = seen.sum(axis=0)
    total = np.where(seen, group, 0.0).sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)

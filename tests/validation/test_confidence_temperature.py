"""The confidence's one temperature is what the committed series say."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from discovery.calibration import CONFIDENCE_TEMPERATURE, tempered
from validation.trials.outcome import Outcome, scored
from validation.trials.reliability import fit_temperature, temperature_cost

RESULTS = Path(__file__).parents[2] / "benchmarks" / "results"


def series(seed: int) -> list[Outcome]:
    found = []
    for index, line in enumerate((RESULTS / f"blind_{seed}.jsonl").read_text().splitlines()):
        row = json.loads(line)
        if "answer" in row:
            answer = {**row["answer"], "cosines": {}}
            found.append(scored(index, row["truth"], "midline", answer, baselines={}, seconds=row["seconds"]))
    return found


FITTED, TESTED = (1200001, 1400001, 1700001), 1800001


def test_the_temperature_is_the_likeliest_over_three_series() -> None:
    trials = [one for seed in FITTED for one in series(seed)]
    best = fit_temperature(trials)
    assert best is not None
    # Half a nat: within one standard error of the likeliest.
    assert temperature_cost(trials, CONFIDENCE_TEMPERATURE) < temperature_cost(trials, best) + 0.5
    # The posterior mass itself loses far more, in each series by itself too.
    for seed in FITTED:
        assert temperature_cost(series(seed), CONFIDENCE_TEMPERATURE) < temperature_cost(series(seed), 1.0) - 5.0


def test_a_series_that_it_was_not_fitted_to_is_right_as_often_as_stated() -> None:
    """In each bin that holds 60 trials or more: a share of .9 of 60 has a standard error of .04."""
    trials = series(TESTED)
    stated, right = (np.array([f(o) for o in trials]) for f in (lambda o: tempered(o.uncalibrated), lambda o: o.hit))
    bins = [(stated >= low) & (stated < high) for low, high in ((0.0, 0.7), (0.7, 0.9), (0.9, 0.95), (0.95, 1.0))]
    gaps = [abs(stated[one].mean() - right[one].mean()) for one in bins if one.sum() >= 60]
    assert len(gaps) == 3
    assert max(gaps) < 0.05


def test_a_tempered_mass_keeps_order_and_an_even_chance() -> None:
    masses = np.linspace(0.01, 0.99, 50)
    stated = np.array([tempered(mass) for mass in masses])
    assert np.all(np.diff(stated) > 0.0)
    assert tempered(0.5) == pytest.approx(0.5)
    assert tempered(1.0) == 0.98
    assert tempered(np.nextafter(1.0, 2.0)) == 0.98  # a sum of masses, rounded upwards


def test_the_temperature_of_made_outcomes_is_found() -> None:
    """Answers that are right as often as their mass, tempered by 2, says; 3000 of them: some per cent of error."""
    random = np.random.default_rng(3)
    made = []
    for index in range(3000):
        mass = float(random.uniform(0.5, 0.999))
        right = random.uniform() < tempered(mass, 2.0)
        truth = {"kind": "null", "effects": {}, "r": []}
        answer = {
            "verdict": "nothing_missing" if right else "unknown", "effects": [], "confidence": mass,
            "uncalibrated": mass, "cosines": {}, "midline_mm": {"before": None, "after": None, "floor": None},
        }  # fmt: skip
        made.append(scored(index, truth, "midline", answer, baselines={}, seconds=1.0))
    assert fit_temperature(made) == pytest.approx(2.0, rel=0.1)

"""The reports of verbs whose computation takes long, made from results that are made up: whole, valid, legible.

Those of the other verbs are held to the same where the documentation's commands make them (tests/docs).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from tentacle.cli import main
from tentacle.cli.pages.blind_trials import blind_trials_page
from tentacle.runner import Runner
from tests.page import problems
from tests.validation.test_trials_report import outcomes
from viz.report import Origin


def made_up(runner: Runner, work, tasks: Sequence[Mapping], **__) -> list[dict]:
    """What the runs would give, growing with frequency as theirs does."""
    runner.folder.mkdir(parents=True, exist_ok=True)
    chance = np.random.default_rng(0)
    names = ("q1_rad2", "q2_rad2", "midline_mm", "paper_q1_rad2", "paper_q2_rad2", "motion_q1_rad2", "motion_q2_rad2",
             "E_pa", "reduction_mm", "accepted", "paper_k0", "paper_k1")  # fmt: skip
    found = []
    for task in tasks:
        if work.__module__.endswith("table1_arm"):
            found.append({name: float(chance.uniform(0.1, 1.0)) for name in names})
        elif work.__module__.endswith("paper_fig9"):
            thrust = task["amplitude"] * task["frequency"] ** 2 * 1e-2
            found.append({"reference": thrust, "affine": thrust * chance.uniform(0.97, 1.03)})
        else:
            error = 1e-3 * task["frequency"] ** 3 * (1 + task["amplitude"])
            thrust = [None if task["amplitude"] < 0.1 else 2 * error / k for k in (1, 2, 4)]
            found.append({"shape": [error, error / 3, error / 9], "thrust": thrust, "thrust_n": -1e-3})
    return found


@pytest.mark.parametrize("result", ["fig9", "table1"])
def test_a_result_of_the_paper(result: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Runner, "run", made_up)
    assert main(["reproduce", result, "--out", str(tmp_path / result)]) in (0, None)
    assert problems((tmp_path / result / "report.html").read_text()) == []


def test_a_series_of_blind_trials() -> None:
    origin = Origin("tentacle blind-trial 60 --seed 0", 0)
    assert problems(blind_trials_page(outcomes(), [(61, "the simulation went out of bounds")], origin)) == []

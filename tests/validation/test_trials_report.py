"""The blind trials' report and results from made-up outcomes, and the verb's answers to bad input."""

import json

import numpy as np
import pytest

from tentacle.cli import main
from tentacle.cli.pages.blind_trials import blind_trials_page
from validation.trials.figures import figures, results
from validation.trials.outcome import Outcome
from viz.report import Origin

NAMES = ("wall", "current", "added_mass", "gravity_tilt", "dry_friction")


def outcomes(count=60):
    random = np.random.default_rng(0)
    found = []
    for k in range(count):
        kind = ("single", "null", "single", "pair", "unknown")[k % 5]
        hidden = {"single": (NAMES[k % 4],), "pair": NAMES[:2], "null": (), "unknown": ("magnet",)}[kind]
        right = bool(random.uniform() < 0.85)
        named = hidden if kind in ("single", "pair") else ()
        verdict = {"null": "nothing_missing", "unknown": "unknown"}.get(kind, "effect")
        if not right:
            named, verdict = ("dry_friction",), "effect"
        r = (float("nan"),) if kind == "unknown" else tuple(random.uniform(0.3, 10.0, len(hidden)))
        sure = float(random.uniform(0.5, 0.98))
        before = float(random.uniform(0.2, 3.0))
        baselines = {"regression": ("added_mass",), "weak_form": hidden[:1], "score_test": named[:1]}
        found.append(
            Outcome(k, kind, hidden, r, ("midline", "video")[k % 7 == 0], verdict, named, sure, sure, 0.5, before,
                    0.11 if right else before, 0.1, baselines, 4.0)
        )  # fmt: skip
    return found


def test_the_page_is_whole_and_the_same_twice():
    origin = Origin("tentacle blind-trial 60 --seed 0", 0)
    text = blind_trials_page(outcomes(), [(61, "the simulation went out of bounds")], origin)
    assert text == blind_trials_page(outcomes(), [(61, "the simulation went out of bounds")], origin)
    for heading in ("Scores", "Confusion matrix", "Is the stated confidence true?", "Other methods", "out of bounds"):
        assert heading in text
    assert "nan" not in text.lower().replace("covenant", "").split("<svg", 1)[0]
    assert "http://www.w3.org" in text  # the SVGs' own namespace; nothing is loaded
    assert "<script src" not in text


def test_results_are_strict_json_and_hold_every_trial():
    found = json.loads(json.dumps(results(outcomes(), []), allow_nan=False))
    assert len(found["trials"]) == 60
    assert found["figures"]["trials"] == 60
    assert 0.0 <= found["figures"]["false_alarm"] <= 1.0
    # The weak form was made to be right on every single; the regression only where added mass was hidden.
    assert found["figures"]["weak_form_top1"] == 1.0
    assert found["figures"]["regression_top1"] < 0.5


def test_figures_of_nothing_say_that_no_trial_tells():
    assert all(
        value is None for name, value in figures([]).items() if name not in ("trials", "calibration_gap_beyond_chance")
    )
    blind_trials_page([], [], Origin("tentacle blind-trial 1"))


@pytest.mark.parametrize(
    ("arguments", "named"),
    [(["0"], "N"), (["3", "--kinds", "triple"], "kinds"), (["3", "--video-share", "2"], "video share"),
     (["3", "--workers", "0"], "--workers"), (["3", "--only", "7"], "--only")],
)  # fmt: skip
def test_bad_arguments_are_one_line_and_exit_2(tmp_path, capsys, arguments, named):
    assert main(["blind-trial", *arguments, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err.strip()
    assert named in error
    assert "\n" not in error
    assert not (tmp_path / "out").exists()

"""Scores of blind trials: made-up outcomes whose shares, errors and calibration are known."""

import math

import numpy as np
import pytest

from discovery.calibration import read_calibration
from tentacle.errors import InputError
from validation.trials.outcome import Outcome, scored
from validation.trials.reliability import (
    calibration_gap,
    cross_calibrated,
    fit_calibration,
    gap_by_chance,
    reliability,
)
from validation.trials.scores import Share, baseline_hit, confusion, scores


def made(index=0, kind="single", hidden=("buoyancy",), named=("buoyancy",), verdict="effect", **more):
    values = {
        "r": (2.0,) * len(hidden), "seen": "midline", "confidence": 0.9, "uncalibrated": 0.9, "twins": 1.0,
        "before": 2.0, "after": 0.11, "floor": 0.1, "baselines": {}, "seconds": 5.0, **more,
    }  # fmt: skip
    return Outcome(index=index, kind=kind, hidden=hidden, verdict=verdict, named=named, **values)


def test_what_counts_as_right():
    assert made().hit
    assert made(named=("buoyancy", "current")).hit  # named first, with one too many
    assert not made(named=("buoyancy", "current")).exact
    assert not made(named=("current", "buoyancy")).hit
    assert made(named=("current", "buoyancy"), verdict="group").hit
    assert not made(named=(), verdict="unknown").hit
    assert made(kind="null", hidden=(), named=(), verdict="nothing_missing").hit
    assert not made(kind="null", hidden=(), named=(), verdict="unknown").hit
    assert made(kind="unknown", hidden=("magnet",), named=(), verdict="unknown").hit
    assert not made(kind="unknown", hidden=("magnet",), named=(), verdict="nothing_missing").hit
    both = ("wall", "current")
    assert made(kind="pair", hidden=both, named=("current", "wall")).hit
    assert not made(kind="pair", hidden=both, named=("current",)).hit


def test_third_curvature_is_neither_right_nor_wrong():
    measures = {"before": 1.0, "after": 0.2, "floor": None}
    answer = {
        "verdict": "effect", "effects": ["third_curvature"], "confidence": 0.9, "uncalibrated": 0.9, 
        "midline_mm": measures, "cosines": {},
    }  # fmt: skip
    null = scored(0, {"kind": "null", "effects": {}, "r": []}, "midline", answer, baselines={}, seconds=1.0)
    assert null.hit
    assert null.answer == "nothing"
    assert math.isnan(null.floor)
    answer["effects"] = ["wall", "third_curvature"]
    single = scored(
        1, {"kind": "single", "effects": {"wall": {}}, "r": [2.0]}, "video", answer, baselines={}, seconds=1.0
    )
    assert single.hit
    assert single.exact


def test_a_group_is_needless_where_the_effects_are_no_twins():
    measures = {"before": 1.0, "after": 0.2, "floor": 0.2}
    truth = {"kind": "single", "effects": {"wall": {}}, "r": [2.0]}
    for cosine, needless in ((0.97, False), (0.6, True)):
        answer = {
            "verdict": "group", "effects": ["wall", "current"], "confidence": 0.9, "uncalibrated": 0.9,
            "midline_mm": measures, "cosines": {"current|wall": cosine},
        }  # fmt: skip
        assert scored(0, truth, "midline", answer, baselines={}, seconds=1.0).needless_group is needless


def test_shares_count_the_right_trials():
    trials = [made(k, named=("buoyancy",) if k < 19 else ("wall",)) for k in range(20)]
    trials.append(made(20, named=("wall",), r=(0.5,)))  # too faint to count for top1
    trials += [made(k, kind="null", hidden=(), named=(), verdict="nothing_missing") for k in range(30)]
    trials.append(made(51, kind="null", hidden=(), named=("wall",)))
    found = scores(trials)
    assert (found.top1.hits, found.top1.count) == (19, 20)
    assert (found.false_alarm.hits, found.false_alarm.count) == (1, 31)
    assert found.after_over_floor == pytest.approx(1.1)
    assert [part.count for _, _, part in found.by_r] == [1, 20, 0, 0]
    assert math.isnan(found.pairs.value)


def test_share_intervals_are_clopper_and_pearson_s():
    # 0 of n: 1 - (alpha / 2)^(1/n), and its mirror image.
    assert Share(0, 20).interval == pytest.approx((0.0, 1.0 - 0.025 ** (1 / 20)), abs=1e-12)
    assert Share(20, 20).interval == pytest.approx((0.025 ** (1 / 20), 1.0), abs=1e-12)
    # Tables of the binomial: 19 of 20.
    assert Share(19, 20).interval == pytest.approx((0.7513, 0.9987), abs=1e-4)


def test_confusion_matrix_counts_every_trial_but_pairs_once():
    trials = [
        made(), made(1, named=("wall",)), made(2, named=(), verdict="unknown"), made(3, kind="pair", hidden=("a", "b")),
        made(4, kind="null", hidden=(), named=(), verdict="nothing_missing"),
        made(5, kind="unknown", hidden=("magnet",)),
    ]  # fmt: skip
    truths, answers, counts = confusion(trials)
    assert truths == ("buoyancy", "unknown", "nothing")
    assert answers == ("buoyancy", "wall", "unknown", "nothing")
    np.testing.assert_array_equal(counts, [[1, 1, 1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])


def test_baselines_are_scored_by_what_they_can_say():
    named = {"regression": ("wall",), "weak_form": ()}
    assert baseline_hit(made(hidden=("wall",), baselines=named), "regression")
    assert not baseline_hit(made(hidden=("wall",), baselines=named), "weak_form")
    assert baseline_hit(made(kind="null", hidden=(), baselines=named), "weak_form")


def test_a_true_confidence_is_off_by_luck_alone():
    """100 trials that state .9 are right 90 +- 3 times: the middle of |gap| is .674 standard deviations, .020."""
    trials = [made(k, confidence=0.9) for k in range(100)]
    assert gap_by_chance(trials) == pytest.approx(0.674 * 0.03, abs=0.007)  # the share moves in steps of .01
    assert gap_by_chance(trials[:4]) > gap_by_chance(trials)
    assert np.isnan(gap_by_chance([]))


def drawn(count, power, seed):
    """Trials that state x and are right with probability x^power."""
    random = np.random.default_rng(seed)
    stated = random.uniform(0.3, 1.0, count)
    right = random.uniform(size=count) < stated**power
    return [
        made(k, named=("buoyancy",) if good else ("wall",), confidence=float(x), uncalibrated=float(x))
        for k, (x, good) in enumerate(zip(stated, right, strict=True))
    ]


def test_calibration_finds_the_hit_rate():
    calibration = fit_calibration(drawn(4000, 3.0, 0))
    for stated in (0.5, 0.7, 0.9):
        # 4000 trials over 0.7: some 200 within 0.035 of a point; their share scatters by 0.035 at most.
        assert calibration("effect", stated) == pytest.approx(stated**3, abs=0.07)
    assert calibration("group", 0.4) == 0.4  # no trial, no change
    # Applied to fresh trials, the reliability curve lies on the line: bins of 200 or more scatter by 3.5 points.
    fresh = [
        made(k, named=o.named, confidence=calibration("effect", o.uncalibrated))
        for k, o in enumerate(drawn(4000, 3.0, 1))
    ]
    assert calibration_gap([b for b in reliability(fresh) if b.right.count >= 200]) < 0.08
    assert calibration_gap(reliability(drawn(4000, 3.0, 1))) > 0.2


def test_each_half_is_calibrated_by_the_other():
    """Verdicts that state .9 and are right in one half only: each half is told of the other's luck."""
    trials = [
        made(k, uncalibrated=0.9, named=("current",) if k // 16 % 2 else ("wall",), hidden=("current",))
        for k in range(400)
    ]
    assert [o.hit for o in trials[::16]][:4] == [False, True, False, True]
    crossed = cross_calibrated(trials)
    assert all(o.confidence > 0.9 for o in crossed if not o.hit)
    assert all(o.confidence < 0.1 for o in crossed if o.hit)


def test_few_trials_move_the_map_little_and_it_only_rises():
    calibration = fit_calibration([made(uncalibrated=0.9, named=("wall",))])
    found = [calibration("effect", x) for x in np.linspace(0.0, 1.0, 101)]
    assert np.all(np.diff(found) >= 0)
    assert 0.2 < calibration("effect", 0.9) < 0.9  # one miss among the imagined trials


def test_a_few_imagined_trials_stand_where_no_trial_was():
    """Four imagined trials, right as often as they state, over 0, .9 and 1; and ten at .9, five of them right."""
    trials = [
        made(k, uncalibrated=0.9, named=("wall",) if k % 2 else ("current",), hidden=("wall",)) for k in range(10)
    ]
    found = fit_calibration(trials)
    expected = (5.0 + 0.9 * 4.0 / 3.0) / (10.0 + 4.0 / 3.0)
    assert found("effect", 0.9) == pytest.approx(expected, abs=5e-5)  # a file's digits
    assert found("group", 0.8) == 0.8
    assert "10 blind trials" in found.words("effect", 0.9)
    assert "uncalibrated" in found.words("unknown", 0.9)


def test_calibration_survives_its_file(tmp_path):
    calibration = fit_calibration(drawn(50, 2.0, 2), made='tentacle blind-trial 50 --like "a b"')
    file = tmp_path / "calibration.toml"
    file.write_text(calibration.toml())
    assert read_calibration(file) == calibration


GOOD = 'made = "x"\n[effect]\ntrials = 3\nstated = [0.0, 0.5, 1.0]\nright = [0.1, 0.4, 0.9]\n'


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (GOOD.replace("made", "mode"), "made"),
        (GOOD.replace("[effect]", "[effects]"), "effects"),
        (GOOD.replace("trials = 3", "trials = -3"), "effect.trials"),
        (GOOD.replace("0.0, 0.5", "0.5, 0.5"), "effect.stated"),
        (GOOD.replace("0.5, 1.0", "0.5, 1.5"), "effect.stated"),
        (GOOD.replace("0.1, 0.4", "0.4, 0.1"), "effect.right"),
        (GOOD.replace("0.1, ", ""), "effect.right"),
        (GOOD.replace("0.9]", "nan]"), "effect.right"),
    ],
)
def test_a_file_that_is_no_calibration_is_one_line(tmp_path, wrong, named):
    file = tmp_path / "calibration.toml"
    file.write_text(GOOD)
    assert read_calibration(file)("effect", 0.75) == pytest.approx(0.65)
    file.write_text(wrong)
    with pytest.raises(InputError) as refused:
        read_calibration(file)
    assert named in refused.value.line()
    assert "calibration.toml" in refused.value.line()
    assert "\n" not in refused.value.line()

"""The drift sentinel: what it finds, how seldom it is wrong without a drift, and what it says that it would find."""

from __future__ import annotations

import numpy as np
import pytest

from rig.sentinel import LEVEL, NAMES, ReferenceRuns, sentinel_numbers
from tentacle.errors import InputError
from tentacle.recording import Declaration, LoadCellSignal, MotorSignal, Recording, ShapeTrack
from tentacle.signals import Array
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Sine

MOTION = Sine(0.3, 1.0)
COUNT, COMPARISONS = 6, 5  # of a campaign with the settings that it has by itself
TRUE = np.array([0.01, 0.5, 0.4, 0.02])  # mean heading [rad], swing [rad], lag [rad], swing of the thrust [N]
SPREAD = np.array([5e-4, 1e-3, 2e-3, 1e-4])  # of one run, between repeats


def reference(seed: int, swing: float = 0.5, lag: float = 0.4, mean: float = 0.0, late: float = 0.0) -> Recording:
    """Twelve seconds of a tip that follows a sine of 1 Hz, seen with 0.003 rad of noise; late [s]: the camera."""
    random = np.random.default_rng(seed)
    t, cell = np.arange(0, 12, 1 / 30), np.arange(0, 12, 0.0107)
    seen, noise = t - late, 0.003 * random.normal(size=(2, t.size))
    tip = mean + swing * np.sin(2 * np.pi * seen - lag) + noise[0]
    offset = MOTION(seen)[0] - MOTION(t)[0] + noise[1]
    shape = ShapeTrack(
        t, np.column_stack([offset, tip]), np.zeros((t.size, 2, 2)), np.ones(t.size, dtype=bool),
        ("",) * t.size, 1.0, 0.0, np.zeros(2),
    )  # fmt: skip
    thrust = 0.02 * np.sin(4 * np.pi * cell) + 3e-4 * random.normal(size=cell.size)
    declaration = Declaration(Specimen(Cone(0.0125, 0.001), 0.14, 1070.0), WATER)
    turn = MOTION(cell)[0]
    motor = MotorSignal(cell, turn, turn)
    return Recording("reference", declaration, motor=motor, load_cell=LoadCellSignal(cell, thrust), shape=shape)


@pytest.fixture(scope="module")
def repeats() -> ReferenceRuns:
    return ReferenceRuns(np.array([sentinel_numbers(reference(seed), MOTION) for seed in range(COUNT)]), COMPARISONS)


@pytest.mark.parametrize(
    ("moved", "name"),
    [
        ({"swing": 0.47}, "the tip's swing"),
        ({"lag": 0.45}, "the tip's lag"),
        ({"mean": 0.02}, "the tip's mean heading"),
    ],
)
def test_the_sentinel_names_what_changed(moved: dict[str, float], name: str, repeats: ReferenceRuns) -> None:
    found = repeats.changes(sentinel_numbers(reference(99, **moved), MOTION), "reference-0000")
    assert [change.name for change in found] == [name]
    value = moved.get("swing", 0.5) / 0.5 - 1 or moved.get("lag", 0.4) - 0.4 or moved.get("mean", 0.0) / 0.5
    assert abs(found[0].change - value) < found[0].half_width
    assert found[0].words.startswith(f"{name} changed by")


def test_an_error_of_the_cameras_clock_is_no_drift(repeats: ReferenceRuns) -> None:
    """5 ms are 31 mrad of phase, of the tip and of the base alike."""
    numbers = sentinel_numbers(reference(99, late=5e-3), MOTION)
    assert not repeats.changes(numbers, "")
    assert numbers[2] == pytest.approx(0.4, abs=3e-3)  # 0.003 rad in 270 frames, over the swings of 0.5 and 0.3 rad


def campaigns(count: int, seed: int, moved: Array) -> Array:
    """Whether each of so many campaigns is told of a drift, where every later run is moved so far (4,)."""
    random = np.random.default_rng(seed)
    told = []
    for _ in range(count):
        first = ReferenceRuns(TRUE + SPREAD * random.normal(size=(COUNT, 4)), COMPARISONS)
        later = TRUE + moved + SPREAD * random.normal(size=(COMPARISONS, 4))
        told.append(any(first.changes(numbers, "") for numbers in later))
    return np.array(told)


def test_a_campaign_without_drift_is_told_of_one_as_seldom_as_stated() -> None:
    """The scatter is estimated from six runs each time. Comparisons share those six, so that alarms come together and
    Bonferroni's bound is not reached: at most LEVEL. 4000 campaigns: three standard deviations are 0.0047.
    """
    share = campaigns(4000, 1, np.zeros(4)).mean()
    assert 0.3 * LEVEL < share < LEVEL + 0.0047


@pytest.mark.parametrize("number", range(4))
def test_the_drift_that_it_says_it_finds_is_found(number: int) -> None:
    """found_by(0.9) of the true scatter: one comparison finds it in 90 % of 1000 campaigns (3 standard deviations: 2.8
    %). Where six runs show the scatter by chance too small or too large, the stated drift is so too, and on average.
    """
    random, hits, stated = np.random.default_rng(2), 0, []
    exact = np.zeros((COUNT, 4))
    exact[: COUNT // 2], exact[COUNT // 2 :] = 1.0, -1.0
    exact *= np.sqrt((COUNT - 1) / COUNT)  # standard deviation 1, mean 0
    drift = ReferenceRuns(TRUE + SPREAD * exact, COMPARISONS)
    moved = drift.found_by(0.9)[number] * drift.scale[number]
    for _ in range(1000):
        first = ReferenceRuns(TRUE + SPREAD * random.normal(size=(COUNT, 4)), COMPARISONS)
        later = TRUE + SPREAD * random.normal(size=4)
        later[number] += moved
        hits += NAMES[number] in {change.name for change in first.changes(later, "")}
        stated.append(first.found_by(0.9)[number] * first.scale[number] if len(stated) < 50 else np.nan)
    assert hits / 1000 == pytest.approx(0.9, abs=0.028)
    # The mean of s is 0.95 sigma for six runs, its standard deviation 0.3 sigma: over 50 campaigns 0.044.
    assert np.nanmean(stated) / moved == pytest.approx(0.95, abs=0.13)


def test_a_reference_of_too_few_periods_is_refused() -> None:
    with pytest.raises(InputError, match="whole periods"):
        sentinel_numbers(reference(1), Sine(0.3, 0.3))

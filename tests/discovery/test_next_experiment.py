"""The next experiment settles what one run cannot: a lag of the servo and a clock's offset are the same on one sine."""

import pytest

from discovery.diagnose import diagnose
from discovery.next_experiment import DURATION
from tentacle.io.waveform_file import waveform_from_table
from tentacle.waveform import Ramped, Sine


@pytest.mark.long
def test_the_proposed_motion_splits_a_lag_from_an_offset(recorded):
    hidden = {("servo_lag", "tau"): 0.012}
    sine = recorded(hidden, wave=Ramped(Sine(0.3, 1.1), 2.0), noise=1e-3)
    first = diagnose([sine])
    assert first.verdict == "group"
    assert {"servo_lag", "time_offset"} <= set(first.effects)
    place = [first.twin_names.index(name) for name in ("servo_lag", "time_offset")]
    assert abs(first.twin_cosines[place[0], place[1]]) > 0.99  # twins on one sine
    assert first.next_experiment is not None

    proposed = waveform_from_table(first.next_experiment)
    second = recorded(hidden, wave=proposed, noise=1e-3, seconds=DURATION, seed=1)
    both = diagnose([sine, second])
    assert both.verdict == "effect"
    assert both.effects == ("servo_lag",)
    estimate = both.parameters["servo_lag"]["tau"]
    sigma = (estimate.high - estimate.low) / (2 * 1.96)
    assert abs(estimate.value - 0.012) < 4.0 * sigma  # one noise in 16 000 is further off
    assert estimate.high - estimate.low < 0.002

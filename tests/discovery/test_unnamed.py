"""The rest without a name: found where it is, absent where nothing is missing, and no name for it."""

from discovery.diagnose import diagnose
from discovery.unnamed import NAME, unnamed_rest


def test_what_is_complete_has_no_rest(plain):
    assert unnamed_rest(plain) is None


def test_a_force_outside_the_catalogue_is_followed_but_not_named(recorded):
    answer = diagnose([recorded({(NAME, "bowed_tether"): 25.0})])
    assert answer.verdict == "unknown"
    assert NAME not in answer.effects
    # The held-out frames know whether the terms are right: the error falls by more than half, towards the floor.
    assert answer.after.midline_mm is not None and answer.before.midline_mm is not None
    assert answer.after.midline_mm < 0.5 * answer.before.midline_mm
    assert NAME in answer.augmented_model.parameters
    assert any("without a name" in sentence for sentence in answer.words)

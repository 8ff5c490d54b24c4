"""The rest without a name: found where it is, absent where nothing is missing, and no name for it."""

from discovery.diagnose import diagnose
from discovery.given import Deciding
from discovery.rules.unnamed import UNNAMED_EFFECT, unnamed_rest


def test_what_is_complete_has_no_rest(plain):
    assert unnamed_rest(plain) is None


def test_a_force_outside_the_catalogue_is_followed_but_not_named(recorded):
    answer = diagnose([recorded({(UNNAMED_EFFECT, "bowed_tether"): 25.0})], deciding=Deciding("rules", laws=False))
    assert answer.verdict == "unknown"
    assert UNNAMED_EFFECT not in answer.effects
    # The held-out frames know whether the terms are right: of what stands above the noise less than half is left.
    before, after, floor = (measure.midline_mm or 0.0 for measure in (answer.before, answer.after, answer.floor))
    assert before > 1.5 * floor > 0.0
    assert after**2 - floor**2 < 0.25 * (before**2 - floor**2)
    assert UNNAMED_EFFECT in answer.augmented_model.parameters
    assert any("without a name" in sentence for sentence in answer.words)

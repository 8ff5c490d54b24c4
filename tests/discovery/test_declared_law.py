"""A law that acts in the arm and its baseline is declared; what is missing beside it is then found."""

from dataclasses import replace

import numpy as np
import pytest

from discovery.diagnose import diagnose
from tentacle.diagnosis import Diagnosis
from tentacle.recording import Declaration, Recording
from tentacle.specimen import WATER
from tests.made_recordings import SPECIMEN, Run, record_declared

FRICTION = {("dry_friction", "c_f"): 0.1, ("dry_friction", "slip"): 0.03}
PAYLOAD = 2e-3  # kg, a thirtieth of the arm's mass


def recorded(laws: tuple[str, ...], payload: float, seed: int, seconds: float = 10.0) -> Recording:
    hidden = {**FRICTION, ("tip_mass", "mass"): payload}
    made = record_declared(Declaration(replace(SPECIMEN, laws=laws), WATER), hidden, Run(seconds=seconds, seed=seed))
    return replace(made, name=f"run{seed}")


def answer(*laws: str) -> Diagnosis:
    """The payload is sought in one run; in the other there is friction alone, and it is called complete."""
    return diagnose([recorded(laws, PAYLOAD, 1)], baseline=[recorded(laws, 0.0, 2)])


def holds_the_payload(found: Diagnosis) -> None:
    assert (found.verdict, found.effects) == ("effect", ("tip_mass",))
    mass = found.parameters["tip_mass"]["mass"]
    assert mass.low <= PAYLOAD <= mass.high
    assert mass.high - mass.low < PAYLOAD  # it is weighed, not only seen
    friction = found.augmented_model.parameters["dry_friction"]["c_f"]
    assert friction.value == pytest.approx(FRICTION["dry_friction", "c_f"], rel=0.1)


@pytest.mark.long
def test_a_payload_is_weighed_beside_a_declared_friction():
    found = answer("dry_friction")
    holds_the_payload(found)
    assert any("The declared law dry_friction" in sentence for sentence in found.words)


@pytest.mark.long
def test_a_friction_that_the_baseline_shows_is_taken_as_the_arms_own():
    """The same answer as where it is declared: the baseline's own recordings tell it."""
    found = answer()
    holds_the_payload(found)
    assert any("own recordings show dry_friction" in sentence for sentence in found.words)


def test_a_declared_model_that_runs_away_in_the_baseline_is_told(monkeypatch):
    """As softening declared for an arm that swings farther than the softening holds."""

    def runs_away(*_):
        raise np.linalg.LinAlgError("the evidence is not finite")

    monkeypatch.setattr("discovery.baseline_law.baseline_alone", runs_away)
    laws = ("cubic_stiffness",)
    found = diagnose([recorded(laws, PAYLOAD, 1, seconds=2.0)], baseline=[recorded(laws, 0.0, 2, seconds=2.0)])
    assert found.verdict == "unknown"
    assert any("leave all bounds in the baseline" in sentence for sentence in found.words)

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


@pytest.mark.long
def test_a_payload_is_weighed_beside_a_declared_friction():
    found = answer("dry_friction")
    assert (found.verdict, found.effects) == ("effect", ("tip_mass",))
    mass = found.parameters["tip_mass"]["mass"]
    assert mass.low <= PAYLOAD <= mass.high
    assert mass.high - mass.low < PAYLOAD  # it is weighed, not only seen
    friction = found.augmented_model.parameters["dry_friction"]["c_f"]
    assert friction.value == pytest.approx(FRICTION["dry_friction", "c_f"], rel=0.1)


@pytest.mark.long
def test_without_the_declaration_the_payload_alone_is_not_the_answer():
    """The baseline is declared complete and lacks friction, so it proves nothing."""
    found = answer()
    assert found.effects != ("tip_mass",)
    assert any("proves nothing" in sentence for sentence in found.words)
    assert any('declare laws = ["dry_friction"]' in sentence for sentence in found.words)


def test_a_declared_model_that_runs_away_in_the_baseline_is_told(monkeypatch):
    """As softening declared for an arm that swings farther than the softening holds."""

    def runs_away(*_):
        raise np.linalg.LinAlgError("the evidence is not finite")

    monkeypatch.setattr("discovery.loop.baseline_alone", runs_away)
    laws = ("cubic_stiffness",)
    found = diagnose([recorded(laws, PAYLOAD, 1, seconds=2.0)], baseline=[recorded(laws, 0.0, 2, seconds=2.0)])
    assert found.verdict == "unknown"
    assert any("leave all bounds in the baseline" in sentence for sentence in found.words)

"""Judged frames refute a set that does not predict them, and no more than it."""

from __future__ import annotations

from collections.abc import Collection
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import discovery.judged_answer as module
from discovery.judged_answer import judged_answer
from inference.posterior import FORCE_SHARES, Hypothesis, declared_model


@pytest.fixture
def found(plain) -> Any:
    """A payload follows the fitted frames almost as well as a payload and a wall, and both far better than nothing."""
    base = declared_model(plain.problem, plain.fitted.nuisances)

    def of(effects: tuple[str, ...], share: float, nats: float) -> Hypothesis:
        evidence = nats - 3.0 * np.log(FORCE_SHARES / share) ** 2
        return Hypothesis(effects, base.problem, base.fitted, (), evidence)

    sets = of((), 0.1, 0.0), of(("tip_mass",), 0.003, 48.0), of(("tip_mass", "wall"), 0.003, 53.5)
    return SimpleNamespace(hypotheses=sets)


def judged_where(monkeypatch: pytest.MonkeyPatch, found: Any, predicting: Collection[tuple[str, ...]]) -> Any:
    """The judged answer where these sets predict the judged frames."""

    def judged(_found: Any, decision: Any, *_: Any) -> Any:
        named = decision.verdict in ("effect", "group")
        return SimpleNamespace(decision=decision, withdrawn=named and decision.leading.effects not in predicting)

    monkeypatch.setattr(module, "_judged", judged)
    return judged_answer(found, None, None, lambda h: (h, []))  # type: ignore[arg-type]


def test_the_likelier_and_larger_set_is_named_where_the_smaller_one_does_not_predict(monkeypatch, found):
    plain = judged_where(monkeypatch, found, [("tip_mass",), ("tip_mass", "wall")])
    assert plain.decision.effects == ("tip_mass",)  # the wall may act too
    refuted = judged_where(monkeypatch, found, [("tip_mass", "wall")])
    assert not refuted.withdrawn
    assert refuted.decision.effects == ("tip_mass", "wall")
    assert refuted.decision.confidence < plain.decision.confidence  # of what is known and of what is else, less is left


def test_the_first_answer_is_withdrawn_where_no_credible_set_predicts(monkeypatch, found):
    nothing = judged_where(monkeypatch, found, [])
    assert nothing.withdrawn
    assert nothing.decision.effects == ("tip_mass",)

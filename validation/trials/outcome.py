"""One trial's truth and answer, and the definition of a right answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from tentacle.diagnosis import FINER_SHAPE, Diagnosis, Verdict
from validation.trials.rounds import TrialKind

REFERENCE_PLANT = "reference"  # the plant of trials like a recording
TWIN_EFFECTS = 0.9  # |cos| above which a group counts as right


@dataclass(frozen=True)
class Outcome:
    """A trial scored.

    kind, hidden: the truth; r: its size [noise sigmas], NaN outside the catalogue; seen: midline or video. verdict,
    named (third curvature left out), confidence, uncalibrated: the answer. twins: smallest |cos| between the hidden
    effect and those named beside it (1 where it stands alone). before, after, floor: held-out midline errors [mm],
    NaN where not measured. baselines: method -> what it named. seconds: processor time of the diagnosis. plant: the
    simulator; laws: effect -> the law by which it acts there; added_mass: whether it was declared.
    """

    index: int
    kind: TrialKind
    hidden: tuple[str, ...]
    r: tuple[float, ...]
    seen: str
    verdict: Verdict
    named: tuple[str, ...]
    confidence: float
    uncalibrated: float
    twins: float
    before: float
    after: float
    floor: float
    baselines: dict[str, tuple[str, ...]]
    seconds: float
    plant: str = REFERENCE_PLANT
    laws: dict[str, str] = field(default_factory=dict)
    added_mass: bool = False

    @property
    def hit(self) -> bool:
        """Whether the answer is right.

        single: the truth named first, or in the named group; pair: both named; null: nothing missing; unknown: says so.
        """
        if self.kind == "null":
            return not self.named and self.verdict != "unknown"
        if self.kind == "unknown":
            return self.verdict == "unknown"
        if self.kind == "pair":
            return self.verdict in ("effect", "group") and set(self.hidden) <= set(self.named)
        return self.first_named or (self.verdict == "group" and self.hidden[0] in self.named)

    @property
    def first_named(self) -> bool:
        """Whether the (first) hidden effect is the first that was named."""
        return self.verdict in ("effect", "group") and self.named[:1] == self.hidden[:1]

    @property
    def exact(self) -> bool:
        """Whether exactly the hidden effects were named."""
        return self.hit and (self.kind in ("null", "unknown") or set(self.named) == set(self.hidden))

    @property
    def needless_group(self) -> bool:
        """Whether the answer is a group although these data can separate its effects."""
        return self.verdict == "group" and len(self.named) > 1 and self.twins <= TWIN_EFFECTS

    @property
    def smallest_r(self) -> float:
        """R of the faintest hidden effect; 0 where nothing was hidden, infinity where R is not known."""
        return min((value if value == value else float("inf") for value in self.r), default=0.0)

    @property
    def answer(self) -> str:
        """The column of the confusion matrix: the effect named first, or the verdict."""
        if self.verdict in ("effect", "group") and self.named:
            return next((name for name in self.named if name in self.hidden), self.named[0])
        return "unknown" if self.verdict == "unknown" else "nothing"


def answer_table(diagnosis: Diagnosis) -> dict[str, Any]:
    """What a trial keeps of a diagnosis, as plain data."""
    measures = {name: getattr(diagnosis, name).midline_mm for name in ("before", "after", "floor")}
    cosines = {
        f"{a}|{b}": round(float(abs(diagnosis.twin_cosines[i, j])), 4)
        for i, a in enumerate(diagnosis.twin_names)
        for j, b in enumerate(diagnosis.twin_names[:i])
    }
    return {
        "verdict": diagnosis.verdict,
        "effects": list(diagnosis.effects),
        "confidence": diagnosis.confidence,
        "uncalibrated": diagnosis.confidence if diagnosis.uncalibrated is None else diagnosis.uncalibrated,
        "midline_mm": measures,
        "ranking": [[row.effect, row.score, row.probability] for row in diagnosis.ranking[:8]],
        "score_test": list(diagnosis.twin_names[:5]),
        "cosines": cosines,
        "parameters": {e: {n: v.value for n, v in values.items()} for e, values in diagnosis.parameters.items()},
        "words": list(diagnosis.words),
    }


def scored(index: int, truth: Mapping[str, Any], seen: str, answer: Mapping[str, Any], **more: Any) -> Outcome:
    """A trial's sealed truth and its answer_table together; more: baselines, seconds."""
    hidden = tuple(truth["effects"])
    named = tuple(name for name in answer["effects"] if name != FINER_SHAPE)
    # A combination's first effect is found first; only where nothing else was named does the shape alone count as
    # nothing.
    verdict = answer["verdict"] if named or answer["verdict"] == "unknown" else "nothing_missing"
    cosines = answer["cosines"]
    # for each false name, the true effect that it resembles most
    beside = [
        max((cosines.get(f"{a}|{b}", cosines.get(f"{b}|{a}", 0.0)) for a in hidden), default=0.0)
        for b in named
        if b not in hidden
    ]

    def error(name: str) -> float:
        value = answer["midline_mm"][name]
        return float("nan") if value is None else float(value)

    return Outcome(
        index=index, kind=truth["kind"], hidden=hidden, r=tuple(truth["r"]), seen=seen, verdict=verdict, named=named,
        confidence=answer["confidence"], uncalibrated=answer["uncalibrated"], twins=min(beside, default=1.0),
        before=error("before"), after=error("after"), floor=error("floor"),
        baselines={method: tuple(names) for method, names in more["baselines"].items()}, seconds=more["seconds"],
        plant=truth.get("plant", REFERENCE_PLANT), laws=dict(truth.get("laws", {})),
        added_mass=bool(truth.get("declared_added_mass", False)),
    )  # fmt: skip

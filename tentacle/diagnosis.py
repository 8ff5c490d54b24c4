"""The answer of the loop: a verdict, its evidence, and the comparison run by run. Plain data, no logic of a room."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tentacle.model import Estimate, Model
from tentacle.notebook import html_paragraph, html_table
from tentacle.proposed_law import MissingForce, ProposedLaw
from tentacle.rounding import number
from tentacle.signals import Array

Quantity = Literal["strain", "acceleration"]  # what a sensor on the arm measures
Verdict = Literal["nothing_missing", "effect", "group", "unknown"]
NEXT_SECONDS = (
    15.0  # s for which the next experiment's base motion is run: longer than every relaxation of an arm in water
)
FINER_SHAPE = "third_curvature"  # among the effects where the arm needs more than two curvature coordinates


@dataclass(frozen=True)
class ErrorMeasure:
    """Root mean square errors over the judged samples; None where the quantity was not measured."""

    midline_mm: float | None = None
    angle_rad: float | None = None
    q1: float | None = None
    q2: float | None = None
    thrust_n: float | None = None


@dataclass(frozen=True)
class RankedEffect:
    """A candidate: score in nats (log-likelihood gained by it alone, training data), judged error, probability."""

    effect: str
    score: float
    held_out_midline_mm: float | None
    probability: float


@dataclass(frozen=True)
class ErrorBudget:
    """Where the declared model's midline error comes from, in mm rms: noise, reduction, missing physics, the rest."""

    noise_mm: float
    reduction_mm: float
    missing_mm: float
    rest_mm: float


@dataclass(frozen=True)
class SensorComparison:
    """One sensor on the arm: what it read, measured (T,), and what the models say, base and augmented (T,), each about
    its own mean; NaN where nothing was measured. quantity: "strain" [1] or "acceleration" [m/s^2].
    """

    name: str
    quantity: Quantity
    measured: Array
    base: Array
    augmented: Array


@dataclass(frozen=True)
class RunComparison:
    """One recording beside both models, at the measured instants, in the base frame.

    t (T,) [s]; s (P,); measured, base, augmented (T, P, 2) [m] midline (or marker) positions, NaN where not measured;
    q_measured, q_base, q_augmented (T, 2) [rad] the paper's coordinates (NaN where not measured); judged (T,) True on
    the samples on which the errors are stated. theta (T,) [rad]. points: what the P columns are.
    thrust_base, thrust_augmented (T,) [N] along +y as a load cell at the base would read it, and drag_base,
    drag_augmented (T, P, 2) [N/m], the water's drag per length at the P points; None where they are not known.
    sensors: what each sensor on the arm read.
    """

    name: str
    t: Array
    s: Array
    measured: Array
    base: Array
    augmented: Array
    q_measured: Array
    q_base: Array
    q_augmented: Array
    judged: NDArray[np.bool_]
    theta: Array
    points: Literal["midline", "markers"] = "midline"
    thrust_base: Array | None = None
    thrust_augmented: Array | None = None
    drag_base: Array | None = None
    drag_augmented: Array | None = None
    sensors: tuple[SensorComparison, ...] = ()


@dataclass(frozen=True)
class Gate:
    """One adequacy test of a fitted model: chi-square, Ljung-Box, drift ... passed or not, and the number behind it."""

    name: str
    statistic: float
    threshold: float
    passed: bool
    words: str


@dataclass(frozen=True)
class Explained:
    """The share of the missing force that was explained, with its 95 % interval; 0 .. 1."""

    share: float
    low: float
    high: float


@dataclass(frozen=True)
class CredibleSet:
    """One of the sets of effects that together hold 95 % of the posterior, with its own mass."""

    effects: tuple[str, ...]
    probability: float


@dataclass(frozen=True)
class Limit:
    """The smallest strength that these recordings would have named in 95 of 100 cases."""

    value: float
    unit: str


@dataclass(frozen=True)
class Diagnosis:
    """The answer of `tentacle diagnose`; verdict.json and report.html are written from it."""

    verdict: Verdict
    effects: tuple[str, ...]
    confidence: float
    parameters: dict[str, dict[str, Estimate]]
    before: ErrorMeasure
    after: ErrorMeasure
    floor: ErrorMeasure
    held_out: bool
    ranking: tuple[RankedEffect, ...]
    next_experiment: dict[str, Any] | None
    budget: ErrorBudget
    base_model: Model
    augmented_model: Model
    twin_names: tuple[str, ...]
    twin_cosines: Array
    runs: tuple[RunComparison, ...]
    words: tuple[str, ...]
    seed: int
    next_nats: float | None = None  # by which the best base motion tried separates the two nearest explanations
    uncalibrated: float | None = None  # the confidence before blind trials corrected it; None: never corrected
    explained: Explained | None = None
    certain: tuple[str, ...] = ()
    sets: tuple[CredibleSet, ...] = ()
    detection_limits: dict[str, dict[str, Limit]] = field(default_factory=dict)
    where: dict[str, tuple[str, ...]] = field(default_factory=dict)
    missing: MissingForce = field(
        default_factory=MissingForce
    )  # after an unknown: where a force is missing, and laws for it

    @property
    def missing_effects(self) -> tuple[str, ...]:
        """The effects without FINER_SHAPE: a finer description of the arm is no physical effect."""
        return tuple(effect for effect in self.effects if effect != FINER_SHAPE)

    @property
    def in_doubt(self) -> tuple[str, ...]:
        """A group's effects of which the data cannot say which acts; those that are certain are not among them."""
        left = tuple(effect for effect in self.missing_effects if effect not in self.certain)
        return left or self.missing_effects

    @property
    def alternatives(self) -> tuple[tuple[str, ...], ...]:
        """What may act beside the certain effects: of each credible set the effects in doubt, the likeliest first."""
        doubted = [tuple(name for name in one.effects if name in self.in_doubt) for one in self.sets]
        return tuple(dict.fromkeys(filter(None, doubted))) or tuple((name,) for name in self.in_doubt)

    @property
    def first_law(self) -> ProposedLaw | None:
        """After an unknown the first of the laws that were found for the missing force; None where there is none."""
        return self.missing.laws[0] if self.verdict == "unknown" and self.missing.laws else None

    @property
    def law_label(self) -> str:
        """What the first law is called beside its error."""
        return "with the proposed law" if self.first_law is not None and self.first_law.fits else "with the best law"

    @property
    def sentences(self) -> tuple[str, ...]:
        """All sentences beyond the headline, those about the missing force after an unknown included."""
        return (*self.words, *(self.missing.words if self.verdict == "unknown" else ()))

    @property
    def cannot_tell(self) -> bool:
        """Whether the data show too little for any answer: the verdict is "unknown", and `words` say why."""
        return self.verdict == "unknown" and not self.runs

    @property
    def headline(self) -> str:
        """The verdict in one sentence, with the error before and after."""
        if self.cannot_tell:
            return " ".join(self.words)
        error = ""
        if self.before.midline_mm is not None and self.after.midline_mm is not None:
            error = f" Error {self.before.midline_mm:.2f} mm before, {self.after.midline_mm:.2f} mm after"
            if self.first_law is not None and self.first_law.held_out_midline_mm is not None:
                error += f", {self.first_law.held_out_midline_mm:.2f} mm {self.law_label}"
            if self.floor.midline_mm is not None:
                error += f" (floor {self.floor.midline_mm:.2f} mm)"
            error += ", on held-out data." if self.held_out else ", on the data that were fitted."
        names, finer = " + ".join(self.missing_effects), FINER_SHAPE in self.effects
        sure = [effect for effect in self.missing_effects if effect not in self.in_doubt]
        doubt = " / ".join(" + ".join(names) for names in self.alternatives)
        beside = f"{' + '.join(sure)} and " if sure else ""
        also = " It also needs more than two curvature coordinates." if finer else ""
        only = (
            "The declared laws explain these data with more than two curvature coordinates: no missing effect can be "
            "detected."
        )
        sentence = {
            "nothing_missing": "The declared model explains these data: no missing effect can be detected.",
            "effect": f"The declared model lacks {names}.{also}" if names else only,
            "group": f"The declared model lacks {beside}one of {doubt}; these data cannot tell which.{also}",
            "unknown": "The declared model lacks an effect that is not in the catalogue, or that these data cannot "
            "identify.",
        }[self.verdict]
        return sentence + error

    def verdict_json(self) -> dict[str, Any]:
        """The contract's verdict.json as plain data."""

        def measure(error: ErrorMeasure) -> dict[str, float | None]:
            return {
                "midline_mm": error.midline_mm,
                "angle_rad": error.angle_rad,
                "q1": error.q1,
                "q2": error.q2,
                "thrust_n": error.thrust_n,
            }

        return {
            "verdict": self.verdict,
            "effects": list(self.effects) if self.verdict in ("effect", "group") else [],
            "confidence": self.confidence,
            "parameters": {
                effect: {
                    name: {"value": e.value, "low": e.low, "high": e.high, "unit": e.unit} for name, e in values.items()
                }
                for effect, values in self.parameters.items()
            },
            "error": {"before": measure(self.before), "after": measure(self.after), "floor": measure(self.floor)},
            "held_out": self.held_out,
            "ranking": [
                {
                    "effect": ranked.effect,
                    "score": ranked.score,
                    "held_out_midline_mm": ranked.held_out_midline_mm,
                    "probability": ranked.probability,
                }
                for ranked in self.ranking
            ],
            "next_experiment": self.next_experiment,
            "explained": None if self.explained is None else asdict(self.explained),
            "certain": list(self.certain),
            "sets": [{"effects": list(one.effects), "probability": one.probability} for one in self.sets],
            "detection_limits": {
                effect: {name: asdict(limit) for name, limit in limits.items()}
                for effect, limits in self.detection_limits.items()
            },
            "where": {name: list(effects) for name, effects in self.where.items()},
            "laws": [law.json() for law in self.missing.laws],
        }

    def _repr_html_(self) -> str:
        """The headline, the confidence, the errors and the parameters found, for notebooks."""

        def row(name: str, unit: str, values: Iterable[float | None]) -> tuple[str, ...]:
            return (name, unit, *(number(value) for value in values))

        measures = (("midline", "mm", "midline_mm"), ("angle", "rad", "angle_rad"), ("q1", "rad", "q1"),
                    ("q2", "rad", "q2"), ("thrust", "N", "thrust_n"))  # fmt: skip
        errors = (self.before, self.after, self.floor)
        rows = [row(name, unit, (getattr(error, field) for error in errors)) for name, unit, field in measures]
        found = [
            (effect, name, e.value_words, e.interval_words, e.unit)
            for effect, values in self.parameters.items()
            for name, e in values.items()
        ]
        html = html_paragraph(self.headline) + html_paragraph(f"Confidence {self.confidence:.2f}.")
        html += html_table(("rms error", "unit", "before", "after", "floor"), rows)
        if found:
            html += html_table(("effect", "parameter", "value", "95 % interval", "unit"), found)
        return html

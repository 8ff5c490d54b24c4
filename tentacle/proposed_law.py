"""The missing force after an unknown: where and when it acts, and laws that would explain it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tentacle.law.written_law import WrittenLaw
from tentacle.rounding import rounded
from tentacle.signals import Array

UNPLACED = 0.1  # arm lengths: with a wider 95 % interval a place counts as not determined
# Share that a law may leave and still be said to fit: in 15 recordings of an outside program the true laws left 1 to
# 10 %, and laws of another form or at another place 8 to 55 %.
FITS = 0.15
TWO_PI = "6.283185307"  # in expressions, which know no pi


@dataclass(frozen=True)
class ForceMap:
    """The missing force in one recording, along the normal: t (T,) [s], s (P,), force and spread (T, P) [N/m] along the
    arm, tip_force and tip_spread (T,) [N] at the tip; spreads are standard deviations. NaN where no frame was used.
    """

    name: str
    t: Array
    s: Array
    force: Array
    spread: Array
    tip_force: Array
    tip_spread: Array


@dataclass(frozen=True)
class ForceOver:
    """The missing force of a recording over one coordinate, as one normal force at the place s, which explains that
    share of the missing generalised force. Means of the coordinate [unit] and of the force [N], and the force's
    standard deviation (B,), in bins of equal count; predicted: share of the force's variance that this curve predicts
    on stretches it was not drawn from, 0 .. 1. frequency [Hz]: of the period of which the coordinate is the phase; None
    for every other coordinate.
    """

    name: str
    s: float
    explained: float
    coordinate: str
    unit: str
    value: Array
    force: Array
    deviation: Array
    predicted: float
    frequency: float | None = None

    @property
    def place(self) -> str:
        """The place in words."""
        return "the tip" if self.s == 1.0 else f"s = {self.s:.2f}"


@dataclass(frozen=True)
class ProposedLaw:
    """A law that explains the missing force. law: with the fitted values as nominal ones; values: of its parameters;
    evidence [nats] over no law, on the frames that were fitted; held_out_midline_mm: error of the model with it, on
    frames that the search did not use; unexplained: share of the missing force's effect that it does not explain, 0 ..
    1; deviations: standard deviations of its shapes, if the law is true; length [m] of the arm.
    """

    law: WrittenLaw
    values: dict[str, float]
    evidence: float
    held_out_midline_mm: float | None
    unexplained: float
    deviations: dict[str, float]
    length: float

    @property
    def region(self) -> dict[str, tuple[float, float]]:
        """The 95 % interval of each coordinate of its place (at_s in arm lengths, else m), if the law is true."""
        names = [name for name in ("at_x", "at_y", "edge", "at_s") if name in self.values and name in self.deviations]
        half = {name: 1.96 * self.deviations[name] for name in names}
        return {name: (self.values[name] - half[name], self.values[name] + half[name]) for name in names}

    @property
    def fits(self) -> bool:
        """Whether it leaves so little that it is proposed as the law of the missing force."""
        return self.unexplained <= FITS

    @property
    def region_words(self) -> str:
        """A sentence about the interval of its place; empty where it has no place."""
        extent = {"at_s": 1.0}

        def between(name: str, ends: tuple[float, float]) -> str:
            low, high = (rounded(end, ends[1] - ends[0]) for end in ends)
            return f"{name} from {low} to {high}{'' if name in extent else ' m'}"

        wide = {
            name: (low, high)
            for name, (low, high) in self.region.items()
            if high - low > UNPLACED * extent.get(name, self.length)
        }
        shown = " and ".join(between(name, ends) for name, ends in (wide or self.region).items())
        if wide:
            return f"The recordings do not determine its place: they allow {shown} (95 %, if the law is true)."
        return f"If the law is true, its place is {shown} (95 %)." if shown else ""

    @property
    def reach_words(self) -> str:
        """A sentence about its reach; empty where it has none."""
        if "reach" not in self.values:
            return ""
        return "Its reach is the distance from its point at which its strength has fallen to 37 % (1/e)."

    @property
    def numbers(self) -> str:
        """The parameters' values with their units."""
        units = {p.name: p.unit for p in self.law.parameters}
        shown = [f"{name} = {value:.4g} {units[name]}".removesuffix(" 1") for name, value in self.values.items()]
        return ", ".join(shown)

    @property
    def expression(self) -> str:
        """The law's expressions, then its definitions, then the numbers and constants."""
        parts = [f"{name} = {text}" for name, text in (*self.law.components.items(), *self.law.definitions.items())]
        constants = [
            f"{name} = {value:g} {unit}".removesuffix(" 1") for name, (value, unit) in self.law.constants.items()
        ]
        return "; ".join([*parts, ", ".join([self.numbers, *constants])]).replace(TWO_PI, "2 pi")

    @property
    def place(self) -> str:
        """Its section, where it acts at one inside the arm; the point in space from which it acts, or else its place on
        the arm.
        """
        section = [f"s = {self.values['at_s']:.2f}"] if "at_s" in self.values else []
        if "at_x" in self.values:
            section.append(f"x = {self.values['at_x']:.4g} m, y = {self.values['at_y']:.4g} m")
        if section:
            return "; ".join(section)
        return "tip" if self.law.acts == "tip" else "along the arm"

    @property
    def acts(self) -> str:
        """On what it acts: "line" (all along the arm), "section" (one inside the arm), "tip" or "moment"."""
        return "section" if "at_s" in self.values else self.law.acts

    @property
    def words(self) -> str:
        """The law in a sentence, with its numbers."""
        return f"{self.law.title} ({self.numbers})"

    def json(self) -> dict[str, Any]:
        """The entry of verdict.json."""
        return {
            "expression": self.expression,
            "acts": self.acts,
            "place": self.place,
            "evidence": self.evidence,
            "held_out_midline_mm": self.held_out_midline_mm,
            "file": f"laws/{self.law.name}.toml",
            "parameters": dict(self.values),
            "region": {name: list(ends) for name, ends in self.region.items()},
        }


@dataclass(frozen=True)
class LawExperiment:
    """The experiment that would separate the best law from its rivals. motion: table of its base motion, None where no
    motion separates them; nats: by which it separates the two nearest; words: a sentence about it.
    """

    motion: dict[str, Any] | None
    nats: float
    words: str


@dataclass(frozen=True)
class MissingForce:
    """The results about it: maps, laws (best first), and rows (a kind of law, share that its best law does not
    explain); words: sentences about all of it but the experiment; experiment: None where the best law has no rival;
    over: the force of the first recording over each coordinate, the one that predicts most of it first.
    """

    maps: tuple[ForceMap, ...] = ()
    laws: tuple[ProposedLaw, ...] = ()
    kinds: tuple[tuple[str, float], ...] = ()
    words: tuple[str, ...] = ()
    experiment: LawExperiment | None = None
    over: tuple[ForceOver, ...] = ()

"""What is said of a missing force after an unknown: where and when it acts, and laws that would explain it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tentacle.law.written_law import WrittenLaw
from tentacle.signals import Array


@dataclass(frozen=True)
class ForceMap:
    """The missing force in one recording, along the normal: t (T,) [s], s (P,), force and spread (T, P) [N/m] along the
    arm, tip_force and tip_spread (T,) [N] at the tip; spreads are standard deviations.
    """

    name: str
    t: Array
    s: Array
    force: Array
    spread: Array
    tip_force: Array
    tip_spread: Array


@dataclass(frozen=True)
class ProposedLaw:
    """A law that explains the missing force. law: with the fitted values as nominal ones; values: of its parameters;
    evidence [nats] over no law, on the frames that were fitted; held_out_midline_mm: error of the model with it, on
    frames that the search did not use; unexplained: share of the missing force's effect that it leaves, 0 .. 1.
    """

    law: WrittenLaw
    values: dict[str, float]
    evidence: float
    held_out_midline_mm: float | None
    unexplained: float

    @property
    def numbers(self) -> str:
        """The parameters' values with their units."""
        units = {p.name: p.unit for p in self.law.parameters}
        shown = [f"{name} = {value:.4g} {units[name]}".removesuffix(" 1") for name, value in self.values.items()]
        return ", ".join(shown)

    @property
    def expression(self) -> str:
        """The law's expressions, then its definitions, then the numbers."""
        parts = [f"{name} = {text}" for name, text in (*self.law.components.items(), *self.law.definitions.items())]
        return "; ".join([*parts, self.numbers])

    @property
    def place(self) -> str:
        """The point in space from where it acts; without one, where on the arm."""
        if "at_x" in self.values:
            return f"x = {self.values['at_x']:.4g} m, y = {self.values['at_y']:.4g} m"
        return "tip" if self.law.acts == "tip" else "along the arm"

    @property
    def words(self) -> str:
        """The law in a sentence, with its numbers."""
        return f"{self.law.title} ({self.numbers})"

    def json(self) -> dict[str, Any]:
        """The entry of verdict.json."""
        return {
            "expression": self.expression,
            "acts": self.law.acts,
            "place": self.place,
            "evidence": self.evidence,
            "held_out_midline_mm": self.held_out_midline_mm,
            "file": f"laws/{self.law.name}.toml",
            "parameters": dict(self.values),
        }


@dataclass(frozen=True)
class MissingForce:
    """All that is said of it: maps, laws (best first), and (a kind of law, share that the best of it leaves) rows."""

    maps: tuple[ForceMap, ...] = ()
    laws: tuple[ProposedLaw, ...] = ()
    kinds: tuple[tuple[str, float], ...] = ()
    words: tuple[str, ...] = ()

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
    frames that the search did not use; left: share of the missing force's effect that it leaves, 0 .. 1.
    """

    law: WrittenLaw
    values: dict[str, float]
    evidence: float
    held_out_midline_mm: float | None
    left: float

    @property
    def expression(self) -> str:
        """The law's expressions, definitions behind."""
        parts = [f"{name} = {text}" for name, text in (*self.law.components.items(), *self.law.definitions.items())]
        return "; ".join(parts)

    @property
    def place(self) -> dict[str, float] | None:
        """The point in space where it acts from [m], where it has one."""
        point = {"x_m": self.values.get("at_x"), "y_m": self.values.get("at_y")}
        return {k: v for k, v in point.items() if v is not None} or None

    @property
    def words(self) -> str:
        """The law in a sentence, with its numbers."""
        units = {p.name: p.unit for p in self.law.parameters}
        shown = ", ".join(
            f"{name} = {value:.4g} {units[name]}".removesuffix(" 1") for name, value in self.values.items()
        )
        return f"{self.law.title} ({shown})"

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

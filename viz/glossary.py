"""The words that reports and documentation use, each with its meaning."""

from __future__ import annotations

import re
from typing import NamedTuple


class Term(NamedTuple):
    """A word, what it means, and its unit ("" where it has none)."""

    name: str
    meaning: str
    unit: str


TERMS = (
    Term("added mass", "water that must be accelerated with the arm", "kg/m"),
    Term("adequacy", "the residual looks like the measurement's noise", ""),
    Term("arc length s", "position along the arm, 0 at the clamp, 1 at the tip", "1"),
    Term("augmented model", "the declared model with what the loop added", ""),
    Term("base frame", "origin at the clamp, x along n, y along the straight arm at theta = 0; it does not turn", "m"),
    Term("base model", "the model as declared, refitted", ""),
    Term("baseline", "recordings whose declaration is believed complete", ""),
    Term("C_perp", "drag coefficient across the flow (eq. 15)", "1"),
    Term("confidence", "how often such a verdict is right: its posterior mass, tempered by blind trials", "1"),
    Term("coordinates q1, q2", "curvature c(s) = q1 + q2 s", "rad"),
    Term("declaration", "what is believed about a recording: arm, fluid, gravity, camera", ""),
    Term("detection limit", "the smallest strength of an effect that would have been named with 95 %", ""),
    Term("effect", "one physical law with its parameters", ""),
    Term("floor", "the error that noise and the reduction to few coordinates alone would leave", "mm"),
    Term("grammar", "the forms of laws that are searched after an unknown", ""),
    Term("group", "effects that the recordings cannot tell apart", ""),
    Term("held out", "not fitted, used to judge", ""),
    Term("judged", "on the frames on which errors are stated: those held out, or all where none are", ""),
    Term("law", "how a force depends on place, motion or time, with its numbers", ""),
    Term("midline", "the central axis of the arm", "m"),
    Term("missing force", "the force that the model must add to move as the arm was seen to move", "N"),
    Term("nat", "unit of log-likelihood; one nat is a factor e", "1"),
    Term("order", "number of curvature coordinates", "1"),
    Term("posterior mass", "how probable an answer is, given the recordings and the priors", "1"),
    Term("prescribed base", "the measured servo angle is what the base does", ""),
    Term("reach", "distance from a point at which the strength of a law around it has fallen to 1/e", "m"),
    Term("residual", "measured minus modelled", ""),
    Term("score", "log-likelihood that an effect alone would gain", "nat"),
    Term("section law", "k(s) = E I(s)/L; the paper's is k0 + k1 s", "N m/rad"),
    Term("theta", "angle by which the servo turns the base", "rad"),
    Term("thrust", "force on the base along y", "N"),
    Term("twins", "effects whose sensitivities are nearly parallel under the excitation at hand", ""),
    Term("weak form", "regression on integrals against test functions, without differentiating data", ""),
)


def terms_in(text: str) -> list[Term]:
    """The terms that a text uses."""
    return [term for term in TERMS if re.search(rf"\b{_pattern(_stem(term.name))}s?\b", text, re.IGNORECASE)]


def _pattern(stem: str) -> str:
    """A term as a regular expression: "held-out" is "held out" too."""
    return re.escape(stem).replace(r"\ ", "[ -]")


def _stem(name: str) -> str:
    """What to look for: "arc length" of "arc length s", "coordinate" of "coordinates q1, q2"."""
    return re.sub(r"( s|s q1, q2)$", "", name)

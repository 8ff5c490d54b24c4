"""Laws that act at one section inside the arm: the grammar's forms of the tip, at a place s_0 that is a shape.

    F(x_0, y_0, u_n0)  at s_0   ->   F bell(s) along the arm
    bell = (3 - z^2) / 2 exp(-z^2 / 2) / (w sqrt(2 pi) L),      z = (s - s_0) / w

The bell has unit area and no second moment, so that it stands for a point up to the third order in w; the strength
stays in newtons. A plain Gaussian of any width that the model's nodes resolve moved the place by .02 to .05. A
section's own place and speed are carried to s_0 along its tangent, for all of the bell shall bear the force of s_0:
x_0 = x - (s_0 - s) L sin phi,  y_0 = y + (s_0 - s) L cos phi,  u_n0 = u_n - (s_0 - s) L phi'.

The forms are sought only where the missing force itself acts at one inner place.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from affine_model.arm import Arm
from discovery.laws.along import shown_instants
from discovery.laws.grammar import Form, Scale, forms
from discovery.laws.over import PLACES, one_force
from inference.missing_force import SeenMotion
from tentacle.law.written_law import WrittenParameter

WIDTH = 0.12  # arm lengths: with 8 Gauss nodes the generalised forces are those of a point .015 away at most, to 1 %
INNERMOST, OUTERMOST = 0.25, 0.85  # of the middle of a bell: nearer to an end too much of it lies beyond
INNER = "inside_"  # names of these forms begin so
AT_TIP, AT_PLACE = "the tip", "one section"  # in their words
MOST_LEFT = 0.15  # share of the missing force's square that one force at the best inner place may leave
CLEARLY = 0.5  # of what a force at the tip leaves: the best inner place leaves less
COARSER = {"power": 2, "slack": 2, "frequency": 2}  # every second value of these shapes is tried before the refinement
CARRIED = {
    "x": ("own_x", "x - (at_s - s) * length * sin(phi)"),
    "y": ("own_y", "y + (at_s - s) * length * cos(phi)"),
    "u_n": ("own_u_n", "u_n - (at_s - s) * length * phi_rate"),
}


def inner_forms(scale: Scale, s: float) -> tuple[Form, ...]:
    """The forms of the tip as ones that act near s, which is refined."""
    return tuple(_inside(form, s) for form in forms(scale) if form.law.acts == "tip")


def _inside(form: Form, s: float) -> Form:
    """A form of the tip as one that acts at a section near s."""
    law = form.law
    text = " ".join([*law.components.values(), *law.definitions.values()])
    carried = {own: (name, value) for own, (name, value) in CARRIED.items() if re.search(rf"\b{own}\b", text)}

    def moved(expression: str) -> str:
        for own, (name, _) in carried.items():
            expression = re.sub(rf"\b{own}\b", name, expression)
        return expression

    title = form.words.replace(AT_TIP, AT_PLACE)
    place = WrittenParameter("at_s", "1", s, (INNERMOST, OUTERMOST), "the section at which it acts", (s,))
    bell = f"(3 - off^2) / 2 * exp(-(off^2) / 2) / ({WIDTH * np.sqrt(2.0 * np.pi):.6f} * length)"
    whole = {"off": f"(s - at_s) / {WIDTH}", "bell": bell}
    inside = replace(
        law, name=INNER + law.name.removeprefix("tip_"), title=title, acts="line",
        components={name: f"bell * ({moved(value)})" for name, value in law.components.items()},
        definitions={**dict(carried.values()), **{n: moved(v) for n, v in law.definitions.items()}, **whole},
        parameters=(*(replace(p, scan=p.scan[:: COARSER.get(p.name, 1)]) for p in law.parameters), place),
    )  # fmt: skip
    inside.check()
    return Form(inside, title)


def inner_place(arms: Sequence[Arm], motions: Sequence[SeenMotion]) -> float | None:
    """The place s inside the arm at which one normal force explains the missing force of these motions; None where none
    does, or where one at the tip does nearly as well.
    """
    whole, left = 0.0, np.zeros(PLACES.size)
    for arm, motion in zip(arms, motions, strict=True):
        square, rest, _ = one_force(arm, motion, shown_instants(motion))
        whole, left = whole + square, left + rest
    best = int(np.argmin(left))
    s = float(PLACES[best])
    stands_out = left[best] < MOST_LEFT * whole and left[best] < CLEARLY * left[-1]
    return s if stands_out and INNERMOST <= s <= OUTERMOST else None

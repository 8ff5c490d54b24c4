"""Code of the water's own motion: its velocity, and its acceleration, the symbolic derivative in time.

surge = d water / dt        at a section that stands still
"""

from __future__ import annotations

import textwrap

import sympy

from affine_model.effect import NODE_QUANTITIES, STATE_QUANTITIES
from affine_model.effects import catalogue
from affine_model.kernel.guarded import guarded
from affine_model.kernel.trace import lines, traced


def water_motion(everywhere: bool) -> str:
    """Of the laws that are the same everywhere, once a step; or of the others, at every section."""
    text: list[str] = []
    t = sympy.Symbol("t", real=True)
    for number, effect in enumerate(catalogue().values()):
        if effect.water_velocity is None or _same_everywhere(traced(effect, "water_velocity")) != everywhere:
            continue
        x_part, y_part = traced(effect, "water_velocity")
        velocity, acceleration = ("stream", "rush") if everywhere else ("water", "surge")
        assignments = [
            (f"{velocity}_x[b]", "+=", x_part),
            (f"{velocity}_y[b]", "+=", y_part),
            (f"{acceleration}_x[b]", "+=", sympy.diff(x_part, t)),
            (f"{acceleration}_y[b]", "+=", sympy.diff(y_part, t)),
        ]
        text += guarded(effect, number, lines(assignments, ""))
    return textwrap.indent(textwrap.dedent("\n".join(text)), " " * (8 if everywhere else 16))


def _same_everywhere(expressions: tuple[sympy.Expr, ...]) -> bool:
    """Whether the expressions have one value along the whole arm, however it moves."""
    changing = {*STATE_QUANTITIES, *NODE_QUANTITIES}
    return not changing & {str(symbol) for value in expressions for symbol in value.free_symbols}

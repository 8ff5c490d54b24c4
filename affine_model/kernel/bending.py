"""The kernel's code of bending moments and of the memories of curvature."""

from __future__ import annotations

import textwrap

import sympy

from affine_model.dynamics import remembering
from affine_model.effect import Effect
from affine_model.effects import catalogue
from affine_model.kernel.guarded import guarded
from affine_model.kernel.trace import lines, step_slope, traced
from affine_model.laws import relaxed


def memory_slots() -> dict[str, int]:
    """The kernel's memory slot of every effect that remembers."""
    return {effect.name: slot for slot, effect in enumerate(remembering(tuple(catalogue().values())))}


def _advance(effect: Effect, duration: sympy.Expr, target: str) -> tuple[list[str], sympy.Expr]:
    """Code that carries the effect's memory over `duration` into target, and d memory / d c_rate of what it gives.

    As affine_model.dynamics.advanced_memory.
    """
    kept = f"store[{memory_slots()[effect.name]}, i, b]"
    if effect.relaxation_time is not None:
        (time,) = traced(effect, "relaxation_time")
        rate = sympy.Symbol("c_rate", real=True)
        after = relaxed(sympy.Symbol(kept), rate, duration, sympy.Symbol("relaxation"))
        body = [
            *lines([("relaxation", "=", time)], ""),
            *lines([(target, "=", after)], ""),
        ]
        return body, sympy.diff(after, rate)
    (limit,) = traced(effect, "yield_curvature")
    body = [
        *lines([("limit", "=", limit)], ""),
        f"stretched = {kept} + {duration} * c_rate[i, b]",
        f"sticks = {duration} * limit / max(abs(stretched), limit)",  # the secant: see trace.step_slope
        f"{target} = min(max(stretched, -limit), limit)",
    ]
    return body, sympy.Symbol("sticks")


def bending_moments() -> str:
    """Bending moments and their slopes over curvature and its rate; memory is carried over half a step."""
    text: list[str] = []
    names = {name: sympy.Symbol(name, real=True) for name in ("c", "c_rate", "memory")}
    for number, effect in enumerate(catalogue().values()):
        if effect.bending_moment is None:
            continue
        (moment,) = traced(effect, "bending_moment")
        body: list[str] = []
        over_rate = step_slope(moment, names["c_rate"])
        if effect.remembers:
            body, gain = _advance(effect, sympy.Symbol("h") / 2, "memory[i, b]")
            over_rate += step_slope(moment, names["memory"]) * gain
        assignments = [
            ("moment[i, b]", "+=", moment),
            ("bend[i, b]", "+=", 0.25 * sympy.Symbol("h") ** 2 * sympy.diff(moment, names["c"])),
            ("bend[i, b]", "+=", 0.5 * sympy.Symbol("h") * over_rate),
        ]
        text += guarded(effect, number, body + lines(assignments, ""))
    return "\n".join(text)


def remembered() -> str:
    """After a step: every memory is carried over the whole step under the rate at its middle."""
    text: list[str] = []
    for number, effect in enumerate(catalogue().values()):
        if effect.remembers:
            body, _ = _advance(effect, sympy.Symbol("h"), f"store[{memory_slots()[effect.name]}, i, b]")
            text += guarded(effect, number, body)
    return textwrap.indent(textwrap.dedent("\n".join(text)), " " * 16)

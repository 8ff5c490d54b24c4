"""Writes the source of the batch kernel: linearly implicit midpoint steps for blocks of individuals, batch innermost.

The unknown of a step is the mean acceleration a: u' at mid-step is u'_0 + h a / 2, u is u_0 + h u'_0 / 2 + h^2 a / 4,
and M a = F holds there (implicit midpoint). It is solved by one Newton iteration from a* = 2 a_(-1) - a_(-2), with the
slopes of bending moments and fluid forces in the matrix, M + h/2 D + h^2/4 K: so stiffness does not limit the step
(physics.md). Effects enter as generated blocks behind flags: one kernel serves every combination.
"""

from __future__ import annotations

import textwrap

import sympy

from affine_model.effect import Effect
from affine_model.effects import catalogue
from affine_model.kernel.template import TEMPLATE
from affine_model.kernel.trace import lines, slope_along, traced

BLOCK = 16  # individuals a block: two AVX-512 or four AVX2 registers of doubles

_NODE = " " * 16  # inside: for step, for iteration, for node i


def _guarded(effect: Effect, number: int, body: list[str]) -> list[str]:
    """The loop over the block around a body; behind the effect's flag unless it is a base effect."""
    if not body:
        return []
    indent = _NODE if effect.family == "base" else _NODE + "    "
    head = [] if effect.family == "base" else [f"{_NODE}if active[{number}]:"]
    return [*head, f"{indent}for b in range(BLOCK):", *(f"{indent}    {line}" for line in body)]


def _section(kind: str, targets: tuple[str, ...]) -> str:
    """Plain sums `target += law` for every effect that has a law of this kind."""
    text: list[str] = []
    for number, effect in enumerate(catalogue().values()):
        if getattr(effect, kind) is None:
            continue
        values = traced(effect, kind)
        assignments = [(target, "+=", value) for target, value in zip(targets, values, strict=True)]
        text += _guarded(effect, number, lines(assignments, ""))
    return "\n".join(text)


def _water() -> str:
    """Velocity of the water and its acceleration (the symbolic derivative in time)."""
    text: list[str] = []
    t = sympy.Symbol("t", real=True)
    for number, effect in enumerate(catalogue().values()):
        if effect.water_velocity is None:
            continue
        x_part, y_part = traced(effect, "water_velocity")
        assignments = [
            ("water_x[b]", "+=", x_part),
            ("water_y[b]", "+=", y_part),
            ("surge_x[b]", "+=", sympy.diff(x_part, t)),
            ("surge_y[b]", "+=", sympy.diff(y_part, t)),
        ]
        text += _guarded(effect, number, lines(assignments, ""))
    return "\n".join(text)


def _forces() -> str:
    """Fluid forces and how fast they fall with the relative velocity (their implicit part)."""
    text: list[str] = []
    for number, effect in enumerate(catalogue().values()):
        if effect.force is None:
            continue
        normal, tangential = traced(effect, "force")
        assignments = [
            ("force_n[b]", "+=", normal),
            ("force_t[b]", "+=", tangential),
            ("slope_n[b]", "-=", slope_along(normal, "u_n")),
            ("slope_t[b]", "-=", slope_along(tangential, "u_t")),
        ]
        text += _guarded(effect, number, lines(assignments, ""))
    return "\n".join(text)


def relaxing_effects() -> tuple[Effect, ...]:
    """Effects with a memory of their own, in the order of the kernel's memory slots."""
    return tuple(effect for effect in catalogue().values() if effect.relaxation_time is not None)


def _moments() -> str:
    """Bending moments and their slopes over curvature and its rate; memory relaxes exactly over half a step."""
    text: list[str] = []
    names = {name: sympy.Symbol(name, real=True) for name in ("c", "c_rate", "memory")}
    slots = {effect.name: slot for slot, effect in enumerate(relaxing_effects())}
    for number, effect in enumerate(catalogue().values()):
        if effect.bending_moment is None:
            continue
        (moment,) = traced(effect, "bending_moment")
        body: list[str] = []
        over_rate = sympy.diff(moment, names["c_rate"])
        if effect.name in slots:
            assert effect.relaxation_time is not None
            (time,) = traced(effect, "relaxation_time")
            body += lines([("relaxation", "=", time)], "")
            body.append("decay = math.exp(-0.5 * h / relaxation)")
            slot = slots[effect.name]
            body.append(f"memory[i, b] = store[{slot}, i, b] * decay + relaxation * (1.0 - decay) * c_rate[i, b]")
            gain = sympy.Symbol("relaxation") * (1 - sympy.Symbol("decay"))
            over_rate += sympy.diff(moment, names["memory"]) * gain
        assignments = [
            ("moment[i, b]", "+=", moment),
            ("bend[i, b]", "+=", 0.25 * sympy.Symbol("h") ** 2 * sympy.diff(moment, names["c"])),
            ("bend[i, b]", "+=", 0.5 * sympy.Symbol("h") * over_rate),
        ]
        text += _guarded(effect, number, body + lines(assignments, ""))
    return "\n".join(text)


def _relaxation() -> str:
    """After a step: every memory relaxes over the whole step under the rate at its middle."""
    text: list[str] = []
    for number, effect in enumerate(catalogue().values()):
        if effect.relaxation_time is None:
            continue
        (time,) = traced(effect, "relaxation_time")
        slot = relaxing_effects().index(effect)
        body = [
            *lines([("relaxation", "=", time)], ""),
            "decay = math.exp(-h / relaxation)",
            f"store[{slot}, i, b] = store[{slot}, i, b] * decay + relaxation * (1.0 - decay) * c_rate[i, b]",
        ]
        text += _guarded(effect, number, body)
    return textwrap.indent(textwrap.dedent("\n".join(text)), " " * 12)  # after the iterations: one level less


def _unrolled(pattern: str, nodes: int) -> str:
    """The pattern, with {k} for the node, summed over all nodes in one expression."""
    return " + ".join(pattern.format(k=k) for k in range(nodes))


def kernel_source(nodes: int) -> str:
    """The module's text for that number of nodes; the same catalogue gives the same text."""
    replacements = {
        "@NODES@": str(nodes),
        "@BLOCK@": str(BLOCK),
        "@STORES@": str(max(1, len(relaxing_effects()))),
        "@STIFFNESS@": _section("stiffness", ("stiffness[i, b]",)),
        "@LINE_INERTIA@": _section("line_inertia", ("carried[b]",)),
        "@NORMAL_INERTIA@": _section("normal_inertia", ("added[b]",)),
        "@ROTARY_INERTIA@": _section("rotary_inertia", ("rotary[i, b]",)),
        "@WEIGHT@": _section("weight", ("heavy[b]",)),
        "@TILT@": _section("gravity_tilt", ("tilt[b]",)),
        "@COUPLE@": _section("couple", ("couple[i, b]",)),
        "@TIP_MASS@": _section("tip_mass", ("tip_mass[b]",)),
        "@HUNG_MASS@": _section("hung_mass", ("hung_mass[b]", "hung_reach[b]")),
        "@WATER@": _water(),
        "@FORCES@": _forces(),
        "@MOMENTS@": _moments(),
        "@RELAXATION@": _relaxation(),
        "@SUM_JACOBIAN_X@": _unrolled("LW[i, {k}] * lever_x[j, {k}, b]", nodes),
        "@SUM_JACOBIAN_Y@": _unrolled("LW[i, {k}] * lever_y[j, {k}, b]", nodes),
        "@SUM_CENTRIPETAL_X@": _unrolled("LW[i, {k}] * centripetal_x[{k}, b]", nodes),
        "@SUM_CENTRIPETAL_Y@": _unrolled("LW[i, {k}] * centripetal_y[{k}, b]", nodes),
        "@SUM_TIP_X@": _unrolled("Lw[{k}] * lever_x[j, {k}, b]", nodes),
        "@SUM_TIP_Y@": _unrolled("Lw[{k}] * lever_y[j, {k}, b]", nodes),
        "@SUM_TIP_CENTRIPETAL_X@": _unrolled("Lw[{k}] * centripetal_x[{k}, b]", nodes),
        "@SUM_TIP_CENTRIPETAL_Y@": _unrolled("Lw[{k}] * centripetal_y[{k}, b]", nodes),
        "@SUM_FORCE@": _unrolled("jac_x[j, {k}, b] * net_x[{k}, b] + jac_y[j, {k}, b] * net_y[{k}, b]", nodes),
        "@SUM_TURN@": _unrolled("A[{k}, j] * couple[{k}, b] - C[{k}, j] * moment[{k}, b]", nodes),
        "@SUM_MASS@": _unrolled("push_x[j, {k}, b] * jac_x[l, {k}, b] + push_y[j, {k}, b] * jac_y[l, {k}, b]", nodes),
        "@SUM_BEND@": _unrolled("A[{k}, j] * A[{k}, l] * rotary[{k}, b] + C[{k}, j] * C[{k}, l] * bend[{k}, b]", nodes),
    }
    source = TEMPLATE
    for mark, text in replacements.items():
        source = source.replace(mark, text)
    return source

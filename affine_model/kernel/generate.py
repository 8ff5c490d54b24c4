"""Writes the source of the batch kernel: linearly implicit midpoint steps for blocks of individuals, batch innermost.

The unknown of a step is the mean acceleration a: u' at mid-step is u'_0 + h a / 2, u is u_0 + h u'_0 / 2 + h^2 a / 4,
and M a = F holds there (implicit midpoint). It is solved by one Newton iteration from a* = 2 a_(-1) - a_(-2), with the
slopes of bending moments and fluid forces in the matrix, M + h/2 D + h^2/4 K: so stiffness does not limit the step.
A law that levels off (friction) has its secant there (trace.step_slope), and takes CAUTIOUS iterations more.
Effects enter as generated blocks behind flags: one kernel serves every combination.
"""

from __future__ import annotations

import textwrap
from dataclasses import dataclass

import sympy

from affine_model.arm import parameter_rows
from affine_model.effect import STATE_QUANTITIES, Effect
from affine_model.effects import catalogue
from affine_model.kernel.at_tip import tip_forces
from affine_model.kernel.bending import bending_moments, memory_slots, remembered
from affine_model.kernel.guarded import NODE, guarded
from affine_model.kernel.template import ARRAYS, SUMMARY, TABLE, TEMPLATE, TRAJECTORY
from affine_model.kernel.trace import lines, slope_along, traced
from affine_model.kernel.unroll import unrolled_source
from affine_model.kernel.water import water_motion

BLOCK = 16  # individuals a block: two AVX-512 or four AVX2 registers of doubles
FEW = 8  # where no more are left: half of a block's time; four lanes would take 9 of its 10 parts
# Corrections more where a law levels off. Friction that holds .1 rad of curvature errs at a step of 1/600 s by .0095,
# .0023 and .0001 of the motion with 1, 2 and 3 of them.
CAUTIOUS = 2

# Where the plain sums over effects go.
SECTION_TARGETS = {
    "stiffness": ("rigidity[i, b]",),
    "natural_curvature": ("natural[i, b]",),
    "drag_coefficient": ("drag_coefficient[i, b]",),
    "line_inertia": ("carried[i, b]",),
    "carried_water": ("round_it[i, b]",),
    "normal_inertia": ("added[i, b]",),
    "rotary_inertia": ("rotary[i, b]",),
    "weight": ("heavy[i, b]",),
    "couple": ("couple[i, b]",),
}
TIP_TARGETS = {"gravity_tilt": ("tilt[b]",)}


def _constant(expressions: tuple[sympy.Expr, ...]) -> bool:
    """Whether neither the motion nor the time changes the expressions."""
    changing = set(STATE_QUANTITIES) | {"t"}
    return not changing & {str(symbol) for value in expressions for symbol in value.free_symbols}


def _sums(targets: dict[str, tuple[str, ...]], constant: bool, indent: str) -> str:
    """Plain sums `target += law` over the effects, of their constant laws or of the others, for every kind in targets.

    Before changing laws are added, in every step, the target is set back to what the constant laws gave.
    """
    text: list[str] = []
    for kind, names in targets.items():
        own: list[str] = []
        flags: list[str] = []
        for number, effect in enumerate(catalogue().values()):
            if getattr(effect, kind) is None or _constant(traced(effect, kind)) != constant:
                continue
            flags.append(f"active[{number}]")
            assignments = [(name, "+=", value) for name, value in zip(names, traced(effect, kind), strict=True)]
            own += guarded(effect, number, lines(assignments, ""))
        if own and not constant:
            fixed = [f"{name} = fixed_{name}" for name in names]
            text += [f"{NODE}if {' or '.join(flags)}:", f"{NODE}    for b in range(BLOCK):"]
            text += [f"{NODE}        {line}" for line in fixed]
        text += own
    return textwrap.indent(textwrap.dedent("\n".join(text)), indent)


def _stiffness(changing: bool) -> str:
    """k(s, t): the sum of the stiffness laws times (1 + share) of each effect that changes it.

    Before the first step of all effects; in every step only where one of them changes in time or with the motion.
    """
    shares = [(k, effect) for k, effect in enumerate(catalogue().values()) if effect.stiffness_share is not None]
    laws = [(k, effect) for k, effect in enumerate(catalogue().values()) if effect.stiffness is not None]
    moving = [f"active[{k}]" for k, effect in shares if not _constant(traced(effect, "stiffness_share"))]
    moving += [f"active[{k}]" for k, effect in laws if not _constant(traced(effect, "stiffness"))]
    if changing and not moving:
        return ""
    text = [f"{NODE}for b in range(BLOCK):", f"{NODE}    stiffness[i, b] = rigidity[i, b]"]
    for number, effect in shares:
        (share,) = traced(effect, "stiffness_share")
        text += guarded(effect, number, lines([("stiffness[i, b]", "*=", 1 + share)], ""))
    if not changing:
        return textwrap.indent(textwrap.dedent("\n".join(text)), " " * 8)
    return "\n".join([f"{NODE}if {' or '.join(moving)}:", textwrap.indent("\n".join(text), "    ")])


def _bodies() -> str:
    """The compact bodies at the tip, from the laws that say where they are and how dense; i is the last node."""
    text: list[str] = []
    water = sympy.Symbol("fluid_density", real=True)
    for place, (number, effect) in enumerate(_hung()):
        if not _constant(traced(effect, "hung_mass")):
            raise ValueError(f"{effect.name}: a hung_mass may not change in time or with the motion")
        mass, reach, drop, density = traced(effect, "hung_mass")
        values = {"mass": mass, "reach": reach, "drop": drop, "displaced": water * mass / density}
        assignments = [(f"body_{name}[{place}, b]", "=", value) for name, value in values.items()]
        text += guarded(effect, number, lines(assignments, ""))
    payload = next(place for place, (_, effect) in enumerate(_hung()) if effect.family == "base")
    for number, effect in enumerate(catalogue().values()):
        if effect.payload_shift is not None:
            shift = zip(("reach", "drop"), traced(effect, "payload_shift"), strict=True)
            moved = [(f"body_{name}[{payload}, b]", "+=", value) for name, value in shift]
            text += guarded(effect, number, lines(moved, ""))
    return textwrap.indent(textwrap.dedent("\n".join(text)), " " * 4)


def _hung() -> list[tuple[int, Effect]]:
    """The effects with a body at the tip, numbered as in the catalogue."""
    return [(k, effect) for k, effect in enumerate(catalogue().values()) if effect.hung_mass is not None]


def _changing(kind: str) -> bool:
    """Whether any effect's law of that kind changes with the motion or in time."""
    laws = [traced(effect, kind) for effect in catalogue().values() if getattr(effect, kind) is not None]
    return not all(_constant(law) for law in laws)


def _fixed_arrays() -> dict[str, str]:
    """Arrays that keep what the constant laws gave, for the kinds that changing laws add to: of each, its source."""
    kinds = [(kind, names) for targets in (SECTION_TARGETS, TIP_TARGETS) for kind, names in targets.items()]
    changed = [name.split("[")[0] for kind, names in kinds if _changing(kind) for name in names]
    return {f"fixed_{name}": name for name in changed}


def _copies() -> str:
    """Fills the arrays of _fixed_arrays."""
    text: list[str] = []
    for name, source in _fixed_arrays().items():
        section = ARRAYS[source] == ("nodes",)
        index = "[i, b]" if section else "[b]"
        text += ["    for i in range(NODES):" if section else "    if True:", "        for b in range(BLOCK):"]
        text.append(f"            {name}{index} = {source}{index}")
    return "\n".join(text)


def _grips() -> str:
    """grip of each lane: 1 where a law that levels off acts; the number of corrections that the block makes more."""
    text = [f"{NODE}for b in range(BLOCK):", f"{NODE}    grip[b] = 0.0"]
    for number, effect in enumerate(catalogue().values()):
        if effect.levels_off:
            rows = [r.index for r in parameter_rows() if r.effect == effect.name and not r.parameter.scan]
            text += guarded(effect, number, [f"grip[b] += abs(par[{row}, b])" for row in rows])
    text += [
        f"{NODE}grips = 0.0",
        f"{NODE}for b in range(BLOCK):",
        f"{NODE}    grip[b] = 1.0 if grip[b] > 0.0 else 0.0",
    ]
    text += [f"{NODE}    grips += grip[b]", f"{NODE}cautious = {CAUTIOUS} if grips > 0.0 else 0"]
    return textwrap.indent(textwrap.dedent("\n".join(text)), " " * 4)


def _gravity(indent: str) -> str:
    """The components of gravity under the tilt."""
    body = ["for b in range(BLOCK):", "    sine, cosine = sincos(tilt[b])"]
    body += ["    gravity_x[b] = gravity * sine", "    gravity_y[b] = gravity * cosine"]
    return "\n".join(indent + line for line in body)


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
        text += guarded(effect, number, lines(assignments, ""))
    return "\n".join(text)


def _solution(order: int, free: bool) -> str:
    """The correction of the accelerations, lane by lane, for each choice of moving coordinates: M = L D L', no root."""
    text: list[str] = []
    choices = ((True, True),) if free else ((False, False), (False, True), (True, False), (True, True))
    for theta, rail in choices:
        flags = ((order, theta), (order + 1, rail), (order + 2, free))
        moving = [*range(order), *(k for k, moves in flags if moves)]
        body: list[str] = []
        for d in moving:
            before = [k for k in moving if k < d]
            for e in before:
                parts = [f"product_{d}_{k} * lower_{e}_{k}" for k in before if k < e]
                body.append(f"product_{d}_{e} = {' - '.join([f'matrix[{d}, {e}, b]', *parts])}")
                body.append(f"lower_{d}_{e} = product_{d}_{e} * inverse_{e}")
            parts = [f"product_{d}_{k} * lower_{d}_{k}" for k in before]
            body.append(f"inverse_{d} = 1.0 / ({' - '.join([f'matrix[{d}, {d}, b]', *parts])})")
            parts = [f"lower_{d}_{k} * right_{k}" for k in before]
            body.append(f"right_{d} = {' - '.join([f'residual[{d}, b]', *parts])}")
        for d in reversed(moving):
            parts = [f"lower_{k}_{d} * change_{k}" for k in moving if k > d]
            body.append(f"change_{d} = {' - '.join([f'right_{d} * inverse_{d}', *parts])}")
            body.append(f"acc[{d}, b] += eager[b] * change_{d}")
        text.append(f"            if free_theta == {theta} and free_rail == {rail}:")
        text += ["                for b in range(BLOCK):", *(f"                    {line}" for line in body)]
    return "\n".join(text)


@dataclass(frozen=True)
class Parts:
    """Code that a back end chooses: where the base's motion comes from, what is kept after a step, and at the end;
    what comes before the first step.
    """

    command: str = TABLE
    kept: str = TRAJECTORY
    summary: str = SUMMARY
    before: str = ""


def filled_template(order: int, parts: Parts, free: bool = False) -> str:
    """The template with the effects' code in it; loops over coordinates and arrays still as written."""
    remembering_flags = [f"active[{k}]" for k, effect in enumerate(catalogue().values()) if effect.remembers]
    tip_changing = [kind for kind in TIP_TARGETS if _changing(kind)]
    replacements = {
        "@COMMAND@": parts.command,
        "@KEPT@": parts.kept,
        "@SUMMARY@": parts.summary,
        "@BEFORE@": parts.before,
        "@SECTION_CONSTANT@": "\n".join([_sums(SECTION_TARGETS, True, " " * 8), _stiffness(False)]),
        "@SECTION_CHANGING@": "\n".join([_sums(SECTION_TARGETS, False, " " * 16), _stiffness(True)]),
        "@TIP_CONSTANT@": "\n".join([_sums(TIP_TARGETS, True, " " * 4), _bodies(), _gravity(" " * 4), _copies()]),
        "@TIP_CHANGING@": _sums(TIP_TARGETS, False, " " * 12) + ("\n" + _gravity(" " * 12)) * bool(tip_changing),
        "@GRIPS@": _grips(),
        "@STREAM@": water_motion(everywhere=True),
        "@WATER@": water_motion(everywhere=False),
        "@FORCES@": _forces(),
        "@MOMENTS@": bending_moments(),
        "@REMEMBERS@": " or ".join(remembering_flags) or "False",
        "@REMEMBERED@": remembered(),
        "@TIP_FORCES@": tip_forces(),
        "@SOLUTION@": _solution(order, free),
    }
    template = TEMPLATE
    for mark, text in replacements.items():
        template = template.replace(mark, text)
    return template


def bodies() -> int:
    """How many compact bodies may hang at the tip."""
    return len(_hung())


def array_sizes(nodes: int, order: int, free: bool = False) -> dict[str, tuple[int, ...]]:
    """The block's arrays, without the lane."""
    extents = {
        "parameters": len(parameter_rows()),
        "coordinates": order + 2 + free,
        "nodes": nodes,
        "three": 3,
        "four": 4,
        "six": 6,
    }
    extents |= {"stores": len(memory_slots()), "bodies": len(_hung())}
    shapes = {**ARRAYS, **{name: ARRAYS[source] for name, source in _fixed_arrays().items()}}
    return {name: tuple(extents[extent] for extent in shape) for name, shape in shapes.items()}


def template_constants(order: int, free: bool) -> dict[str, int]:
    """The template's constants n, D and FREE; free: the base floats."""
    return {"n": order, "D": order + 2 + free, "FREE": int(free)}


@dataclass(frozen=True)
class KernelParts:
    """What decides over a kernel's text, before the half second that it takes to write its loops out."""

    template: str
    constants: dict[str, int]
    shapes: dict[str, tuple[int, ...]]

    def text(self) -> str:
        """The text that is compiled: loops written out, arrays placed."""
        return unrolled_source(self.template, self.constants, self.shapes)


def kernel_parts(nodes: int, order: int, lanes: int = BLOCK, free: bool = False) -> KernelParts:
    """The parts for that number of nodes, curvatures and lanes a block, of a free base or not, and this catalogue."""
    constants = {**template_constants(order, free), "NODES": nodes, "BLOCK": lanes, "BODIES": bodies()}
    return KernelParts(filled_template(order, Parts(), free), constants, array_sizes(nodes, order, free))

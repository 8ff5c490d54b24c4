"""Writes the source of the Warp kernels (NVIDIA Warp): one individual a thread, from the text that numba compiles.

One kernel is made for every set of acting effects, drive, number of nodes and of curvatures. `advance` does what the
compiled kernel does, on a table of base motions; `swim` makes eq. 20 itself, so that a million gaits need no table:
angle, rate and acceleration from one sine and cosine a wave, its harmonics by the addition theorem.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass

import numpy as np

from affine_model.advance import CONSTANTS, Drive, arm_arrays
from affine_model.arm import Arm, parameter_rows
from affine_model.kernel.generate import Parts, array_sizes, bodies, filled_template, sizes_of
from affine_model.kernel.scalars import assigned, pruned, straightened
from tentacle.gait import COEFFICIENT, MULTIPLE, TERM
from tentacle.specimen import Cone, Specimen

WAVES = 3
_TYPES = {
    "wp.array2d(dtype=wp.float64)": "parameters start start_rate start_past summary gait outcome",
    "wp.array3d(dtype=wp.float64)": "base start_store out_u out_rate out_force out_past",
    "wp.array4d(dtype=wp.float64)": "out_store",
    "wp.array(dtype=wp.float64)": "s area second_moment width perimeter Lw servo rail t0 limits",
    "wp.float64": "h bandwidth " + " ".join(CONSTANTS),
    "wp.int32": "steps age iterations stride average_from",
}
TYPE_OF = {name: kind for kind, names in _TYPES.items() for name in names.split()}
_ARM = [*CONSTANTS, "s", "area", "second_moment", "width", "perimeter", "Lw", "servo", "rail"]
_STATE = ["h", "steps", "age", "t0", "start", "start_rate", "start_past", "start_store", "iterations", "average_from"]
_KEPT = ["stride", "out_u", "out_rate", "out_force", "out_past", "out_store", "summary"]
ADVANCE = ["parameters", *_ARM, "base", *_STATE, *_KEPT]
SWIM = ["parameters", *_ARM, "gait", "limits", "bandwidth", *_STATE, "outcome"]


@dataclass(frozen=True)
class Variant:
    """What a kernel is made for: numbers of nodes and curvatures; of every effect of the catalogue, whether it acts; a
    servo turns the base (else it turns as prescribed); it slides on a rail (else it is clamped); how much the clamp
    gives (affine_model.arm.Arm.clamp).
    """

    nodes: int
    order: int
    active: tuple[bool, ...]
    free_theta: bool
    free_rail: bool
    clamp: float = 0.0


_GAIT_SIZES = {
    "strength": (len(TERM),), "omega": (WAVES,), "phase_sine": (WAVES,), "phase_cosine": (WAVES,), "peak": (3,),
    "settled": (), "hardest": (), "phase_t": (),
}  # fmt: skip


def _gait_command() -> str:
    """Eq. 20 at t: theta and its first two derivatives into `command`."""
    text = ["for b in range(BLOCK):", *(f"    command[{k}, b] = 0.0" for k in range(3))]
    for wave in range(WAVES):
        harmonics = [h for h in range(len(TERM)) if TERM[h] == wave]
        text.append(f"    sine_1, cosine_1 = sincos(omega[{wave}, b] * t[b])")
        highest = int(max(MULTIPLE[h] for h in harmonics))
        for m in range(2, highest + 1):
            text.append(f"    sine_{m} = sine_{m - 1} * cosine_1 + cosine_{m - 1} * sine_1")
            text.append(f"    cosine_{m} = cosine_{m - 1} * cosine_1 - sine_{m - 1} * sine_1")
        for h in harmonics:
            m = int(MULTIPLE[h])
            text += [
                f"    rate = {float(m)} * omega[{wave}, b]",
                f"    ahead_{h} = sine_{m} * phase_cosine[{wave}, b] + cosine_{m} * phase_sine[{wave}, b]",
                f"    aside_{h} = cosine_{m} * phase_cosine[{wave}, b] - sine_{m} * phase_sine[{wave}, b]",
                f"    command[0, b] += strength[{h}, b] * ahead_{h}",
                f"    command[1, b] += strength[{h}, b] * rate * aside_{h}",
                f"    command[2, b] -= strength[{h}, b] * rate * rate * ahead_{h}",
            ]
    return "\n".join(f"        {line}" for line in text)


def _gait_start() -> str:
    """Strengths of the harmonics, faded towards the bandwidth; then a pass that scales them to the servo's limits."""
    text = ["    for b in range(BLOCK):"]
    for wave in range(WAVES):
        text += [
            f"        omega[{wave}, b] = gait[first + b, {WAVES + wave}]",
            f"        wave_sine, wave_cosine = sincos(gait[first + b, {2 * WAVES + wave}])",
            f"        phase_sine[{wave}, b] = wave_sine",
            f"        phase_cosine[{wave}, b] = wave_cosine",
        ]
    for h, (term, multiple, coefficient) in enumerate(zip(TERM, MULTIPLE, COEFFICIENT, strict=True)):
        text.append(f"        strength[{h}, b] = gait[first + b, {term}] * {float(coefficient)!r}")
        if multiple > 1:
            share = f"min({float(multiple)} * abs(omega[{term}, b]) / (6.283185307179586 * bandwidth), 1.0)"
            text += [
                f"        fade_{h} = math.cos(1.5707963267948966 * {share})",
                f"        strength[{h}, b] = strength[{h}, b] * fade_{h} * fade_{h}",
            ]
    text += ["    for step in range(steps):", "        for b in range(BLOCK):"]
    text += [
        "            t[b] = t0[lane[b]] + (float(step) + 0.5) * h",
        _gait_command(),
        "        for b in range(BLOCK):",
    ]
    text += [f"            peak[{k}, b] = max(peak[{k}, b], abs(command[{k}, b]))" for k in range(3)]
    text += ["    for b in range(BLOCK):", "        scale = 1.0"]
    text += [f"        scale = min(scale, limits[{k}] / max(peak[{k}, b], 1e-300))" for k in range(3)]
    text += [f"        strength[{h}, b] = strength[{h}, b] * scale" for h in range(len(TERM))]
    text += ["        outcome[5, first + b] = scale"]
    return "\n".join(text)


_SWIM_KEPT = """\
        for b in range(BLOCK):
            if (step + 1) % 2 == 0:
                if step >= average_from:
                    hardest[b] = max(hardest[b], abs(0.5 * window[3, b]))
                window[3, b] = 0.0
            if step + 1 == average_from:
                settled[b] = u[n + 1, b]
"""
_SWIM_SUMMARY = """\
    kept = max(steps - average_from, 1)
    for b in range(BLOCK):
        outcome[0, first + b] = -sums[1, b] / float(kept)
        outcome[1, first + b] = (settled[b] - u[n + 1, b]) / (float(kept) * h)
        outcome[2, first + b] = sums[2, b] / float(kept)
        outcome[3, first + b] = hardest[b]
        outcome[4, first + b] = diverged[b]
"""


def warp_source(variant: Variant, swim: bool) -> str:
    """The module's text: `sincos` and the kernel `advance` or `swim`."""
    parts = Parts(_gait_command(), _SWIM_KEPT, _SWIM_SUMMARY, _gait_start()) if swim else Parts()
    sizes = {**array_sizes(variant.nodes, variant.order), "lane": (), "base_lane": (), **(_GAIT_SIZES if swim else {})}
    arrays = set(sizes)
    constants = {
        **sizes_of(variant.order, False), "NODES": variant.nodes, "BLOCK": 1, "BODIES": bodies(), "b": 0,
        "own_base": False,
        "free_theta": variant.free_theta, "free_rail": variant.free_rail,
        "base.shape[0]": 3,
        "parameters.shape[0]": len(parameter_rows()), "start_store.shape[0]": sizes["store"][0],
        **{f"active[{k}]": acts for k, acts in enumerate(variant.active)}, **_rule(variant),
    }  # fmt: skip
    if swim:
        constants["stride"] = 0  # no trajectory is kept
    tree = ast.parse(filled_template(variant.order, parts))
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    helper, whole = functions["sincos"], functions["advance"]
    body = [statement for statement in whole.body if not _of_numba(statement)]
    straight = pruned(straightened(body, constants, arrays))
    declared = [name for name in assigned(straight, arrays) if name not in ("lane_", "base_lane_")]
    lines = [f"{name} = wp.float64(0.0)" for name in declared]
    text = ast.unparse(ast.fix_missing_locations(ast.Module(_counting(straight), [])))
    own = ast.unparse(ast.fix_missing_locations(ast.Module(straightened(helper.body[1:], {}, set()), [])))
    names = SWIM if swim else ADVANCE
    head = ",\n    ".join(f"{name}: {TYPE_OF[name]}" for name in names)
    return "\n".join(
        [
            '"""Generated by affine_model.kernel.warp_source; do not edit."""',
            "import warp as wp\n\n",
            "@wp.func",
            "def sincos(angle: wp.float64):",
            _indented(own) + "\n\n",
            "@wp.kernel(enable_backward=False)",
            f"def {'swim' if swim else 'advance'}(\n    {head},\n):",
            _indented("block = wp.tid()\n" + "\n".join(lines) + "\n" + text),
            "",
        ]
    )


def _rule(variant: Variant) -> dict[str, float]:
    """The elements of quadrature and bases as numbers in the text: they are the same for every arm with this clamp, so
    they need not be loaded.
    """
    specimen = Specimen(Cone(1.0, 1.0), 1.0, 1.0, clamp_length=variant.clamp)
    arm = Arm(specimen, order=variant.order, nodes=variant.nodes - (variant.clamp > 0.0))
    known = arm_arrays(arm, Drive())
    return {
        f"{name}[{', '.join(map(str, place))}]": float(value)
        for name in ("W", "w", "bending", "A", "A_end", "C", "WA", "wA")
        for place, value in np.ndenumerate(known[name])
    }


def _of_numba(statement: ast.stmt) -> bool:
    """Allocations and the tuple of constants, which a thread does not need."""
    text = ast.unparse(statement)
    return "np.empty" in text or "np.zeros" in text or "= constants" in text or text.startswith("own_base")


class _Counters(ast.NodeTransformer):
    """Counters that change while it runs begin as integers of Warp."""

    def visit_Assign(self, node: ast.Assign) -> ast.stmt:
        if isinstance(node.value, ast.Constant) and isinstance(node.value.value, int):
            node.value = ast.Call(ast.Attribute(ast.Name("wp", ast.Load()), "int32", ast.Load()), [node.value], [])
        return node


def _counting(body: list[ast.stmt]) -> list[ast.stmt]:
    return _Counters().visit(ast.Module(body, [])).body


def _indented(text: str) -> str:
    return "\n".join(f"    {line}" for line in text.splitlines())

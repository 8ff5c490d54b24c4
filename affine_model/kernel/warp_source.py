"""Writes the source of the Warp kernels (NVIDIA Warp): one individual a thread, from the text that numba compiles.

One kernel is made for every set of acting effects, drive, number of nodes and of curvatures. `advance` does what the
compiled kernel does, on a table of base motions; `swim` makes eq. 20 itself, so that a million gaits need no table:
angle, rate and acceleration from one sine and cosine a wave, its harmonics by the addition theorem.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass

import numpy as np

from affine_model.advance import CONSTANTS, Drive, arm_arrays
from affine_model.arm import Arm, parameter_rows
from affine_model.kernel.generate import Parts, array_sizes, bodies, filled_template, template_constants
from affine_model.kernel.linear_form import LinearForms
from affine_model.kernel.partial_evaluation import PartialEvaluation, numbered
from affine_model.kernel.scalars import assigned, pruned, straightened
from affine_model.kernel.warp_gait import GAIT_SIZES, gait_parts
from tentacle.law.in_use import follows_laws
from tentacle.specimen import Cone, Specimen

_TYPES = {
    "wp.array2d(dtype=wp.float64)": "parameters start start_rate start_past summary gait outcome",
    "wp.array3d(dtype=wp.float64)": "base start_store out_u out_rate out_force out_past",
    "wp.array4d(dtype=wp.float64)": "out_store",
    "wp.array(dtype=wp.float64)": "t0",
    "wp.int32": "steps age iterations stride average_from",
}
TYPE_OF = {name: kind for kind, names in _TYPES.items() for name in names.split()}
_START = ["t0", "start", "start_rate", "start_past", "start_store"]
ADVANCE = ["parameters", "base", "steps", "age", *_START, "iterations", "average_from", "stride", "out_u", "out_rate",
           "out_force", "out_past", "out_store", "summary"]  # fmt: skip
SWIM = ["gait", "steps", "iterations", "average_from", "outcome"]
_RULE = ["W", "w", "bending", "A", "A_end", "C", "WA", "wA"]
_ARM = [*CONSTANTS, "s", "area", "second_moment", "width", "perimeter", "Lw", *_RULE, "servo", "rail", "h"]
ADVANCE_UNIFORMS = _ARM
SWIM_UNIFORMS = [*_ARM, "parameters", "limits", "bandwidth"]


@dataclass(frozen=True)
class Variant:
    """What a kernel is made for: numbers of nodes and curvatures; of every effect of the catalogue, whether it acts; a
    servo turns the base (else it turns as prescribed); it slides on a rail (else it is clamped); the clamp
    gives (Arm.clamp > 0); the base travels (nine rows of its table instead of three).
    """

    nodes: int
    order: int
    active: tuple[bool, ...]
    free_theta: bool
    free_rail: bool
    gives: bool = False
    travels: bool = False


@dataclass(frozen=True)
class WarpText:
    """A kernel as Warp's Python, and the text of the function `uniforms`, which gives the table that it reads and the
    outcomes of the tests that were decided in it.
    """

    kernel: str
    uniforms: str


@follows_laws
def _straight(variant: Variant, swim: bool) -> tuple[list[ast.stmt], list[str]]:
    """The kernel's body on scalars, and the variables that the block's arrays became."""
    parts = gait_parts() if swim else Parts()
    sizes = {**array_sizes(variant.nodes, variant.order), "lane": (), "base_lane": (), **(GAIT_SIZES if swim else {})}
    constants = {
        **template_constants(variant.order, False), "NODES": variant.nodes, "BLOCK": 1, "BODIES": bodies(), "b": 0,
        "own_base": False,
        "free_theta": variant.free_theta, "free_rail": variant.free_rail,
        "base.shape[0]": 9 if variant.travels else 3,
        "parameters.shape[0]": len(parameter_rows()), "start_store.shape[0]": sizes["store"][0],
        **{f"active[{k}]": acts for k, acts in enumerate(variant.active)}, **_rule(variant),
        **({"stride": 0, "age": 0} if swim else {}),  # a gait starts at rest; no trajectory is kept
    }  # fmt: skip
    tree = ast.parse(filled_template(variant.order, parts))
    whole = next(node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "advance")
    body = straightened([statement for statement in whole.body if not _of_numba(statement)], constants, set(sizes))
    return body, [name for name in assigned(body, set(sizes)) if name not in ("lane_", "base_lane_")]


@follows_laws
def warp_text(variant: Variant, swim: bool, outcomes: tuple[bool, ...]) -> WarpText:
    """The kernel `advance` or `swim` for these outcomes of the tests on uniform values."""
    body, own = _straight(variant, swim)
    names, roots = (SWIM, SWIM_UNIFORMS) if swim else (ADVANCE, ADVANCE_UNIFORMS)
    forms = LinearForms(roots, _START if swim else (), outcomes)
    rewritten, values = numbered(pruned(PartialEvaluation(forms).of(body, own)))
    text = ast.unparse(ast.fix_missing_locations(ast.Module(_counting(rewritten), [])))
    start = [f"{name} = wp.float64(0.0)" for name in own if re.search(rf"\b{name}\b", text)]
    head = ",\n    ".join([*(f"{name}: {TYPE_OF[name]}" for name in names), "U: Table"])
    kernel = [
        _HEAD.format(count=len(values)),
        f"def {'swim' if swim else 'advance'}(\n    {head},\n):",
        _indented("\n".join(["block = wp.tid()", *start, text])),
        "",
    ]
    return WarpText("\n".join(kernel), forms.table.source(roots, values))


_HEAD = '''\
"""Generated by affine_model.kernel.warp_source; do not edit."""
import warp as wp

Table = wp.types.vector(length={count}, dtype=wp.float64)


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    return ::rsqrt(x);
#else
    return 1.0 / ::sqrt(x);
#endif
""")
def inverse_root(x: wp.float64) -> wp.float64:
    ...


@wp.kernel(enable_backward=False)'''


def _rule(variant: Variant) -> dict[str, float]:
    """The elements of quadrature and bases as numbers in the text: they are the same for every arm, so they need not be
    loaded. Behind a clamp that gives they depend on how much it gives, which a fit may move: there they are read.
    """
    if variant.gives:
        return {}
    arm = Arm(Specimen(Cone(1.0, 1.0), 1.0, 1.0), order=variant.order, nodes=variant.nodes)
    known = arm_arrays(arm, Drive())
    return {
        f"{name}[{', '.join(map(str, place))}]": float(value)
        for name in _RULE
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

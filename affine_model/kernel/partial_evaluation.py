"""Takes out of a kernel's text what is the same for all threads: it is computed once, and read as a constant.

The walk goes through straight code (affine_model.kernel.scalars) and knows at each statement which variables are
numbers or uniform values. Expressions become linear combinations of what differs between threads
(affine_model.kernel.linear_form); branches on uniform values are decided. A thread then neither computes nor keeps what
is uniform. Compilers call it partial evaluation (Jones, Gomard and Sestoft 1993, ch. 1).
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterable
from typing import ClassVar, cast

from affine_model.kernel.linear_form import MARK, LinearForms, assign, binary, function_of, read
from affine_model.kernel.scalars import COUNTERS, is_integer
from affine_model.kernel.uniform import Coefficient, Linear
from affine_model.sincos import sincos

_QUADRANT = """\
turns = wp.rint(angle * wp.float64(0.6366197723675814))
quadrant = wp.int32(turns)
rest = angle - turns * wp.float64(1.5707963267341256) - turns * wp.float64(6.077100506506192e-11)
rest_2 = rest * rest
"""
_TURNED = """\
odd = (quadrant & 1) == 1
{sine} = wp.where(odd, even_cosine, even_sine)
{cosine} = wp.where(odd, even_sine, even_cosine)
{sine} = wp.where((quadrant & 2) == 2, -{sine}, {sine})
{cosine} = wp.where(((quadrant + 1) & 2) == 2, -{cosine}, {cosine})
"""


class _Renamed(ast.NodeTransformer):
    """The variables of affine_model.sincos under names that no other part of a kernel has."""

    _NAMES: ClassVar = {"y": "rest", "yy": "rest_2", "sine": "even_sine", "cosine": "even_cosine"}

    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.Name(self._NAMES.get(node.id, node.id), node.ctx)


def _sine_and_cosine() -> list[ast.stmt]:
    """Statements that make sine and cosine of `angle` up to their quadrant, by affine_model.sincos's polynomials."""
    function = cast(ast.FunctionDef, ast.parse(inspect.getsource(sincos)).body[0])
    sums = [s for s in function.body if isinstance(s, ast.Assign) and ast.unparse(s.targets[0]) in ("sine", "cosine")]
    return [*ast.parse(_QUADRANT).body, *(_Renamed().visit(statement) for statement in sums)]


class PartialEvaluation:
    """One walk through the statements of a kernel."""

    def __init__(self, forms: LinearForms) -> None:
        self._forms = forms

    def of(self, body: list[ast.stmt], start_at_zero: Iterable[str]) -> list[ast.stmt]:
        """The body rewritten, with marked names where a uniform value is read (see numbered)."""
        self._forms.known = dict.fromkeys(start_at_zero, 0.0)
        return self._block(body)

    def _block(self, statements: list[ast.stmt]) -> list[ast.stmt]:
        return [one for statement in statements for one in self._statement(statement)]

    def _statement(self, statement: ast.stmt) -> list[ast.stmt]:
        if isinstance(statement, ast.For):
            self._forget(statement.body)
            loop = ast.For(statement.target, statement.iter, self._block(statement.body), [])
            self._forget(statement.body)
            return [loop]
        if isinstance(statement, ast.If):
            return self._branch(statement)
        if isinstance(statement, ast.AugAssign):
            target = cast(ast.Name, statement.target)
            if target.id in COUNTERS:
                return [statement]
            return self._assigned(target, ast.BinOp(read(target.id), statement.op, statement.value))
        if isinstance(statement, ast.Assign):
            return self._assigned(statement.targets[0], statement.value)
        return [statement]

    def _assigned(self, target: ast.expr, value: ast.expr) -> list[ast.stmt]:
        if isinstance(target, ast.Subscript):
            return [ast.Assign([target], self._forms.written(self._forms.value(value)))]
        if isinstance(target, ast.Tuple):
            sine, cosine = (cast(ast.Name, part).id for part in target.elts)
            return self._angle(sine, cosine, self._forms.value(cast(ast.Call, value).args[0]))
        name = cast(ast.Name, target).id
        if function_of(value) == "int32":
            return [assign(name, value)]
        if name in COUNTERS or is_integer(value):
            return [self._counted(name, value)]
        if function_of(value) == "sqrt":
            return self._root(name, self._forms.value(cast(ast.Call, value).args[0]))
        return self._set(name, self._forms.value(value))

    def _set(self, name: str, found: Linear) -> list[ast.stmt]:
        self._drop(name)
        if found.uniform:
            self._forms.known[name] = found.offset
        return [assign(name, self._forms.written(found))]

    def _counted(self, name: str, value: ast.expr) -> ast.stmt:
        if function_of(value) == "where":
            test, *parts = cast(ast.Call, value).args
            outcome = self._forms.test(test)
            value = parts[0 if outcome else 1] if isinstance(outcome, bool) else value
        self._forms.counters.pop(name, None)
        if isinstance(value, ast.Constant):
            self._forms.counters[name] = cast(int, value.value)
        return assign(name, value)

    def _angle(self, sine: str, cosine: str, angle: Linear) -> list[ast.stmt]:
        """Sine and cosine of an angle, written out."""
        if angle.uniform:
            found = [Linear(self._forms.table.named(f"np.{f}({angle.offset})")) for f in ("sin", "cos")]
            return [*self._set(sine, found[0]), *self._set(cosine, found[1])]
        text = [assign("angle", self._forms.written(angle)), *self._block(_sine_and_cosine())]
        self._drop(sine)
        self._drop(cosine)
        return [*text, *ast.parse(_TURNED.format(sine=sine, cosine=cosine)).body]

    def _root(self, name: str, radicand: Linear) -> list[ast.stmt]:
        """sqrt(x) as x times its inverse, which serves the divisions by it too."""
        if radicand.uniform:
            return self._set(name, Linear(self._forms.table.named(f"np.sqrt({radicand.offset})")))
        self._drop(name)
        square, inverse = f"square_{name}", f"inverse_{name}"
        self._forms.inverse[name] = inverse
        inverted = ast.Call(read("inverse_root"), [read(square)], [])
        return [
            assign(square, self._forms.written(radicand)),
            assign(inverse, inverted),
            assign(name, binary(read(square), ast.Mult(), read(inverse))),
        ]

    def _branch(self, statement: ast.If) -> list[ast.stmt]:
        test = self._forms.test(statement.test)
        if isinstance(test, bool):
            return self._block(statement.body if test else statement.orelse)
        before = dict(self._forms.known)
        body = self._block(statement.body)
        after, self._forms.known = self._forms.known, before
        other = self._block(statement.orelse)
        self._forms.known = {name: value for name, value in self._forms.known.items() if after.get(name) == value}
        self._forms.inverse = {}
        return [ast.If(test, body, other)] if body or other else []

    def _drop(self, name: str) -> None:
        self._forms.known.pop(name, None)
        self._forms.inverse.pop(name, None)

    def _forget(self, body: list[ast.stmt]) -> None:
        """What a loop assigns is known neither in it nor after it."""
        for node in (node for statement in body for node in ast.walk(statement)):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                self._drop(node.id)
                self._forms.counters.pop(node.id, None)


class _Numbered(ast.NodeTransformer):
    """Puts places of the table of uniform values for their names."""

    def __init__(self) -> None:
        self.read: dict[str, int] = {}

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if not node.id.startswith(MARK):
            return node
        place = self.read.setdefault(node.id.removeprefix(MARK), len(self.read))
        return ast.Subscript(read("U"), ast.Constant(place), ast.Load())


def numbered(body: list[ast.stmt]) -> tuple[list[ast.stmt], list[Coefficient]]:
    """The body reading U[0], U[1], ..., and the uniform values that these are."""
    numbering = _Numbered()
    found = numbering.visit(ast.Module(body, [])).body
    return found, list(numbering.read)

"""Expressions of a kernel as linear combinations with uniform coefficients, and as text again.

    length * (w_0 x_0 + w_1 x_1)   ->   k_0 x_0 + k_1 x_1,   k_0 = length w_0, k_1 = length w_1

A term is one fused multiplication and addition, whose coefficient a GPU reads as an operand of the instruction itself.
"""

from __future__ import annotations

import ast
import struct
from collections.abc import Iterable
from typing import cast

from affine_model.kernel.scalars import is_integer
from affine_model.kernel.uniform import Coefficient, Linear, Uniforms, negative, opposite

MARK = "uniform:"  # before the name of a uniform value, where a kernel reads it
_ON_HOST = {name: name for name in ("sqrt", "exp", "tanh", "sin", "cos", "log", "floor")} | {"pow": "power"}


def binary(left: ast.expr, operator: ast.operator, right: ast.expr) -> ast.expr:
    """left operator right."""
    return ast.BinOp(left, operator, right)


def read(name: str) -> ast.Name:
    """The variable where it is read."""
    return ast.Name(name, ast.Load())


def _call(name: str, *arguments: ast.expr) -> ast.expr:
    return ast.Call(ast.Attribute(read("wp"), name, ast.Load()), list(arguments), [])


def assign(name: str, value: ast.expr) -> ast.stmt:
    """name = value."""
    return ast.Assign([ast.Name(name, ast.Store())], value)


def _short(value: float) -> bool:
    """Whether an instruction can hold the double itself: its lower half is zero."""
    return struct.pack("<d", value)[:4] == bytes(4)


def function_of(node: ast.expr) -> str:
    """The name of the function that the expression calls, without Warp's prefix; empty if it is no call."""
    return ast.unparse(node.func).removeprefix("wp.") if isinstance(node, ast.Call) else ""


class LinearForms:
    """Expressions as linear combinations, with what is known at a statement.

    roots: the arguments that are uniform; zeros: those that hold only zeros; outcomes: of the tests on uniform values,
    in the order in which they are met (false where not given). known: the variables that are uniform at this place;
    counters: the integers that are known; inverse: of a root, the variable that holds its inverse.
    """

    def __init__(self, roots: Iterable[str], zeros: Iterable[str], outcomes: tuple[bool, ...]) -> None:
        self.table = Uniforms()
        self._roots, self._zeros, self._outcomes = frozenset(roots), frozenset(zeros), outcomes
        self.known: dict[str, Coefficient] = {}
        self.counters: dict[str, int] = {}
        self.inverse: dict[str, str] = {}

    def value(self, node: ast.expr) -> Linear:
        """The expression as a linear combination."""
        if isinstance(node, ast.Constant) and isinstance(node.value, float):
            return Linear(node.value)
        if isinstance(node, ast.Name) and node.id in self.known:
            return Linear(self.known[node.id])
        if isinstance(node, ast.Name) and node.id in self._roots:
            return Linear(self.table.named(node.id))
        if isinstance(node, ast.Subscript):
            return self._element(node)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            return self._scaled(-1.0, self.value(node.operand))
        if isinstance(node, ast.BinOp) and not is_integer(node):
            return self._operation(node)
        if isinstance(node, ast.Call):
            return self._function(node)
        return Linear(0.0, ((1.0, node),))

    def _element(self, node: ast.Subscript) -> Linear:
        name = ast.unparse(node.value)
        places = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        fixed = [ast.unparse(place) for place in places if isinstance(place, ast.Constant)]
        if name in self._zeros:
            return Linear()
        if name in self._roots:
            return Linear(self.table.named(f"{name}[{', '.join(fixed)}]"))
        return Linear(0.0, ((1.0, node),))

    def _operation(self, node: ast.BinOp) -> Linear:
        left, right = self.value(node.left), self.value(node.right)
        if isinstance(node.op, ast.Add):
            return self._sum(left, right)
        if isinstance(node.op, ast.Sub):
            return self._sum(left, self._scaled(-1.0, right))
        if isinstance(node.op, ast.Mult):
            return self._product(left, right)
        return self._quotient(left, right)

    def _sum(self, left: Linear, right: Linear) -> Linear:
        return Linear(self.table.sum(left.offset, right.offset), (*left.terms, *right.terms))

    def _scaled(self, share: Coefficient, of: Linear) -> Linear:
        """share times a linear combination: term by term where that takes no more operations."""
        if share == 0.0:
            return Linear()
        free = all(c not in (1.0, -1.0) or not isinstance(factor, ast.BinOp) for c, factor in of.terms)
        if share in (1.0, -1.0) or len(of.terms) < 2 or free:
            terms = tuple((self.table.product(share, c), factor) for c, factor in of.terms)
            return Linear(self.table.product(share, of.offset), terms)
        return Linear(0.0, ((share, self.written(of)),))

    def _single(self, of: Linear) -> tuple[Coefficient, ast.expr]:
        """The linear combination as one coefficient and one factor."""
        if of.offset == 0.0 and len(of.terms) == 1:
            return of.terms[0]
        return 1.0, self.written(of)

    def _product(self, left: Linear, right: Linear) -> Linear:
        if left.uniform or right.uniform:
            return self._scaled(left.offset, right) if left.uniform else self._scaled(right.offset, left)
        (a, x), (b, y) = self._single(left), self._single(right)
        return Linear(0.0, ((self.table.product(a, b), binary(x, ast.Mult(), y)),))

    def _quotient(self, left: Linear, right: Linear) -> Linear:
        if right.uniform:
            return self._scaled(self.table.inverse(right.offset), left)
        b, y = self._single(right)
        inverse = self.table.inverse(b)
        known = self.inverse.get(y.id) if isinstance(y, ast.Name) else None
        if known is not None:
            return self._product(left, Linear(0.0, ((inverse, read(known)),)))
        a, x = (left.offset, self._constant(1.0)) if left.uniform else self._single(left)
        return Linear(0.0, ((self.table.product(a, inverse), binary(x, ast.Div(), y)),))

    def _function(self, node: ast.Call) -> Linear:
        name, argument = function_of(node), node.args[0]
        if name == "float64" and isinstance(argument, ast.Constant):
            return Linear(float(cast(float, argument.value)))
        if is_integer(node) or (name == "float64" and is_integer(argument)):
            return Linear(0.0, ((1.0, node),))
        if name == "float64":
            return self.value(argument)
        if name == "where":
            test = self.test(argument)
            if isinstance(test, bool):
                return self.value(node.args[1 if test else 2])
            parts = [self.written(self.value(part)) for part in node.args[1:]]
            return Linear(0.0, ((1.0, _call("where", test, *parts)),))
        given = [self.value(one) for one in node.args]
        if all(one.uniform for one in given):
            here = f"np.{_ON_HOST[name]}" if name in _ON_HOST else name
            return Linear(self.table.named(f"{here}({', '.join(str(one.offset) for one in given)})"))
        return Linear(0.0, ((1.0, ast.Call(node.func, [self.written(one) for one in given], [])),))

    def test(self, node: ast.expr) -> ast.expr | bool:
        """A test as the kernel makes it, or its outcome where it is uniform."""
        if isinstance(node, ast.BoolOp):
            parts = [self.test(part) for part in node.values]
            decides = isinstance(node.op, ast.Or)
            left = [part for part in parts if not isinstance(part, bool)]
            if decides in parts or not left:
                return decides if decides in parts else not decides
            return left[0] if len(left) == 1 else ast.BoolOp(node.op, left)
        if not isinstance(node, ast.Compare):
            return node
        one, other = node.left, node.comparators[0]
        if is_integer(one) and is_integer(other):
            at_least = isinstance(node.ops[0], ast.GtE) and isinstance(other, ast.Name)
            return True if at_least and self.counters.get(cast(ast.Name, other).id) == 0 else node  # none is negative
        left, right = self.value(one), self.value(other)
        if not (left.uniform and right.uniform):
            return ast.Compare(self.written(left), node.ops, [self.written(right)])
        self.table.tests.append(ast.unparse(ast.Compare(read(str(left.offset)), node.ops, [read(str(right.offset))])))
        place = len(self.table.tests) - 1
        return self._outcomes[place] if place < len(self._outcomes) else False

    def _constant(self, value: Coefficient) -> ast.expr:
        if isinstance(value, float) and _short(value):
            return _call("float64", ast.Constant(value))
        return read(f"{MARK}{value}")

    def written(self, of: Linear) -> ast.expr:
        """The linear combination as an expression: what is only added first, then one fused operation a term."""
        if of.uniform:
            return self._signed(of.offset)
        alone = [term for term in of.terms if term[0] in (1.0, -1.0) and not isinstance(term[1], ast.BinOp)]
        ordered = [*alone, *(term for term in of.terms if all(term is not one for one in alone))]
        if of.offset == 0.0 and negative(ordered[0][0]):
            first = next((k for k, term in enumerate(ordered) if not negative(term[0])), 0)
            ordered.insert(0, ordered.pop(first))
        whole = None if of.offset == 0.0 else self._signed(of.offset)
        for coefficient, factor in ordered:
            whole = self._added(whole, coefficient, factor)
        assert whole is not None
        return whole

    def _signed(self, value: Coefficient) -> ast.expr:
        size = self._constant(opposite(value) if negative(value) else value)
        return ast.UnaryOp(ast.USub(), size) if negative(value) else size

    def _added(self, whole: ast.expr | None, coefficient: Coefficient, factor: ast.expr) -> ast.expr:
        size = opposite(coefficient) if negative(coefficient) else coefficient
        term = factor if size == 1.0 else binary(self._constant(size), ast.Mult(), factor)
        if whole is None:
            return ast.UnaryOp(ast.USub(), term) if negative(coefficient) else term
        return binary(whole, ast.Sub() if negative(coefficient) else ast.Add(), term)

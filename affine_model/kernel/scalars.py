"""From the template to one individual a thread: straight code on scalars, without arrays, lanes or flags.

The text that numba compiles for a block of lanes is rewritten for one lane. Every loop with known bounds is written
out, every array element becomes a variable (which a compiler can keep in a register), and every branch on the acting
effects and the drive is decided here. The result is Warp's dialect of Python.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from copy import deepcopy
from typing import Any, cast

Constants = Mapping[str, Any]

_FUNCTIONS = {
    "math.sqrt": "sqrt", "math.exp": "exp", "math.tanh": "tanh", "math.sin": "sin", "math.cos": "cos",
    "math.log": "log", "np.floor": "floor", "abs": "abs", "min": "min", "max": "max",
}  # fmt: skip
COUNTERS = frozenset({
    "step", "steps", "iteration", "iterations", "rounds", "cautious", "stride", "average_from", "age", "stored", "kept",
    "first", "count", "block", "lane_", "base_lane_",
})  # fmt: skip
_OPERATORS: dict[type, Any] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.Eq: lambda a, b: a == b,
    ast.Gt: lambda a, b: a > b,
    ast.Lt: lambda a, b: a < b,
}


def _warp(name: str) -> ast.expr:
    return ast.Attribute(ast.Name("wp", ast.Load()), name, ast.Load())


def _double(value: float) -> ast.expr:
    return ast.Call(_warp("float64"), [ast.Constant(value)], [])


def is_integer(node: ast.expr) -> bool:
    """Whether it is an integer: made of whole numbers and of counters."""
    if isinstance(node, ast.BinOp):
        return is_integer(node.left) and is_integer(node.right)
    if isinstance(node, ast.Call):
        return ast.unparse(node.func) in ("wp.min", "wp.max") and all(is_integer(argument) for argument in node.args)
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int)
    return isinstance(node, ast.Name) and node.id in COUNTERS


def _as_double(node: ast.expr) -> ast.expr:
    return _double(float(_known(node))) if isinstance(node, ast.Constant) else node


def _known(constant: ast.expr) -> Any:
    """The value of a constant."""
    return cast(Any, constant).value


class _Expressions(ast.NodeTransformer):
    """Expressions under known constants: folded where they are known, elements as variables, numbers as doubles."""

    def __init__(self, constants: Constants, arrays: set[str]) -> None:
        self._constants, self._arrays = constants, arrays

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if isinstance(node.ctx, ast.Load) and node.id in self._constants:
            return ast.Constant(self._constants[node.id])
        return node

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        return _double(node.value) if isinstance(node.value, float) else node

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        self.generic_visit(node)
        if isinstance(node.op, ast.BitAnd | ast.BitOr):
            return ast.BoolOp(ast.And() if isinstance(node.op, ast.BitAnd) else ast.Or(), [node.left, node.right])
        if isinstance(node.op, ast.Pow):
            return ast.Call(_warp("pow"), [_as_double(node.left), _as_double(node.right)], [])
        if not (is_integer(node.left) and is_integer(node.right)):
            node.left, node.right = _as_double(node.left), _as_double(node.right)
        return self._folded(node, node.op, node.left, node.right)

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        self.generic_visit(node)
        return self._folded(node, node.ops[0], node.left, node.comparators[0])

    def _folded(self, node: ast.expr, operator: ast.AST, left: ast.expr, right: ast.expr) -> ast.expr:
        if isinstance(left, ast.Constant) and isinstance(right, ast.Constant) and type(operator) in _OPERATORS:
            value = _OPERATORS[type(operator)](_known(left), _known(right))
            return _double(value) if isinstance(value, float) else ast.Constant(value)
        return node

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        self.generic_visit(node)
        decides = isinstance(node.op, ast.Or)
        open_ones = [value for value in node.values if not isinstance(value, ast.Constant)]
        if any(isinstance(value, ast.Constant) and bool(value.value) is decides for value in node.values):
            return ast.Constant(decides)
        if not open_ones:
            return ast.Constant(not decides)
        return open_ones[0] if len(open_ones) == 1 else ast.BoolOp(node.op, open_ones)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        self.generic_visit(node)
        if isinstance(node.op, ast.Not) and isinstance(node.operand, ast.Constant):
            return ast.Constant(not node.operand.value)
        if isinstance(node.op, ast.USub) and isinstance(node.operand, ast.Constant):
            return ast.Constant(-_known(node.operand))
        return node

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        self.generic_visit(node)
        if isinstance(node.test, ast.Constant):
            return node.body if node.test.value else node.orelse
        return ast.Call(_warp("where"), [node.test, node.body, node.orelse], [])

    def visit_Call(self, node: ast.Call) -> ast.expr:
        if isinstance(node.func, ast.Name) and node.func.id == "total":
            generator = cast(ast.GeneratorExp, node.args[0])
            loop = generator.generators[0]
            values = known_range(loop.iter, self._constants)
            assert values is not None
            name = cast(ast.Name, loop.target).id
            terms = [expression(generator.elt, {**self._constants, name: value}, self._arrays) for value in values]
            whole = terms[0] if terms else _double(0.0)
            for term in terms[1:]:
                whole = ast.BinOp(whole, ast.Add(), term)
            return whole
        text = ast.unparse(node.func)
        self.generic_visit(node)
        if text == "float":
            return ast.Call(_warp("float64"), node.args, [])
        return ast.Call(_warp(_FUNCTIONS[text]), node.args, []) if text in _FUNCTIONS else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        text = ast.unparse(node)
        if text in self._constants:  # a flag, or the extent of an array
            return ast.Constant(self._constants[text])
        self.generic_visit(node)
        known = self._constants.get(ast.unparse(node))
        if isinstance(known, float):
            return _double(known)
        if not (isinstance(node.value, ast.Name) and node.value.id in self._arrays):
            return node
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        places = [cast(ast.Constant, index).value for index in indices]
        name = "_".join([node.value.id, *map(str, places[:-1])])
        return ast.Name(name if places[:-1] else f"{name}_", node.ctx)


def expression(node: ast.expr, constants: Constants, arrays: set[str]) -> ast.expr:
    """A copy of the expression, folded."""
    return _Expressions(constants, arrays).visit(deepcopy(node))


def known_range(iterator: ast.expr, constants: Constants) -> range | None:
    """The values of range(...) or unrolled(...) with known bounds; None where it is known only when it runs."""
    if not (isinstance(iterator, ast.Call) and isinstance(iterator.func, ast.Name)):
        return None
    bounds = [expression(argument, constants, set()) for argument in iterator.args]
    if not all(isinstance(bound, ast.Constant) for bound in bounds):
        return None
    return range(*map(_known, bounds))


def straightened(body: list[ast.stmt], constants: Constants, arrays: set[str]) -> list[ast.stmt]:
    """The statements with known loops written out and known branches taken."""
    found: list[ast.stmt] = []
    for statement in body:
        if isinstance(statement, ast.For):
            found += _loop(statement, constants, arrays)
        elif isinstance(statement, ast.If):
            found += _branch(statement, constants, arrays)
        elif not isinstance(statement, ast.Pass):
            found.append(_Expressions(constants, arrays).visit(deepcopy(statement)))
    return found


def _loop(loop: ast.For, constants: Constants, arrays: set[str]) -> list[ast.stmt]:
    values, name = known_range(loop.iter, constants), cast(ast.Name, loop.target).id
    if values is not None:
        parts = [straightened(loop.body, {**constants, name: value}, arrays) for value in values]
        return [statement for part in parts for statement in part]
    inside = {key: value for key, value in constants.items() if key != name}
    iterator = expression(loop.iter, constants, arrays)
    return [ast.For(loop.target, iterator, straightened(loop.body, inside, arrays), [])]


def _branch(branch: ast.If, constants: Constants, arrays: set[str]) -> list[ast.stmt]:
    test = expression(branch.test, constants, arrays)
    if isinstance(test, ast.Constant):
        return straightened(branch.body if test.value else branch.orelse, constants, arrays)
    body, other = (straightened(part, constants, arrays) for part in (branch.body, branch.orelse))
    return [ast.If(test, body, other)] if body or other else []


class _Pruner(ast.NodeTransformer):
    """Drops assignments to variables that nothing reads."""

    def __init__(self, read: set[str]) -> None:
        self._read = read
        self.dropped = 0

    def _kept(self, node: ast.stmt, target: ast.expr) -> ast.stmt | None:
        if isinstance(target, ast.Name) and target.id not in self._read:
            self.dropped += 1
            return None
        return node

    def visit_Assign(self, node: ast.Assign) -> ast.stmt | None:
        return self._kept(node, node.targets[0])

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.stmt | None:
        return self._kept(node, node.target)

    def visit_If(self, node: ast.If) -> ast.stmt | None:
        self.generic_visit(node)
        return node if node.body or node.orelse else None


def pruned(body: list[ast.stmt]) -> list[ast.stmt]:
    """The statements without those that compute what nothing reads."""
    module = ast.Module(body, [])
    while True:
        read = {name.id for name in ast.walk(module) if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Load)}
        pruner = _Pruner(read)
        module = pruner.visit(module)
        if not pruner.dropped:
            return module.body


def assigned(body: list[ast.stmt], arrays: set[str]) -> list[str]:
    """The variables that elements of the arrays became, in order of their names."""
    names = {name.id for statement in body for name in ast.walk(statement) if isinstance(name, ast.Name)}
    return sorted(name for name in names if any(name == array or name.startswith(f"{array}_") for array in arrays))

"""From the template to what is compiled: loops over coordinates become straight code, arrays rows of one workspace.

Both help the compiler. If the place of every row is known, it sees that no arrays overlap. If the loop over the block
contains only arithmetic, it computes the whole block in vector registers.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from copy import deepcopy
from typing import cast

Shape = tuple[int, ...]


def _folded(node: ast.expr) -> ast.expr:
    """The expression with integer arithmetic on constants done."""
    if isinstance(node, ast.BinOp) and isinstance(node.left, ast.Constant) and isinstance(node.right, ast.Constant):
        a, b = node.left.value, node.right.value
        if isinstance(a, int) and isinstance(b, int) and isinstance(node.op, ast.Add | ast.Sub | ast.Mult):
            value = a + b if isinstance(node.op, ast.Add) else a - b if isinstance(node.op, ast.Sub) else a * b
            return ast.Constant(value)
    return node


def _sum(terms: list[ast.expr]) -> ast.expr:
    """The terms' sum; 0.0 of none."""
    whole = terms[0] if terms else ast.Constant(0.0)
    for term in terms[1:]:
        whole = ast.BinOp(whole, ast.Add(), term)
    return whole


class _Unroller(ast.NodeTransformer):
    """Replaces constants; repeats `for j in unrolled(...)` and the terms of `total(... for j in unrolled(...))`."""

    def __init__(self, constants: Mapping[str, int]) -> None:
        self._constants = dict(constants)

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if isinstance(node.ctx, ast.Load) and node.id in self._constants:
            return ast.Constant(self._constants[node.id])
        return node

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        self.generic_visit(node)
        return _folded(node)

    def _values(self, iterator: ast.expr) -> range | None:
        """The values of unrolled(...), None where the iterator is something else."""
        if not (isinstance(iterator, ast.Call) and isinstance(iterator.func, ast.Name)):
            return None
        if iterator.func.id != "unrolled":
            return None
        bounds = [cast(ast.Constant, self.visit(deepcopy(argument))).value for argument in iterator.args]
        return range(*cast(list[int], bounds))

    def _with(self, name: str, value: int) -> _Unroller:
        return _Unroller({**self._constants, name: value})

    def visit_For(self, node: ast.For) -> ast.stmt | list[ast.stmt]:
        values = self._values(node.iter)
        if values is None:
            self.generic_visit(node)
            return node if node.body else []
        name = cast(ast.Name, node.target).id
        body: list[ast.stmt] = []
        for value in values:
            for statement in node.body:
                found = self._with(name, value).visit(deepcopy(statement))
                body += found if isinstance(found, list) else [found]
        return body

    def visit_If(self, node: ast.If) -> ast.stmt | list[ast.stmt]:
        self.generic_visit(node)
        return node if node.body else []

    def visit_Call(self, node: ast.Call) -> ast.expr:
        if isinstance(node.func, ast.Name) and node.func.id == "total":
            generator = cast(ast.GeneratorExp, node.args[0])
            loop = generator.generators[0]
            values = self._values(loop.iter)
            assert values is not None
            name = cast(ast.Name, loop.target).id
            return _sum([self._with(name, value).visit(deepcopy(generator.elt)) for value in values])
        self.generic_visit(node)
        return node


class _Placer(ast.NodeTransformer):
    """Replaces name[i, j, b] of the arrays by work[place + i * stride + j, b]."""

    def __init__(self, shapes: Mapping[str, Shape]) -> None:
        self._shapes = shapes
        self._places: dict[str, int] = {}
        rows = 0
        for name, shape in shapes.items():
            self._places[name] = rows
            size = 1
            for extent in shape:
                size *= extent
            rows += size
        self.rows = rows

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        self.generic_visit(node)
        if not (isinstance(node.value, ast.Name) and node.value.id in self._shapes):
            return node
        name = node.value.id
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        *rows, lane = indices
        if len(rows) != len(self._shapes[name]):
            raise SyntaxError(f"{ast.unparse(node)}: {name} has {len(self._shapes[name])} indices before the lane")
        place: ast.expr = ast.Constant(0)
        for extent, index in zip(self._shapes[name], rows, strict=True):
            scaled = _folded(ast.BinOp(place, ast.Mult(), ast.Constant(extent)))
            nothing = isinstance(scaled, ast.Constant) and scaled.value == 0
            place = index if nothing else _folded(ast.BinOp(scaled, ast.Add(), index))
        place = _folded(ast.BinOp(ast.Constant(self._places[name]), ast.Add(), place))
        return ast.Subscript(ast.Name("work", ast.Load()), ast.Tuple([place, lane], ast.Load()), node.ctx)


class _Reader(ast.NodeTransformer):
    """Gives every subscript that no lane changes a name; held: its text -> its name, counted on from `first`."""

    def __init__(self, assigned: set[str], first: int) -> None:
        self.held: dict[str, str] = {}
        self._assigned, self._first = assigned, first

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        names = {name.id for name in ast.walk(node) if isinstance(name, ast.Name)}
        if isinstance(node.ctx, ast.Store) or names & self._assigned:
            self.generic_visit(node)
            return node
        text = ast.unparse(node)
        self.held.setdefault(text, f"held_{self._first + len(self.held)}")
        return ast.Name(self.held[text], ast.Load())


class _Hoister(ast.NodeTransformer):
    """Moves reads that are the same for all lanes in front of the loop over them: array[...] without the lane, outside
    `work`.
    """

    def __init__(self) -> None:
        self._count = 0

    def visit_For(self, node: ast.For) -> ast.stmt | list[ast.stmt]:
        if not (isinstance(node.target, ast.Name) and node.target.id == "b"):
            self.generic_visit(node)
            return node
        assigned = {
            name.id for name in ast.walk(node) if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)
        }
        if any(isinstance(inner, ast.For) for inner in ast.walk(node) if inner is not node):
            return node
        reader = _Reader(assigned, self._count)
        node.body = [reader.visit(statement) for statement in node.body]
        self._count += len(reader.held)
        text = "\n".join(f"{name} = {text}" for text, name in reader.held.items())
        return [*ast.parse(text).body, node]


def unrolled_source(template: str, constants: Mapping[str, int], shapes: Mapping[str, Shape]) -> str:
    """The template's text with the constants put in, its unrolled loops written out, and its arrays of the given
    shapes (without the lane) placed in the rows of one array `work`, whose number is the constant WORK_ROWS.
    """
    placer = _Placer(shapes)
    tree = _Unroller({**constants, "WORK_ROWS": placer.rows}).visit(ast.parse(template))
    return ast.unparse(ast.fix_missing_locations(_Hoister().visit(placer.visit(tree)))) + "\n"

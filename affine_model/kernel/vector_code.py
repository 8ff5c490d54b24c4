"""From the kernel's text to LLVM's source: what the lanes of a block compute becomes arithmetic on vectors.

The text is a small part of Python: numbers, arrays, `for ... in range(...)`, `if`. A loop over all lanes `b` whose body
is plain arithmetic on `array[..., b]` is written for `width` lanes at once, the processor's vector register; any other
loop runs lane by lane. A general compiler has to find out that this may be done; it takes most of its time.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import cast

from affine_model.kernel.arguments import Argument
from affine_model.kernel.instructions import Instructions, Value, double, whole


@dataclass(frozen=True)
class _Array:
    pointer: str
    kind: str
    extents: tuple[Value, ...]


def _carried(body: list[ast.stmt]) -> list[str]:
    """Names that a body adds to before it has set them: sums over the lanes."""
    known: set[str] = set()
    found: list[str] = []
    for statement in body:
        if isinstance(statement, ast.AugAssign) and isinstance(statement.target, ast.Name):
            found += [statement.target.id] if statement.target.id not in {*known, *found} else []
        elif isinstance(statement, ast.Assign):
            known |= {n.id for n in ast.walk(statement.targets[0]) if isinstance(n, ast.Name)}
    return found


def _lane_place(index: ast.expr) -> ast.expr | None:
    """x of an index `x + b`, 0 of `b` alone; None of any other."""
    if isinstance(index, ast.Name) and index.id == "b":
        return ast.Constant(0)
    if isinstance(index, ast.BinOp) and isinstance(index.op, ast.Add) and ast.unparse(index.right) == "b":
        return index.left
    return None


def _indices(node: ast.Subscript) -> list[ast.expr]:
    return node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]


def _in_vectors(loop: ast.For) -> bool:
    """Whether a loop over the lanes is plain arithmetic on neighbouring elements."""
    if not all(isinstance(statement, ast.Assign | ast.AugAssign) for statement in loop.body):
        return False
    own = [_indices(node)[-1] for node in ast.walk(loop) if isinstance(node, ast.Subscript)]
    inside = {id(node) for index in own for node in ast.walk(index)}
    free = [n for n in ast.walk(loop) if isinstance(n, ast.Name) and n.id == "b" and id(n) not in inside]
    return all(_lane_place(index) is not None for index in own) and len(free) == 1  # the loop's own target


@dataclass
class Writer:
    """Writes a function's body; block: lanes of a whole loop over `b`; helpers: functions that are written in place."""

    emit: Instructions
    block: int
    helpers: Mapping[str, ast.FunctionDef]
    begin: list[str] = field(default_factory=list)  # room for variables and arrays, before all else
    _arrays: dict[str, _Array] = field(default_factory=dict)
    _kinds: dict[str, str] = field(default_factory=dict)
    _local: dict[str, Value] = field(default_factory=dict)  # the names of a loop over the lanes, or of a helper
    _lane: str | None = None  # the first lane of the vector at hand

    def take(self, name: str, argument: Argument, words: list[str]) -> None:
        """The argument of that name: its number, or its address and extents."""
        if argument.axes:
            self._arrays[name] = _Array(words[0], argument.kind, tuple(Value(word, "i64") for word in words[1:]))
        else:
            self._set(name, Value(words[0], argument.kind))

    def statements(self, body: list[ast.stmt]) -> None:
        """Writes the statements one after the other."""
        for statement in body:
            if isinstance(statement, ast.For):
                self._loop(statement)
            elif isinstance(statement, ast.If):
                self._branch(statement)
            elif isinstance(statement, ast.Assign):
                self._assign(statement)
            elif isinstance(statement, ast.AugAssign):
                old, more = self.value(statement.target), self.value(statement.value)
                self._store(statement.target, self.emit.arithmetic(statement.op, old, more))
            elif not isinstance(statement, ast.Pass):
                raise SyntaxError(f"{ast.unparse(statement)}: no part of a kernel's text")

    def _loop(self, loop: ast.For) -> None:
        name = cast(ast.Name, loop.target).id
        if name == "b" and _in_vectors(loop):
            self._vectors(loop)
        else:
            end = self.value(cast(ast.Call, loop.iter).args[0])
            self._repeated(name, end, 1, lambda: self.statements(loop.body))

    def _repeated(self, name: str, end: Value, stride: int, work: Callable[[], None]) -> None:
        head, inside, after = self.emit.labels("head", "inside", "after")
        self._set(name, whole(0))
        self.emit.lines += [f"  br label %{head}", f"{head}:"]
        more = self.emit.compared(ast.Lt(), self._name(name), end).text
        self.emit.lines += [f"  br i1 {more}, label %{inside}, label %{after}", f"{inside}:"]
        work()
        self._set(name, self.emit.arithmetic(ast.Add(), self._name(name), whole(stride)))
        self.emit.lines += [f"  br label %{head}", f"{after}:"]

    def _vectors(self, loop: ast.For) -> None:
        sums = _carried(loop.body)

        def at(lane: str) -> None:
            self._lane, self._local = lane, {name: self.emit.splat(double(0.0)) for name in sums}
            self.statements(loop.body)
            parts = {name: self.emit.sum_of_lanes(self._local[name]) for name in sums}
            self._lane, self._local = None, {}
            for name, part in parts.items():
                self._set(name, self.emit.arithmetic(ast.Add(), self._name(name), part))

        if self.block == self.emit.width:
            at("0")
        else:
            self._repeated("lane.first", whole(self.block), self.emit.width, lambda: at(self._name("lane.first").text))

    def _branch(self, branch: ast.If) -> None:
        then, other, after = self.emit.labels("then", "other", "after")
        test = self.value(branch.test)
        self.emit.lines += [f"  br i1 {test.text}, label %{then}, label %{other}", f"{then}:"]
        self.statements(branch.body)
        self.emit.lines += [f"  br label %{after}", f"{other}:"]
        self.statements(branch.orelse)
        self.emit.lines += [f"  br label %{after}", f"{after}:"]

    def _assign(self, statement: ast.Assign) -> None:
        target, source = statement.targets[0], statement.value
        if isinstance(source, ast.Call) and ast.unparse(source.func) in ("np.zeros", "np.empty"):
            self._room(cast(ast.Name, target).id, source)
        elif isinstance(target, ast.Tuple):
            for part, value in zip(target.elts, self._several(source, len(target.elts)), strict=True):
                self._store(part, value)
        else:
            self._store(target, self.value(source))

    def _room(self, name: str, call: ast.Call) -> None:
        """An array of the function's own, of zeros."""
        shape = call.args[0].elts if isinstance(call.args[0], ast.Tuple) else [call.args[0]]
        extents = [cast(int, cast(ast.Constant, extent).value) for extent in shape]
        kind, size = "i64" if len(call.args) > 1 else "double", 1
        for extent in extents:
            size *= extent
        self.begin.append(f"  %room.{name} = alloca [{size} x {kind}], align 64")
        zeros = f"ptr align 64 %room.{name}, i8 0, i64 {8 * size}, i1 false"
        self.emit.lines.append(f"  call void @llvm.memset.p0.i64({zeros})")
        self._arrays[name] = _Array(f"%room.{name}", kind, tuple(map(whole, extents)))

    def _several(self, source: ast.expr, count: int) -> list[Value]:
        """The parts of array[a:b], or of a helper that returns several."""
        if isinstance(source, ast.Subscript):
            lower = cast(ast.Slice, source.slice).lower
            first = cast(int, cast(ast.Constant, lower).value) if lower else 0
            parts = [ast.Subscript(source.value, ast.Constant(first + k), ast.Load()) for k in range(count)]
            return [self.value(part) for part in parts]
        call = cast(ast.Call, source)
        helper, given = self.helpers[ast.unparse(call.func)], self.value(call.args[0])
        outside, self._local = self._local, {helper.args.args[0].arg: given}
        lane, self._lane = self._lane, self._lane or "0"  # its names are its own, in a vector or not
        *body, end = helper.body
        self.statements([statement for statement in body if not isinstance(statement, ast.Expr)])
        found = [self.value(part) for part in cast(ast.Tuple, cast(ast.Return, end).value).elts]
        self._local, self._lane = outside, lane
        return found

    def _store(self, target: ast.expr, value: Value) -> None:
        if isinstance(target, ast.Name) and self._lane is not None:
            self._local[target.id] = value
        elif isinstance(target, ast.Name):
            self._set(target.id, value)
        else:
            place, array = self._place(cast(ast.Subscript, target))
            value = self.emit.double(value) if array.kind == "double" else value
            value = self.emit.splat(value) if self._lane is not None and not value.lanes else value
            self.emit.lines.append(f"  store {self.emit.operand(value)}, ptr {place}, align 8")

    def _set(self, name: str, value: Value) -> None:
        """Sets a variable outside the loops over the lanes."""
        if name not in self._kinds:
            self._kinds[name] = value.kind
            self.begin.append(f"  %slot.{name} = alloca {value.kind}")
        value = self.emit.double(value) if self._kinds[name] == "double" else value
        if value.kind != self._kinds[name]:
            raise SyntaxError(f"{name} is {self._kinds[name]} here and {value.kind} there")
        self.emit.lines.append(f"  store {self.emit.operand(value)}, ptr %slot.{name}")

    def _name(self, name: str) -> Value:
        if name in self._local:
            return self._local[name]
        if name not in self._kinds:
            raise SyntaxError(f"{name} is not known")
        kind = self._kinds[name]
        return Value(self.emit.new(f"load {kind}, ptr %slot.{name}"), kind)

    def _place(self, node: ast.Subscript) -> tuple[str, _Array]:
        """The address of an element, or of the first of a vector's."""
        array, indices = self._arrays[cast(ast.Name, node.value).id], _indices(node)
        if self._lane is not None:
            indices = [*indices[:-1], cast(ast.expr, _lane_place(indices[-1]))]
        place = self.value(indices[0])
        for extent, index in zip(array.extents[1:], indices[1:], strict=True):
            place = self.emit.arithmetic(ast.Mult(), place, extent)
            place = self.emit.arithmetic(ast.Add(), place, self.value(index))
        if self._lane is not None:
            place = self.emit.arithmetic(ast.Add(), place, Value(self._lane, "i64"))
        kind = "i8" if array.kind == "i1" else array.kind
        return self.emit.new(f"getelementptr inbounds {kind}, ptr {array.pointer}, i64 {place.text}"), array

    def _element(self, node: ast.Subscript) -> Value:
        place, array = self._place(node)
        if array.kind == "i1":
            return self.emit.compared(
                ast.NotEq(), Value(self.emit.new(f"load i8, ptr {place}"), "i8"), Value("0", "i8")
            )
        lanes = self._lane is not None
        kind = self.emit.type_of(Value("", array.kind, lanes))
        return Value(self.emit.new(f"load {kind}, ptr {place}, align 8"), array.kind, lanes)

    def value(self, node: ast.expr) -> Value:
        """The operand that an expression comes to."""
        match node:
            case ast.Constant(value=bool() as flag):
                return Value("true" if flag else "false", "i1")
            case ast.Constant(value=int() as count):
                return whole(count)
            case ast.Constant(value=float() as real):
                return double(real)
            case ast.Name():
                return self._name(node.id)
            case ast.Subscript(value=ast.Attribute(value=ast.Name(id=name)), slice=ast.Constant(value=int() as axis)):
                return self._arrays[name].extents[axis]  # name.shape[axis]
            case ast.Subscript():
                return self._element(node)
            case ast.BoolOp():
                return self._decided(node)
            case ast.IfExp():
                return self.emit.selected(*(self.value(part) for part in (node.test, node.body, node.orelse)))
            case ast.Compare():
                return self.emit.compared(node.ops[0], self.value(node.left), self.value(node.comparators[0]))
            case ast.BinOp():
                return self._of_two(node.op, self.value(node.left), self.value(node.right))
            case ast.UnaryOp(op=ast.Not()):
                return self.emit.both("xor", self.value(node.operand), Value("true", "i1"))
            case ast.UnaryOp(op=ast.USub()):
                return self.emit.negative(self.value(node.operand))
            case ast.Call():
                return self.emit.called(ast.unparse(node.func), [self.value(argument) for argument in node.args])
        raise SyntaxError(f"{ast.unparse(node)}: no part of a kernel's text")

    def _of_two(self, operator: ast.operator, left: Value, right: Value) -> Value:
        if isinstance(operator, ast.Pow):
            return self.emit.of_library("pow", [left, right])
        if isinstance(operator, ast.BitAnd | ast.BitOr):
            return self.emit.both("and" if isinstance(operator, ast.BitAnd) else "or", left, right)
        return self.emit.arithmetic(operator, left, right)

    def _decided(self, node: ast.BoolOp) -> Value:
        """`and`, `or`: what stands later is not computed where the first decides (it may divide by zero)."""
        (decided, more, after), (first, *rest) = self.emit.labels("decided", "more", "after"), node.values
        self.begin.append(f"  %{decided} = alloca i1")
        test, ways = self.value(first), [f"label %{more}", f"label %{after}"]
        chosen = ", ".join(ways if isinstance(node.op, ast.And) else reversed(ways))
        self.emit.lines += [f"  store i1 {test.text}, ptr %{decided}", f"  br i1 {test.text}, {chosen}", f"{more}:"]
        later = self.value(rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest))
        self.emit.lines += [f"  store i1 {later.text}, ptr %{decided}", f"  br label %{after}", f"{after}:"]
        return Value(self.emit.new(f"load i1, ptr %{decided}"), "i1")

"""LLVM's instructions, one after the other, on numbers and on vectors of `width` lanes."""

from __future__ import annotations

import ast
import math
import struct
from dataclasses import dataclass, field

FAST = "contract reassoc arcp nsz afn"  # what a sum may be reordered for; not nnan: divergence must show
EXP_MOST = 708.0  # exp of it is a double, and so is exp of its negative
EXP_TERMS = 13  # of exp's series up to log(2) / 2: the next is 4e-18
WHOLE_BITS = 1.5 * 2.0**52  # added to a number, this leaves it rounded in the lowest bits
LOG_2_HIGH = float.fromhex("0x1.62e42feep-1")  # times a whole number below 2^20 exact
LOG_2_LOW = float.fromhex("0x1.a39ef35793c76p-33")  # log 2 less that
_INTRINSICS = {"math.sqrt": "sqrt", "abs": "fabs", "np.floor": "floor"}  # one instruction a vector
_LIBRARY = {"math.exp": "exp", "math.tanh": "tanh", "math.sin": "sin", "math.cos": "cos", "math.log": "log"}
_ARITHMETIC: dict[type, tuple[str, str]] = {
    ast.Add: (f"fadd {FAST}", "add"),
    ast.Sub: (f"fsub {FAST}", "sub"),
    ast.Mult: (f"fmul {FAST}", "mul"),
    ast.Div: (f"fdiv {FAST}", ""),
    ast.Mod: ("", "srem"),
}
_COMPARISONS: dict[type, tuple[str, str]] = {
    ast.Lt: ("olt", "slt"),
    ast.Gt: ("ogt", "sgt"),
    ast.LtE: ("ole", "sle"),
    ast.GtE: ("oge", "sge"),
    ast.Eq: ("oeq", "eq"),
    ast.NotEq: ("une", "ne"),
}


@dataclass(frozen=True)
class Value:
    """An operand as LLVM spells it; kind: double, i64 or i1; lanes: one for every lane of a vector."""

    text: str
    kind: str
    lanes: bool = False

    @property
    def literal(self) -> bool:
        """Whether it is a number written out."""
        return self.text[0] not in "%s"  # %name, splat (...)


def double(value: float) -> Value:
    """A double written out, bit by bit."""
    return Value(f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}", "double")


def whole(value: int) -> Value:
    """An integer written out."""
    return Value(str(value), "i64")


@dataclass
class Instructions:
    """The lines written so far; width: lanes of a vector; library: the functions of the C library that they call."""

    width: int
    lines: list[str] = field(default_factory=list)
    library: set[str] = field(default_factory=set)
    _count: int = 0

    def new(self, operation: str) -> str:
        """Writes an operation: the name of its result."""
        self._count += 1
        self.lines.append(f"  %v{self._count} = {operation}")
        return f"%v{self._count}"

    def labels(self, *names: str) -> list[str]:
        """The names, with a number that no others have."""
        self._count += 1
        return [f"{name}{self._count}" for name in names]

    def type_of(self, value: Value) -> str:
        """The operand's type."""
        return f"<{self.width} x {value.kind}>" if value.lanes else value.kind

    def operand(self, value: Value) -> str:
        """The operand behind its type."""
        return f"{self.type_of(value)} {value.text}"

    def double(self, value: Value) -> Value:
        """The number as a double."""
        if value.kind == "double":
            return value
        return double(float(value.text)) if value.literal else self._like(value, f"sitofp i64 {value.text} to double")

    def _like(self, value: Value, operation: str) -> Value:
        return Value(self.new(operation), "double", value.lanes)

    def splat(self, value: Value) -> Value:
        """The same number in every lane."""
        if value.literal:
            return Value(f"splat ({value.kind} {value.text})", value.kind, True)
        kind = f"<{self.width} x {value.kind}>"
        first = self.new(f"insertelement {kind} poison, {value.kind} {value.text}, i64 0")
        zeros = f"<{self.width} x i32> zeroinitializer"
        return Value(self.new(f"shufflevector {kind} {first}, {kind} poison, {zeros}"), value.kind, True)

    def sum_of_lanes(self, value: Value) -> Value:
        """The sum of a vector's lanes."""
        head = f"call {FAST} double @llvm.vector.reduce.fadd.v{self.width}f64(double 0.0"
        return Value(self.new(f"{head}, {self.operand(value)})"), "double")

    def _alike(self, *values: Value) -> list[Value]:
        """The operands with one kind, and all as vectors where one is."""
        found = list(values)
        if any(value.kind == "double" for value in found):
            found = [self.double(value) for value in found]
        if any(value.lanes for value in found):
            found = [value if value.lanes else self.splat(value) for value in found]
        return found

    def arithmetic(self, operator: ast.operator, left: Value, right: Value) -> Value:
        """left + right, and so on; a quotient is a double."""
        of_doubles, of_integers = _ARITHMETIC[type(operator)]
        if isinstance(operator, ast.Div):
            left, right = self.double(left), self.double(right)
        left, right = self._alike(left, right)
        if left.kind == "i64" and left.literal and right.literal and of_integers != "srem":
            a, b = int(left.text), int(right.text)
            return whole(a + b if of_integers == "add" else a - b if of_integers == "sub" else a * b)
        operation = of_doubles if left.kind == "double" else of_integers
        return Value(self.new(f"{operation} {self.operand(left)}, {right.text}"), left.kind, left.lanes)

    def negative(self, value: Value) -> Value:
        """-value."""
        if value.kind == "i64":
            return self.arithmetic(ast.Sub(), whole(0), value)
        return self._like(value, f"fneg {FAST} {self.operand(value)}")

    def compared(self, operator: ast.cmpop, left: Value, right: Value) -> Value:
        """left < right, and so on."""
        left, right = self._alike(left, right)
        of_doubles, of_integers = _COMPARISONS[type(operator)]
        head = f"fcmp {of_doubles}" if left.kind == "double" else f"icmp {of_integers}"
        return Value(self.new(f"{head} {self.operand(left)}, {right.text}"), "i1", left.lanes)

    def both(self, operation: str, left: Value, right: Value) -> Value:
        """`and`, `or`, `xor` of two truths."""
        left, right = self._alike(left, right)
        return Value(self.new(f"{operation} {self.operand(left)}, {right.text}"), "i1", left.lanes)

    def selected(self, test: Value, then: Value, other: Value) -> Value:
        """`then` where the test holds, else `other`."""
        then, other = self._alike(then, other)
        if test.lanes and not then.lanes:
            then, other = self.splat(then), self.splat(other)
        choice = f"select {self.operand(test)}, {self.operand(then)}, {self.operand(other)}"
        return Value(self.new(choice), then.kind, then.lanes)

    def called(self, name: str, arguments: list[Value]) -> Value:
        """A function of the kernel's text. SyntaxError where it has none of that name."""
        if name == "float":
            return self.double(arguments[0])
        if name in ("min", "max"):
            least, other = arguments
            comparison = self.compared(ast.Lt() if name == "min" else ast.Gt(), other, least)
            return self.selected(comparison, other, least)
        if name in _INTRINSICS:
            value = self.double(arguments[0])
            kind, suffix = self.type_of(value), f"v{self.width}f64" if value.lanes else "f64"
            return self._like(value, f"call {FAST} {kind} @llvm.{_INTRINSICS[name]}.{suffix}({self.operand(value)})")
        if name not in _LIBRARY:
            raise SyntaxError(f"{name}: no function of a kernel's text")
        if name in ("math.exp", "math.tanh") and arguments[0].lanes:
            return self._exponential(arguments[0]) if name == "math.exp" else self._hyperbolic_tangent(arguments[0])
        return self.of_library(_LIBRARY[name], arguments)

    def _exponential(self, x: Value) -> Value:
        """exp(x) of a vector: 2^k exp(x - k log 2), the second factor by its series; 2^k from the bits of k.

        At most 1e-15 of it wrong. What would leave the doubles' range stays at its ends.
        """
        kind, whole_kind = self.type_of(x), f"<{self.width} x i64>"
        x = self.called("min", [self.called("max", [x, double(-EXP_MOST)]), double(EXP_MOST)])  # NaN stays

        def exact(operation: str, left: str, right: float) -> str:
            return self.new(f"{operation} {kind} {left}, {self.splat(double(right)).text}")

        shifted = exact("fadd", exact("fmul", x.text, 1.0 / math.log(2.0)), WHOLE_BITS)
        k = exact("fsub", shifted, WHOLE_BITS)
        near = self.new(f"fsub {kind} {x.text}, {exact('fmul', k, LOG_2_HIGH)}")
        rest = Value(self.new(f"fsub {kind} {near}, {exact('fmul', k, LOG_2_LOW)}"), "double", True)
        series = double(1.0 / math.factorial(EXP_TERMS))
        for power in range(EXP_TERMS - 1, -1, -1):
            series = self.arithmetic(ast.Mult(), series, rest)
            series = self.arithmetic(ast.Add(), series, double(1.0 / math.factorial(power)))
        bits = self.new(f"bitcast {kind} {shifted} to {whole_kind}")
        biased = self.new(f"add {whole_kind} {bits}, splat (i64 1023)")
        scale = self.new(f"shl {whole_kind} {biased}, splat (i64 52)")
        return self.arithmetic(ast.Mult(), series, self._like(x, f"bitcast {whole_kind} {scale} to {kind}"))

    def _hyperbolic_tangent(self, y: Value) -> Value:
        """tanh(y) of a vector: sign(y) (1 - e) / (1 + e), e = exp(-2 |y|); at most 2e-16 wrong."""
        size = self.called("abs", [y])
        e = self._exponential(self.arithmetic(ast.Mult(), double(-2.0), size))
        ratio = self.arithmetic(
            ast.Div(), self.arithmetic(ast.Sub(), double(1.0), e), self.arithmetic(ast.Add(), double(1.0), e)
        )
        copied = f"@llvm.copysign.v{self.width}f64({self.operand(ratio)}, {self.operand(y)})"
        return self._like(y, f"call {self.type_of(y)} {copied}")

    def of_library(self, function: str, arguments: list[Value]) -> Value:
        """A function of the C library; of a vector lane by lane."""
        self.library.add(function)
        values = self._alike(*map(self.double, arguments))
        head = f"call {self.type_of(values[0])} @{'lanes_' if values[0].lanes else ''}{function}"
        return self._like(values[0], f"{head}({', '.join(map(self.operand, values))})")

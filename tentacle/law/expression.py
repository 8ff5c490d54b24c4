"""Expressions of the grammar of laws: read by a small parser, checked for dimension, evaluated on any numbers.

    sum     = product { ("+" | "-") product }
    product = signed { ("*" | "/") signed }
    signed  = "-" signed | power
    power   = atom [ "^" signed ]
    atom    = number | name | function "(" sum ")" | "(" sum ")"

An exponent is a number or, if its base has no dimension, an expression without dimension.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from tentacle.law.dimension import DIMENSIONLESS, Dimension

LONGEST, DEEPEST = 2000, 40  # characters, brackets in brackets
# A function's name, and its rule for the dimension of the argument: keep it, take the root, or require none.
FUNCTIONS = {
    "abs": "keeps", "positive": "keeps", "sqrt": "root", "sign": "none of any",
    "exp": "none", "sin": "none", "cos": "none", "tanh": "none",
}  # fmt: skip
_TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([A-Za-z_]\w*)|(\*\*|[-+*/^()]))")


@dataclass(frozen=True)
class Number:
    """A plain number."""

    value: float


@dataclass(frozen=True)
class Name:
    """A quantity, a parameter or a definition."""

    name: str


@dataclass(frozen=True)
class Call:
    """A function of one argument; "negative" is the sign."""

    function: str
    argument: Node


@dataclass(frozen=True)
class Binary:
    """Two operands with + - * / or ^ between them."""

    operator: str
    left: Node
    right: Node


Node = Number | Name | Call | Binary


class LawError(ValueError):
    """An error in an expression, in a few words."""


class _Parser:
    def __init__(self, text: str) -> None:
        if len(text) > LONGEST:
            raise LawError(f"longer than {LONGEST} characters")
        self._tokens: list[str] = []
        self._depth = 0
        place, end = 0, len(text.rstrip())
        while place < end:
            match = _TOKEN.match(text, place)
            if match is None:
                raise LawError(f"{text[place:].strip()[0]!r} is no part of an expression")
            self._tokens.append(next(group for group in match.groups() if group is not None))
            place = match.end()

    def whole(self) -> Node:
        """The expression, and nothing behind it."""
        node = self._sum()
        if self._tokens:
            raise LawError(f"{self._tokens[0]!r} is not expected there")
        return node

    def _take(self, *wanted: str) -> str | None:
        return self._tokens.pop(0) if self._tokens and self._tokens[0] in wanted else None

    def _sum(self) -> Node:
        self._depth += 1
        if self._depth > DEEPEST:
            raise LawError("nested too deeply")
        node = self._product()
        while operator := self._take("+", "-"):
            node = Binary(operator, node, self._product())
        self._depth -= 1
        return node

    def _product(self) -> Node:
        node = self._signed()
        while operator := self._take("*", "/"):
            node = Binary(operator, node, self._signed())
        return node

    def _signed(self) -> Node:
        negative = False
        while self._take("-"):
            negative = not negative
        node = self._power()
        return Call("negative", node) if negative else node

    def _power(self) -> Node:
        node = self._atom()
        if not self._take("^", "**"):
            return node
        negative = self._take("-") is not None
        exponent = self._atom()
        if self._tokens and self._tokens[0] in ("^", "**"):
            raise LawError("a power of a power needs brackets")
        return Binary("^", node, Call("negative", exponent) if negative else exponent)

    def _atom(self) -> Node:
        if not self._tokens:
            raise LawError("something is missing at its end")
        token = self._tokens.pop(0)
        if token == "(":
            node = self._sum()
            self._close()
            return node
        if token[0].isdigit() or token[0] == ".":
            return Number(float(token))
        if not (token[0].isalpha() or token[0] == "_"):
            raise LawError(f"{token!r} is not expected there")
        if not self._take("("):
            return Name(token)
        if token not in FUNCTIONS:
            raise LawError(f"{token!r} is no function; known are {', '.join(FUNCTIONS)}")
        node = self._sum()
        self._close()
        return Call(token, node)

    def _close(self) -> None:
        if not self._take(")"):
            raise LawError("a bracket is not closed")


def parse(text: str) -> Node:
    """The expression's tree. LawError where it is none."""
    return _Parser(text).whole()


def names_in(node: Node) -> set[str]:
    """The names that the expression uses."""
    if isinstance(node, Name):
        return {node.name}
    if isinstance(node, Call):
        return names_in(node.argument)
    if isinstance(node, Binary):
        return names_in(node.left) | names_in(node.right)
    return set()


def calls_in(node: Node) -> set[str]:
    """The functions that the expression uses."""
    if isinstance(node, Call):
        return {node.function} | calls_in(node.argument)
    if isinstance(node, Binary):
        return calls_in(node.left) | calls_in(node.right)
    return set()


def dimension(node: Node, known: Mapping[str, Dimension]) -> Dimension:
    """The expression's dimension. LawError where it has none, or a name is not known."""
    if isinstance(node, Number):
        return DIMENSIONLESS
    if isinstance(node, Name):
        if node.name not in known:
            raise LawError(f"{node.name!r} is not known; known are {', '.join(known)}")
        return known[node.name]
    if isinstance(node, Call):
        inner = dimension(node.argument, known)
        rule = FUNCTIONS.get(node.function, "keeps")
        if rule == "none" and inner != DIMENSIONLESS:
            raise LawError(f"{node.function} of something in {inner}; it takes a number without unit")
        return inner ** Fraction(1, 2) if rule == "root" else DIMENSIONLESS if rule.startswith("none") else inner
    left, right = dimension(node.left, known), dimension(node.right, known)
    if node.operator == "*":
        return left * right
    if node.operator == "/":
        return left / right
    if node.operator == "^":
        return _power(node.right, left, right)
    if left != right:
        raise LawError(f"{left} {node.operator} {right}: the two differ in dimension")
    return left


def _power(exponent: Node, base: Dimension, own: Dimension) -> Dimension:
    value = constant(exponent)
    if own != DIMENSIONLESS:
        raise LawError(f"an exponent in {own}; it must be a number without unit")
    if value is None:
        if base != DIMENSIONLESS:
            raise LawError(f"{base} to a power that is no plain number: divide by a constant of that unit first")
        return DIMENSIONLESS
    return base ** Fraction(value).limit_denominator(1000)


def constant(node: Node) -> float | None:
    """The value of a number with or without a sign; None where the node is something else."""
    if isinstance(node, Number):
        return node.value
    if isinstance(node, Call) and node.function == "negative":
        inner = constant(node.argument)
        return None if inner is None else -inner
    return None


def evaluated(node: Node, values: Mapping[str, Any], functions: Mapping[str, Callable[[Any], Any]]) -> Any:
    """The expression with these values of its names; functions: what computes each of FUNCTIONS on such values."""
    if isinstance(node, Number):
        return node.value
    if isinstance(node, Name):
        return values[node.name]
    if isinstance(node, Call):
        inner = evaluated(node.argument, values, functions)
        return -inner if node.function == "negative" else functions[node.function](inner)
    left = evaluated(node.left, values, functions)
    if node.operator == "^":
        power = constant(node.right)
        if power is not None:
            return left ** (int(power) if power == int(power) else power)
    right = evaluated(node.right, values, functions)
    if node.operator == "+":
        return left + right
    if node.operator == "-":
        return left - right
    if node.operator == "*":
        return left * right
    return left / right if node.operator == "/" else left**right

"""Values that are the same for all threads of a kernel: what they are, and sums of what differs with such coefficients.

    offset + c_1 x_1 + c_2 x_2 + ...,   offset and c_k uniform

A uniform value is named once and computed outside the kernel, in the order in which the values were met.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable
from dataclasses import dataclass, field

Coefficient = float | str  # a number, or the name of a uniform value, with its sign


@dataclass(frozen=True)
class Linear:
    """offset + sum of coefficient * factor: the factors are expressions that differ between threads."""

    offset: Coefficient = 0.0
    terms: tuple[tuple[Coefficient, ast.expr], ...] = ()

    @property
    def uniform(self) -> bool:
        """Whether nothing in it differs between threads."""
        return not self.terms


def opposite(a: Coefficient) -> Coefficient:
    """-a."""
    if not isinstance(a, str):
        return -a
    return a.removeprefix("-") if a.startswith("-") else f"-{a}"


def negative(a: Coefficient) -> bool:
    """Whether it is written with a minus."""
    return a.startswith("-") if isinstance(a, str) else a < 0.0


@dataclass
class Uniforms:
    """The uniform values in the order of their computation, and the tests on them."""

    lines: list[str] = field(default_factory=list)
    tests: list[str] = field(default_factory=list)
    _names: dict[str, str] = field(default_factory=dict)

    def named(self, text: str) -> str:
        """The name of the uniform value of that expression."""
        if text not in self._names:
            self._names[text] = f"k{len(self._names)}"
            self.lines.append(f"{self._names[text]} = {text}")
        return self._names[text]

    def product(self, a: Coefficient, b: Coefficient) -> Coefficient:
        """a * b, named if it is no number."""
        if isinstance(a, float) and isinstance(b, float):
            return a * b
        if 0.0 in (a, b):
            return 0.0
        if negative(a) or negative(b):
            size = self.product(*(opposite(one) if negative(one) else one for one in (a, b)))
            return size if negative(a) and negative(b) else opposite(size)
        if 1.0 in (a, b):
            return b if a == 1.0 else a
        return self.named(" * ".join(sorted(map(str, (a, b)))))

    def sum(self, a: Coefficient, b: Coefficient) -> Coefficient:
        """a + b, named if it is no number."""
        if isinstance(a, float) and isinstance(b, float):
            return a + b
        if 0.0 in (a, b):
            return b if a == 0.0 else a
        return self.named(" + ".join(sorted(map(str, (a, b)))))

    def inverse(self, a: Coefficient) -> Coefficient:
        """1 / a, named if it is no number."""
        return 1.0 / a if isinstance(a, float) and a != 0.0 else self.named(f"one / {a}")

    def source(self, arguments: Iterable[str], read: Iterable[Coefficient]) -> str:
        """The function of the arguments (numbers of numpy, so that 1/0 is infinite) that gives the values that a kernel
        reads, and the outcomes of the tests.
        """
        body = [
            "one = np.float64(1.0)",
            *self.lines,
            f"return [{', '.join(map(str, read))}], [{', '.join(self.tests)}]",
        ]
        head = f"def uniforms({', '.join(arguments)}):"
        return "\n".join(["import numpy as np", "", "", head, *(f"    {line}" for line in body), ""])

"""A law from an effect file.

    line:    df/ds = L (force_n n + force_t t + force_x e_x + force_y e_y)     [N/m], at every section
    tip:     F = force_n n + force_t t + force_x e_x + force_y e_y             [N], at s = 1
    moment:  m(s)                                                              [N m], conjugate to the curvature c

n, t: the section's normal and tangent; e_x, e_y: those of the straight arm at theta = 0. With a relaxation time a
moment sees `memory`, the curvature of a spring in series with a dashpot: memory' = c' - memory / tau.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from tentacle.law.dimension import DIMENSIONLESS, Dimension, dimension_of
from tentacle.law.expression import LawError, Node, calls_in, dimension, evaluated, names_in, parse
from tentacle.law.quantities import ACTS, POSITIVE_ROUNDING, RESERVED, SIGN_WIDTH, SOFT, dimensions

Acts = Literal["line", "tip", "moment"]
COMPONENTS: dict[str, tuple[str, ...]] = {
    "line": ("force_n", "force_t", "force_x", "force_y"),
    "tip": ("force_n", "force_t", "force_x", "force_y"),
    "moment": ("moment",),
}


@dataclass(frozen=True)
class WrittenParameter:
    """A parameter: nominal size and bounds in SI, its unit, its meaning; scan values where it only shapes the law."""

    name: str
    unit: str
    nominal: float
    bounds: tuple[float, float]
    words: str
    scan: tuple[float, ...] = ()


@dataclass(frozen=True)
class WrittenLaw:
    """An effect as data.

    components: component -> expression; definitions: name -> expression, in order, that those may use; constants:
    name -> (value, unit). relaxation: the expression of tau [s] of a moment's memory. dissipative: it only takes
    energy.
    """

    name: str
    title: str
    source: str
    acts: Acts
    components: Mapping[str, str]
    parameters: tuple[WrittenParameter, ...]
    definitions: Mapping[str, str]
    constants: Mapping[str, tuple[float, str]]
    relaxation: str | None = None
    dissipative: bool = False

    def __hash__(self) -> int:
        return hash((self.name, self.acts, tuple(self.components.items()), self.parameters))

    @cached_property
    def trees(self) -> dict[str, Node]:
        """The parsed expressions of components, definitions, and "relaxation"."""
        texts = {**self.definitions, **self.components}
        if self.relaxation is not None:
            texts["relaxation"] = self.relaxation
        return {name: parse(text) for name, text in texts.items()}

    @property
    def levels_off(self) -> bool:
        """Whether a function of it stays the same beyond some argument."""
        return any({"tanh", "sign"} & calls_in(tree) for tree in self.trees.values())

    def check(self) -> None:
        """LawError for a bad expression, an unknown name, a wrong dimension, or a law that does not vanish with its
        strengths.
        """
        known, unit = dimensions(self.acts)
        known = {name: own for name, own in known.items() if name != "memory" or self.relaxation is not None}
        for name, own in (
            *((p.name, p.unit) for p in self.parameters),
            *((name, unit) for name, (_, unit) in self.constants.items()),
        ):
            if name in known or name in RESERVED or name in self.definitions:
                raise LawError(f"{name!r} is the name of something else too")
            known[name] = dimension_of(own)
        for name in self.definitions:
            if name in known or name in RESERVED:
                raise LawError(f"{name!r} is the name of something else too")
            known[name] = dimension(self.trees[name], known)
        for name in self.components:
            self._expect(name, dimension(self.trees[name], known), unit)
        if self.relaxation is not None:
            self._expect("relaxation", dimension(self.trees["relaxation"], known), dimension_of("s"))
            if used := names_in(self.trees["relaxation"]) & set(ACTS["moment"][0]):
                raise LawError(f"the relaxation time may not depend on {', '.join(sorted(used))}")
        self._check_values()

    def _expect(self, name: str, found: Dimension, wanted: Dimension) -> None:
        if found != wanted:
            raise LawError(f"{name} is in {found}; expected {wanted if wanted != DIMENSIONLESS else 'no unit'}")

    def _check_values(self) -> None:
        """Finite in ordinary states, and zero where every strength is."""
        random = np.random.default_rng(0)
        x = {name: random.uniform(-0.2, 0.2, 200) for name in ACTS[self.acts][0]}
        for name in ("s", "area", "width", "perimeter", "speed", "t", "length", "density", "fluid_density"):
            if name in x:
                x[name] = np.abs(x[name]) + 0.01
        shapes = {p.name: p.scan[0] for p in self.parameters if p.scan}
        strengths = {p.name: p.nominal for p in self.parameters if not p.scan}
        if not strengths:
            raise LawError("no parameter is a strength (one without scan values)")
        try:
            with np.errstate(all="ignore"):
                acting = self.values(x, {**shapes, **strengths}, NUMPY)
                absent = self.values(x, {**shapes, **dict.fromkeys(strengths, 0.0)}, NUMPY)
                tau = 1.0 if self.relaxation is None else self.relaxation_time({**shapes, **strengths}, NUMPY)
        except ArithmeticError as error:  # of plain numbers; arrays become infinite
            raise LawError(f"cannot be computed at the nominal values: {error}") from None
        if not (np.isfinite(tau) and tau > 0.0):
            raise LawError(f"relaxation is {tau:g} s at the nominal values; expected a time above zero")
        for name in self.components:
            if not np.all(np.isfinite(acting[name])):
                raise LawError(f"{name} is not finite everywhere: a power or root of what may be negative wants abs()")
            if np.any(absent[name] != 0.0):
                raise LawError(f"{name} does not vanish where {', '.join(strengths)} do")

    def values(
        self, x: Mapping[str, Any], p: Mapping[str, Any], functions: Mapping[str, Callable[[Any], Any]]
    ) -> dict[str, Any]:
        """All components at the quantities x and parameters p, with these functions for those of the grammar."""
        known = {**{name: value for name, (value, _) in self.constants.items()}, **x, **p}
        for name in self.definitions:
            known[name] = evaluated(self.trees[name], known, functions)
        return {name: evaluated(self.trees[name], known, functions) for name in self.components}

    def relaxation_time(self, p: Mapping[str, Any], functions: Mapping[str, Callable[[Any], Any]]) -> Any:
        """tau [s] at the parameters p."""
        known = {**{name: value for name, (value, _) in self.constants.items()}, **p}
        return evaluated(self.trees["relaxation"], known, functions)


def functions_from(sqrt: Any, exp: Any, sin: Any, cos: Any, tanh: Any) -> dict[str, Callable[[Any], Any]]:
    """The grammar's functions from five functions of a library; abs, positive and sign are smooth, so that laws have
    slopes.
    """

    def rounded(z: Any, width: float) -> Any:
        return sqrt(z * z + width**2)

    return {
        "sqrt": sqrt, "exp": exp, "sin": sin, "cos": cos, "tanh": tanh, "abs": lambda z: rounded(z, SOFT),
        "positive": lambda z: 0.5 * (z + rounded(z, POSITIVE_ROUNDING)), "sign": lambda z: tanh(z / SIGN_WIDTH),
    }  # fmt: skip


NUMPY = functions_from(np.sqrt, np.exp, np.sin, np.cos, np.tanh)

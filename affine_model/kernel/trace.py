"""From a law to lines of code: the law is called with symbols, differentiated,
and printed with common subexpressions shared.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import sympy
from sympy.printing.pycode import PythonCodePrinter

from affine_model.arm import parameter_rows
from affine_model.effect import ARM_QUANTITIES, NODE_QUANTITIES, STATE_QUANTITIES, Effect

# How the kernel spells each quantity inside its innermost loop, over the individual b of a block, at node i.
SPELLING = {
    **{name: f"{name}[i]" for name in NODE_QUANTITIES},
    **{name: name for name in ARM_QUANTITIES},
    "t": "t[b]",
    **{name: f"{name}[i, b]" for name in STATE_QUANTITIES},
}
TINY = 1e-12  # keeps a secant finite where its argument vanishes
_WAVES = (sympy.sin, sympy.cos)
_Term = sympy.Basic | complex


class _Printer(PythonCodePrinter):
    """Integer powers as products, which vectorise; symbols as the kernel spells them."""

    def _print_Symbol(self, expr: sympy.Symbol) -> str:
        return SPELLING.get(expr.name, expr.name)

    def _print_Pow(self, expr: sympy.Pow, rational: bool = False) -> str:
        base, exponent = expr.as_base_exp()
        if exponent.is_Integer and 1 < abs(int(exponent)) <= 6:
            product = "*".join([f"({self._print(base)})"] * abs(int(exponent)))
            return f"({product})" if exponent.is_positive else f"(1.0/({product}))"
        return super()._print_Pow(expr, rational=rational)


def symbols_for(effect: Effect) -> tuple[SimpleNamespace, SimpleNamespace]:
    """(x, p) of symbols to call the effect's laws with; parameters are spelled par[row, b]."""
    quantities = {**NODE_QUANTITIES, **ARM_QUANTITIES, **STATE_QUANTITIES}
    x = SimpleNamespace(**{name: sympy.Symbol(name, real=True) for name in quantities})
    rows = [row for row in parameter_rows() if row.effect == effect.name]
    p = SimpleNamespace(**{row.parameter.name: sympy.Symbol(f"par[{row.index}, b]", real=True) for row in rows})
    return x, p


def traced(effect: Effect, kind: str) -> tuple[sympy.Expr, ...]:
    """The law of that kind as expressions: one, or two for a pair law."""
    x, p = symbols_for(effect)
    value: Any = getattr(effect, kind)(x, p)
    values = value if isinstance(value, tuple) else (value,)
    return tuple(sympy.sympify(part) for part in values)


def lines(assignments: list[tuple[str, str, sympy.Expr]], indent: str) -> list[str]:
    """Code of `target op expression` for every assignment whose expression is not zero, subexpressions shared. A sine
    and a cosine come from the kernel's own `sincos`, which vectorises.
    """
    kept = [(target, operator, value) for target, operator, value in assignments if value != 0]
    if not kept:
        return []
    printer = _Printer({"fully_qualified_modules": True})
    angles, values = _waves([value for _, _, value in kept])
    text = [f"{indent}sine_{k}, cosine_{k} = sincos({printer.doprint(angle)})" for k, angle in enumerate(angles)]
    shared, reduced = sympy.cse(values, symbols=sympy.numbered_symbols("share"))
    text += [f"{indent}{symbol} = {printer.doprint(value)}" for symbol, value in shared]
    for (target, operator, _), value in zip(kept, reduced, strict=True):
        text.append(f"{indent}{target} {operator} {printer.doprint(value)}")
    return text


def _waves(values: list[sympy.Expr]) -> tuple[list[sympy.Expr], list[sympy.Expr]]:
    """The angles of whose sines and cosines the expressions are made, and the expressions of sine_k and cosine_k. A
    sine within a sine stays as it is.
    """
    inner = {wave for value in values for wave in value.atoms(*_WAVES) if not _angle(wave).has(*_WAVES)}
    angles = sorted({_angle(wave) for wave in inner}, key=str)
    names: dict[_Term, _Term] = {}
    for k, angle in enumerate(angles):
        names[sympy.sin(angle)], names[sympy.cos(angle)] = sympy.symbols(f"sine_{k} cosine_{k}", real=True)
    return angles, [cast(sympy.Expr, value.xreplace(names)) for value in values]


def _angle(wave: sympy.Basic) -> sympy.Expr:
    return cast(sympy.Expr, wave.args[0])


def step_slope(value: sympy.Expr, of: sympy.Symbol) -> sympy.Expr:
    """d value / d of, with which a step corrects its prediction; of tanh(y) it takes the secant, tanh(y) / y.

    The tangent of tanh vanishes at a fast prediction. One correction along it would jump across the steep middle, and
    the motion would ring. The secant never lies below the tangent, so that the correction never goes too far (Kacanov
    1959). It changes how fast a step converges, and not to what.
    """
    bends = sorted(value.atoms(sympy.tanh), key=str)
    held = [sympy.Dummy(real=True) for _ in bends]
    forth: dict[_Term, _Term] = dict(zip(bends, held, strict=True))
    back: dict[_Term, _Term] = dict(zip(held, bends, strict=True))
    outer = value.subs(forth)
    slope = sympy.diff(outer, of)
    for bend, place in zip(bends, held, strict=True):
        y = cast(sympy.Expr, bend.args[0])
        secant = (y * bend + TINY) / (y**2 + TINY)
        slope += sympy.diff(outer, place) * secant * step_slope(y, of)
    return cast(sympy.Expr, slope.subs(back))


def slope_along(value: sympy.Expr, component: str) -> sympy.Expr:
    """d value / d component for a relative velocity component, through the speed as well."""
    part, speed = sympy.Symbol(component, real=True), sympy.Symbol("speed", real=True)
    return step_slope(value, part) + step_slope(value, speed) * part / speed

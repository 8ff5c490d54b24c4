"""The functions that an effect's law may use besides + - * / **.

A law is written once. With arrays as arguments it computes (numpy or torch). With symbols (sympy) as arguments it gives
the formula from which the compiled kernels and the documentation are generated.
"""

from __future__ import annotations

import sys
from typing import Any

_SYMPY_NAMES = {"abs": "Abs"}


def _apply(name: str, x: Any) -> Any:
    """numpy's, torch's or sympy's function of that name, after the argument's own type."""
    library = type(x).__module__.split(".")[0]
    if library == "sympy":
        return getattr(sys.modules["sympy"], _SYMPY_NAMES.get(name, name))(x)
    return getattr(sys.modules[library if library == "torch" else "numpy"], name)(x)


def sqrt(x: Any) -> Any:
    """Square root."""
    return _apply("sqrt", x)


def exp(x: Any) -> Any:
    """Exponential."""
    return _apply("exp", x)


def tanh(x: Any) -> Any:
    """Hyperbolic tangent, the smooth sign."""
    return _apply("tanh", x)


def sin(x: Any) -> Any:
    """Sine."""
    return _apply("sin", x)


def cos(x: Any) -> Any:
    """Cosine."""
    return _apply("cos", x)


def magnitude(x: Any) -> Any:
    """Absolute value."""
    return _apply("abs", x)


def relaxed(memory: Any, rate: Any, duration: Any, tau: Any) -> Any:
    """A Maxwell branch's memory after `duration` [s] at a steady rate: memory' = rate - memory / tau, exactly."""
    kept = exp(-duration / tau)
    return memory * kept + tau * (1.0 - kept) * rate

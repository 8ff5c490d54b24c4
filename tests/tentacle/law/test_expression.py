"""Expressions of laws: parsed as algebra says, with their dimension, and nothing else is read."""

import numpy as np
import pytest

from tentacle.law.dimension import dimension_of
from tentacle.law.expression import LawError, dimension, evaluated, parse
from tentacle.law.written_law import NUMPY

KNOWN = {"u": dimension_of("m/s"), "x": dimension_of("m"), "F": dimension_of("N"), "p": dimension_of("1")}


@pytest.mark.parametrize(
    "text", ["-2^2", "2^-1", "1 - 2 - 3", "8 / 4 / 2", "2*-3", "-(1 + 2)*3", "1e-3 + .5", "2^3*2", "exp(-1)*sin(2)"]
)
def test_an_expression_means_what_it_means_in_python(text):
    # The one trusted text that is evaluated by Python here is the test's own.
    expected = eval(text.replace("^", "**"), {}, {"exp": np.exp, "sin": np.sin})
    assert evaluated(parse(text), {}, NUMPY) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("F * u^2 / x", "N m/s^2"), ("sqrt(x^2 + x*x)", "m"), ("abs(u)^1.5", "m^1.5/s^1.5"), ("sign(u) * F", "N"),
        ("F * (u / (2*u))^p", "N"), ("positive(x - 0.5*x) / x", "1"),
    ],
)  # fmt: skip
def test_the_dimension_of_an_expression(text, unit):
    assert dimension(parse(text), KNOWN) == dimension_of(unit)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("u + x", "differ in dimension"), ("exp(x)", "without unit"), ("u^p", "no plain number"),
        ("x^u", "an exponent"),
        ("F * width", "not known"), ("__import__(1)", "no function"), ("x.y", "no part"), ("x[0]", "no part"),
        ("2 x", "not expected"), ("(x", "not closed"), ("x +", "missing"), ("2^3^2", "brackets"),
        ("lambda", "not known"),
        ("(" * 60 + "x" + ")" * 60, "nested"), ("x" * 3000, "longer"), ("", "missing"),
    ],
)  # fmt: skip
def test_what_is_no_expression_of_the_grammar_is_refused(text, problem):
    with pytest.raises(LawError, match=problem):
        dimension(parse(text), KNOWN)


@pytest.mark.parametrize("unit", ["mm", "N/mm", "kPa", "", "m^", "deg"])
def test_only_si_units_without_prefix(unit):
    with pytest.raises(ValueError, match=r"unit"):
        dimension_of(unit)

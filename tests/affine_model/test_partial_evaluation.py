"""What is taken out of a kernel's text changes no result: random programs, run as written and rewritten."""

import ast
from types import SimpleNamespace

import numpy as np
import pytest

from affine_model.kernel.linear_form import LinearForms
from affine_model.kernel.partial_evaluation import PartialEvaluation, numbered
from affine_model.kernel.scalars import pruned

WP = SimpleNamespace(
    float64=float, int32=int, rint=np.rint, where=lambda test, one, other: one if test else other,
    sqrt=np.sqrt, abs=abs, min=min, max=max, tanh=np.tanh, exp=np.exp, floor=np.floor,
)  # fmt: skip
ROOTS, VARYING, OWN = ("length", "w"), ("x", "y"), ("p", "q", "r", "s")


def sincos(angle):
    return np.sin(angle), np.cos(angle)


def inverse_root(square):
    return 1.0 / np.sqrt(square)


def drawn_expression(draws, depth):
    """An expression of numbers, roots, arguments that differ between threads, and variables."""
    if depth == 0:
        leaves = [f"wp.float64({draws.choice([0.0, 1.0, -1.0, 0.5, 0.1, 3.7])})", "length", "w[0]", "w[1]"]
        return draws.choice([*leaves, *VARYING, *OWN, *OWN])
    one, other = (drawn_expression(draws, depth - 1) for _ in range(2))
    kind = draws.integers(9)
    if kind < 6:
        return f"({one} {'+-*'[kind % 3]} {other})"
    if kind == 6:
        return f"({one} / (wp.float64(2.5) + {other} * {other}))"
    if kind == 7:
        return f"wp.where({one} > {other}, {other}, {one})"
    return f"wp.tanh({one})"


def drawn_program(draws, length, depth=0):
    """Lines that assign to the variables: sums, sines, roots, loops and branches."""
    lines = []
    for _ in range(length):
        name, kind = draws.choice(OWN), draws.integers(9)
        if kind < 4:
            lines.append(f"{name} = {drawn_expression(draws, 3)}")
        elif kind == 4:
            lines.append(f"{name} {draws.choice(['+=', '-=', '*='])} wp.tanh({drawn_expression(draws, 2)})")
        elif kind == 5:
            lines.append(
                f"{name}, {draws.choice([n for n in OWN if n != name])} = sincos({drawn_expression(draws, 2)})"
            )
        elif kind == 6:
            lines.append(f"{name} = wp.sqrt({drawn_expression(draws, 1)} * x * x + wp.float64(9.0) * length + x * x)")
        elif depth < 2:
            inner = [f"    {line}" for line in drawn_program(draws, 3, depth + 1)]
            test = f"if {drawn_expression(draws, 1)} > {drawn_expression(draws, 1)}:"
            lines += [test if kind == 7 else "for step in range(3):", *inner]
    return lines


def run(lines, extra):
    values = {"wp": WP, "sincos": sincos, "inverse_root": inverse_root, **dict.fromkeys(OWN, 0.0), **extra}
    with np.errstate(all="ignore"):
        exec("\n".join(lines), values)
    return np.array([values[name] for name in OWN], dtype=float)


@pytest.mark.parametrize("seed", range(60))
def test_a_program_gives_the_same_when_uniform_values_are_taken_out(seed):
    draws = np.random.default_rng(seed)
    lines = [*drawn_program(draws, 12), *(f"out[{k}] = {name}" for k, name in enumerate(OWN))]
    given = {"length": np.float64(1.3), "w": np.array([0.4, -2.0])}
    own = {"x": 0.7, "y": -1.9, "out": np.zeros(4)}
    expected = run(lines, {**given, **own})
    outcomes: tuple[bool, ...] = ()
    for _ in range(20):
        forms = LinearForms(ROOTS, (), outcomes)
        body, read = numbered(pruned(PartialEvaluation(forms).of(ast.parse("\n".join(lines)).body, OWN)))
        text: dict = {}
        exec(forms.table.source(ROOTS, read), text)
        with np.errstate(all="ignore"):
            table, found = text["uniforms"](given["length"], given["w"])
        if tuple(map(bool, found)) == outcomes:
            break
        outcomes = tuple(map(bool, found))
    rewritten = ast.unparse(ast.fix_missing_locations(ast.Module(body, [])))
    assert "length" not in rewritten
    assert "w[" not in rewritten
    out = np.zeros(4)
    run([rewritten], {"x": 0.7, "y": -1.9, "U": table, "out": out})
    if np.all(np.abs(expected) < 1e6):  # 57 of the 60: sums of larger numbers cancel to any result
        np.testing.assert_allclose(out, expected, rtol=1e-9, atol=1e-9)


def test_a_sum_has_one_coefficient_a_term():
    forms = LinearForms(("length",), (), ())
    line = "p = length * (wp.float64(0.1) * x + wp.float64(0.3) * y) + wp.float64(0.2) * length"
    (statement,), _ = numbered(PartialEvaluation(forms).of(ast.parse(line).body, OWN))
    assert ast.unparse(ast.fix_missing_locations(statement)) == "p = U[0] + U[1] * x + U[2] * y"


def test_a_division_by_an_absent_payload_does_not_stop_the_others():
    forms = LinearForms(("mass", "density"), (), ())
    lines = "p = mass / density * x\nif mass > wp.float64(0.0):\n    q = p\nelse:\n    q = x * mass"
    _, read = numbered(PartialEvaluation(forms).of(ast.parse(lines).body, OWN))
    text: dict = {}
    exec(forms.table.source(("mass", "density"), read), text)
    with np.errstate(all="ignore"):
        _, found = text["uniforms"](np.float64(0.0), np.float64(0.0))
    assert found == [False]

"""The questions of `tentacle new`: a flag answers one, a line at a terminal, or a line of a pipe."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from tentacle.cli._output import say_text
from tentacle.errors import InputError, printable
from tentacle.io.parsed_number import parsed_number, usable_number

if TYPE_CHECKING:
    from tentacle.io.recording_template import Answers

LONGEST_LINE = 1000  # characters of an answer that are read: what feeds the input may never end a line
# flag, question, default
LENGTH = (("length", "Length of the arm, from clamp to tip [m]", "0.14"),)
CONE = (
    ("base_radius", "Radius at the clamp [m]", "0.0125"),
    ("tip_radius", "Radius at the tip [m]", "0.004"),
)
RECTANGLE = (
    ("width", "Width across the plane in which it bends [m]", "0.03"),
    ("height", "Thickness in the plane in which it bends [m]", "0.01"),
)
DENSITIES = (
    ("density", "Density of its material [kg/m3]", "1070"),
    ("fluid_density", "Density of the fluid around it [kg/m3], 0 in air", "998"),
)
FLAGS = (*LENGTH, *CONE, *RECTANGLE, *DENSITIES)


def answers_of(arguments: argparse.Namespace) -> Answers:
    """The arm by its flags; what has no flag is asked, in the order of FLAGS. A width or a height makes it a rectangle.

    InputError where a number cannot be used, or both a radius and a width or height are given.
    """
    from tentacle.io.recording_template import Answers
    from tentacle.specimen import Cone, Rectangle

    given = [[name for name, _, _ in kind if getattr(arguments, name) is not None] for kind in (CONE, RECTANGLE)]
    if all(given):
        raise InputError("beside a radius", field=f"--{given[1][0]}", expected="radii, or width and height")
    asked = (*LENGTH, *(RECTANGLE if given[1] else CONE), *DENSITIES)
    found = {name: _answer(getattr(arguments, name), name, *rest) for name, *rest in asked}
    if given[1]:
        section = Rectangle(found["width"], found["height"])
    else:
        section = Cone(found["base_radius"], found["tip_radius"])
    return Answers(found["length"], section, found["density"], found["fluid_density"])


def _answer(given: float | None, name: str, question: str, usual: str) -> float:
    """The flag's number, or the answer to the question; InputError where it is no number or out of range."""
    flag = f"--{name.replace('_', '-')}"
    if given is not None:
        return usable_number(name, given, flag, question)
    return parsed_number(name, _asked(flag, question, usual) or usual, flag, question)


def _asked(flag: str, question: str, usual: str) -> str:
    """The next answer; an empty line takes the usual number. InputError where the input has ended."""
    prompt = f"{question} [{usual}]: "
    try:
        line = input(prompt) if sys.stdin.isatty() else _piped(prompt, usual)
    except EOFError:
        say_text("")
        raise InputError("no answer: the input has ended", field=flag, expected=question) from None
    except UnicodeDecodeError:
        raise InputError("the answer is no text", field=flag, expected=question) from None
    return line.strip()


def _piped(prompt: str, usual: str) -> str:
    """A line of a pipe or a file, shown after its question, so that a log says what was taken as what."""
    say_text(prompt, end="")
    line = sys.stdin.readline(LONGEST_LINE)
    if not line:
        raise EOFError
    say_text(printable(line.strip()) or usual)
    return line

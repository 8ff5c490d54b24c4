"""A number that a person types for recording.toml, at a prompt, in a pipe or in a field of the page."""

from __future__ import annotations

import math

from tentacle.errors import InputError

MAY_BE_ZERO = ("tip_radius", "fluid_density")  # a pointed arm; an arm in air


def parsed_number(name: str, text: str, field: str, expected: str) -> float:
    """The number of one of recording_template.Answers' names, a decimal comma included.

    InputError where the text is no number, or one that cannot be used.
    """
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        raise InputError(f"{text!r} is no number", field=field, expected=expected) from None
    return usable_number(name, value, field, expected)


def usable_number(name: str, value: float, field: str, expected: str) -> float:
    """The value; InputError where it is not finite, negative, or 0 where MAY_BE_ZERO does not have its name."""
    if not 0.0 <= value < math.inf or (value == 0.0 and name not in MAY_BE_ZERO):
        raise InputError(f"{value:g} is out of range", field=field, expected=expected)
    return value

"""Sentences from the validity map: whether the affine model serves for an arm."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.validity_map import AMPLITUDES, MAP_ORDERS, RATIOS

if TYPE_CHECKING:
    from tentacle.signals import Array
    from validation.validity_map import Validity

SWING = 0.4  # rad: up to this amplitude it is asked to serve
GOOD_SHAPE, GOOD_THRUST, STRICT = 0.05, 0.10, 0.01
ENOUGH = 0.5  # of the first mode: up to here it is asked to serve, at least


def largest_ratio(found: Validity, order: int, level: float, errors: Array | None = None) -> float:
    """The largest frequency ratio up to which the error stays under level at every amplitude up to USUAL."""
    usual = [i for i, amplitude in enumerate(AMPLITUDES) if amplitude <= SWING]
    return min(found.reach(order, level, i, errors) for i in usual)


def serves(found: Validity) -> bool:
    """Whether two coordinates keep the shape within 5 % up to half the first mode."""
    return largest_ratio(found, 2, GOOD_SHAPE) >= ENOUGH


def _upto(found: Validity, ratio: float) -> str:
    """The limit of the frequency, in words."""
    if ratio == 0.0:
        return f"not even at {RATIOS[0]:g} of its first mode"
    beyond = ", the end of the map" if ratio == RATIOS[-1] else ""
    return f"up to {ratio * found.first:.2g} Hz ({ratio:g} of its first mode{beyond})"


def sentence(found: Validity) -> str:
    """The answer for one arm."""
    verdict = "serves" if serves(found) else "does not serve"
    shape, strict = (_upto(found, largest_ratio(found, 2, level)) for level in (GOOD_SHAPE, STRICT))
    words = (
        f"The affine model {verdict} for this arm: at amplitudes up to {SWING:g} rad, two coordinates keep its shape"
        f" within {100 * GOOD_SHAPE:.0f} % {shape}, within {100 * STRICT:.0f} % {strict}"
    )
    told = found.thrust[0, [a <= SWING for a in AMPLITUDES]]
    if (told == told).any():
        words += f", its mean thrust within {100 * GOOD_THRUST:.0f} % "
        words += _upto(found, largest_ratio(found, 2, GOOD_THRUST, found.thrust))
    return words + "." + _more(found)


def _more(found: Validity) -> str:
    """The number of coordinates that reach further, if two are not enough."""
    two = largest_ratio(found, 2, GOOD_SHAPE)
    if two == RATIOS[-1]:
        return ""
    for order in MAP_ORDERS[1:]:
        better = largest_ratio(found, order, GOOD_SHAPE)
        if better > two:
            return f" With {order} coordinates the shape stays within {100 * GOOD_SHAPE:.0f} % {_upto(found, better)}."
    return " Three or four coordinates do not reach further."

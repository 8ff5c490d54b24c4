"""A step of grey through a normal blur and a moving edge's smear, and its derivatives (compiled)."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ndtr

from tentacle.compiled import njit

TABLE_END, TABLE_STEPS = 5.0, 100  # table of the normal distribution: its extent in sigmas, steps per sigma
STEP_TABLE = ndtr(np.linspace(-TABLE_END, TABLE_END, round(2 * TABLE_END * TABLE_STEPS) + 1))


@njit(cache=True, inline="always")
def _below(x: float) -> float:
    """The normal distribution function, from a table; good to 3e-6."""
    place = (x + TABLE_END) * TABLE_STEPS
    if not place > 0.0:
        return 0.0
    if place >= len(STEP_TABLE) - 1:
        return 1.0
    index = int(place)
    return STEP_TABLE[index] + (place - index) * (STEP_TABLE[index + 1] - STEP_TABLE[index])


@njit(cache=True, inline="always")
def _bell(x: float) -> float:
    """The normal density."""
    return 0.3989422804014327 * math.exp(-0.5 * x * x)


@njit(cache=True, inline="always")
def rise(d: float, blur: float, half: float) -> float:
    """A step from 0 to 1 at d = 0, through a normal blur and a box of half width half: the smear of a moving edge."""
    if half < 0.15 * blur:
        return _below(d / blur)
    a, b = (d + half) / blur, (d - half) / blur
    return (a * _below(a) + _bell(a) - b * _below(b) - _bell(b)) * blur / (2.0 * half)


@njit(cache=True, inline="always")
def steepness(d: float, blur: float, half: float) -> float:
    """The derivative of rise by d."""
    if half < 0.15 * blur:
        return _bell(d / blur) / blur
    return (_below((d + half) / blur) - _below((d - half) / blur)) / (2.0 * half)


@njit(cache=True, inline="always")
def step_softening(d: float, blur: float, half: float) -> float:
    """The derivative of rise by blur."""
    if half < 0.15 * blur:
        return -d / (blur * blur) * _bell(d / blur)
    return (_bell((d + half) / blur) - _bell((d - half) / blur)) / (2.0 * half)


@njit(cache=True, inline="always")
def bar_is_thin(depth: float, blur: float, half: float) -> bool:
    """Whether the other edge of a bar lies within an edge's profile."""
    return depth < 2.0 * (2.0 * blur + half) + 2.0


@njit(cache=True, inline="always")
def bar_share(d: float, depth: float, blur: float, half: float, thin: bool) -> float:
    """Share of the ground's grey at distance d, with the other edge of a thin bar."""
    c = rise(d, blur, half)
    if thin:
        c += rise(-d - depth, blur, half)
    return c

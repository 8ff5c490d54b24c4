"""The arguments of the compiled functions of one step: tuples of arrays, which numba reads without copying."""

from __future__ import annotations

from typing import NamedTuple

from mujoco_ref.influence import Record
from tentacle.signals import Array


class ChainConstants(NamedTuple):
    """The chain's constants: tables of links (n + 1, 7), nodes (n + 1, 2, 5) and the bodies at the tip (K, 4), mass of
    the mount [kg], gravity (2,) [m/s^2]."""

    links: Array
    nodes: Array
    bodies: Array
    mount_mass: float
    gravity: Array


class Laws(NamedTuple):
    """The records of all influences: hinges (n,), and one each of water, tip and base."""

    hinges: Record
    water: Record
    tip: Record
    base: Record


class Moving(NamedTuple):
    """A chain's state in place: q, v, a (n + 3,), memories of the hinges (n, 2) and of the base (4,)."""

    q: Array
    v: Array
    a: Array
    hinge_memory: Array
    base_memory: Array


class Workspace(NamedTuple):
    """Positions and rates (n + 3,) at the middle of the step; MuJoCo's M, lower triangle by rows, and its inverse
    dynamics M a + C v + weight there; motion of the links (n + 2, 9); reading (5,) as of Stepper."""

    middle: Array
    rate: Array
    mass: Array
    inverse: Array
    motion: Array
    reading: Array


class Now(NamedTuple):
    """Time t [s] at the middle of the step, its length [s], and the factor on the stiffness of all that is elastic."""

    t: float
    step: float
    softening: float


class Midpoint(NamedTuple):
    """Positions (n + 3,) at the start and the middle of a step, rates at its middle."""

    start: Array
    middle: Array
    rate: Array


class Equation(NamedTuple):
    """The arrays to which the laws add: force (n + 3,), matrix (n + 3, n + 3); sums (4,): fluid force without the
    reaction to acceleration (eq. 17) x, y [N], and all other external forces, x, y [N].
    """

    force: Array
    matrix: Array
    sums: Array

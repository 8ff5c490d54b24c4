"""Force laws outside the catalogue, as one kind and nine numbers of the record; a kind is an index into KINDS.

In the plant's own terms: forces on a piece per length, on the last node, and a moment with memory. Speeds are in units
of .1 m/s, so that a power is a plain number.
"""

from __future__ import annotations

import numpy as np

from tentacle.compiled import njit

KINDS = (
    "nothing", "drag_power", "one_way_drag", "drag_near_point", "jet", "vortex", "stop", "tether", "magnet",
    "tip_drag_power", "delayed_spring",
)  # fmt: skip
NUMBERS = (
    "law_kind", "law_a", "law_b", "law_x", "law_y", "law_power", "law_reach", "law_frequency", "law_tau",
)  # fmt: skip
DRAG, ONE_WAY, NEAR_POINT, JET, VORTEX, STOP, TETHER, MAGNET, TIP_DRAG, DELAYED = range(1, len(KINDS))
UNIT_SPEED = 0.1  # m/s


Pair = tuple[float, float]


@njit(cache=True)
def law_on_piece(laws, radius: float, place, velocity, t: float):
    """Force per length along x and y, and how fast its normal part falls with the normal speed."""
    x, y, nx, ny = place
    vx, vy = velocity
    kind, width = laws.law_kind, 2.0 * radius / laws.length
    if kind < DRAG or kind > VORTEX:
        return 0.0, 0.0, 0.0
    fast = (vx * nx + vy * ny) / UNIT_SPEED
    near = 1.0
    if kind in (NEAR_POINT, JET):
        near = np.exp(-((x - laws.law_x) ** 2 + (y - laws.law_y) ** 2) / laws.law_reach**2)
    if kind == JET:
        return laws.law_a * near, laws.law_b * near, 0.0
    if kind == VORTEX:
        w = 2.0 * np.pi * laws.law_frequency
        beat = laws.law_a * np.cos(w * t) + laws.law_b * np.sin(w * t)
        push = beat * width * ((vx * vx + vy * vy) / UNIT_SPEED**2) ** (0.5 * laws.law_power)
        return push * nx, push * ny, 0.0
    if kind == ONE_WAY and fast * laws.law_b <= 0.0:
        return 0.0, 0.0, 0.0
    size = laws.law_a * width * near * (abs(fast) + 1e-9) ** (laws.law_power - 1.0)
    return -size * fast * nx, -size * fast * ny, size / UNIT_SPEED


@njit(cache=True)
def law_at_end(laws, place: Pair, velocity: Pair, normal: Pair):
    """Force on the last node along x and y: the node's place, velocity and normal, each along x and y."""
    kind, (x, y), (vx, vy), (nx, ny) = laws.law_kind, place, velocity, normal
    if kind == STOP:
        beyond = max(0.0, laws.law_b * (x - laws.law_x)) / (0.1 * laws.length)
        return -laws.law_b * laws.law_a * beyond**laws.law_power, 0.0
    if kind == TIP_DRAG:
        fast = (vx * nx + vy * ny) / UNIT_SPEED
        push = -laws.law_a * (abs(fast) + 1e-9) ** (laws.law_power - 1.0) * fast
        return push * nx, push * ny
    if kind in (TETHER, MAGNET):
        to_x, to_y = laws.law_x - x, laws.law_y - y
        far = np.sqrt(to_x * to_x + to_y * to_y)
        if kind == TETHER:
            pull = laws.law_a * max(0.0, far - laws.law_reach) / laws.length
        else:
            far = np.sqrt(far * far + (0.01 * laws.length) ** 2)
            pull = laws.law_a * (0.3 * laws.length / far) ** laws.law_power
        return pull * to_x / far, pull * to_y / far
    return 0.0, 0.0


@njit(cache=True)
def delayed_moment(laws, s: float, second: float, c_rate: float, memory: float, step: float):
    """Moment of a spring behind a dashpot, all along (law_b 0), towards the tip (1) or the clamp (-1); its memory at
    mid-step; and step/2 d moment/dc + d moment/d c_rate.
    """
    if laws.law_kind != DELAYED:
        return 0.0, memory, 0.0
    weight = s if laws.law_b > 0.0 else 1.0 - s if laws.law_b < 0.0 else 1.0
    k = laws.law_a * weight * laws.E * second / laws.length
    half = 0.5 * step / (1.0 + 0.5 * step / laws.law_tau)
    held = memory / (1.0 + 0.5 * step / laws.law_tau) + half * c_rate
    return k * held, held, k * half

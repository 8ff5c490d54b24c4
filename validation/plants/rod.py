"""A planar elastic rod of point masses, stretching and bending, in its tank; implicit midpoint steps (compiled).

It shares no code with the project's models: no curvature coordinates, no rigid links. Nodes are at the ends of PIECES
equal pieces, and every piece resists turning as its part of the arm does. Every length and every angle has a spring
and a dashpot. The water's forces act on every piece at its middle: M (v1 - v0) / h = F(x, v) at mid-step, found by a
few quasi-Newton iterations on a banded matrix.
"""

from __future__ import annotations

import numpy as np

from tentacle.compiled import njit
from tentacle.signals import Array
from validation.plants.hidden_law import delayed_moment, law_at_end, law_on_piece
from validation.plants.material import BRANCHES, bending, slides
from validation.plants.tank import on_piece

PIECES = 32
STEP = 5e-4  # s, at most
ROUNDS, ROUNDS_SLIDING = 3, 20  # more if friction is a steep function of the rate


def move(laws: np.ndarray, theta: Array, step: float, every: int) -> tuple[Array, Array]:
    """Positions (T, PIECES + 1, 2) [m] at every `every`-th step, and the force [N] along y of the arm on its mount.

    laws: one record of validation.plants.laws. theta (2 S + 1,) [rad]: base angle at half steps [s]. FloatingPointError
    where the rod runs away.
    """
    away = FloatingPointError("the rod ran away: take a smaller step")
    try:
        places, pulls = _moved(laws[0], theta, step, every)
    except ZeroDivisionError:
        raise away from None
    if not np.isfinite(places).all():
        raise away
    return places, pulls


@njit(cache=True)
def _solve(band: Array, right: Array) -> None:
    """Solve a symmetric positive matrix, half bandwidth 5, lower diagonals in band (n, 6), in place of right (n,)."""
    n = right.size
    for i in range(n):
        for j in range(max(0, i - 5), i + 1):
            total = band[i, i - j]
            for k in range(max(0, i - 5, j - 5), j):
                total -= band[i, i - k] * band[j, j - k]
            band[i, i - j] = np.sqrt(total) if i == j else total / band[j, 0]
    for i in range(n):
        for k in range(max(0, i - 5), i):
            right[i] -= band[i, i - k] * right[k]
        right[i] /= band[i, 0]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, min(n, i + 6)):
            right[i] -= band[k, k - i] * right[k]
        right[i] /= band[i, 0]


@njit(cache=True)
def _add(band: Array, node_a: int, node_b: int, block: tuple[float, float, float, float]) -> None:
    """Add a 2 x 2 block (xx, xy, yx, yy) of nodes a >= b (node 0 is held, and has no rows)."""
    xx, xy, yx, yy = block
    if node_b == 0:
        return
    row, column = 2 * (node_a - 1), 2 * (node_b - 1)
    for i in range(2):
        for j in range(2):
            if row + i >= column + j:
                value = (xx, xy, yx, yy)[2 * i + j]
                band[row + i, row + i - column - j] += value


@njit(cache=True)
def _moved(laws, theta: Array, step: float, every: int):
    n, length = PIECES, laws.length
    piece = length / n
    x, v = np.zeros((n + 1, 2)), np.zeros((n + 1, 2))
    for i in range(n + 1):
        x[i, 0], x[i, 1] = -piece * i * np.sin(theta[0]), piece * i * np.cos(theta[0])
    v_mid = np.zeros((n + 1, 2))
    radius, area, second, joint_s = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    mass = np.zeros(n + 1)
    for i in range(n):
        radius[i] = laws.base_radius + (laws.tip_radius - laws.base_radius) * (i + 0.5) / n
        area[i] = np.pi * radius[i] ** 2
        joint_s[i] = i / n if i else 0.25 / n  # the clamp bends over half a piece
        second[i] = 0.25 * np.pi * (laws.base_radius + (laws.tip_radius - laws.base_radius) * joint_s[i]) ** 4
        mass[i] += 0.5 * laws.density * area[i] * piece
        mass[i + 1] += 0.5 * laws.density * area[i] * piece
    # The payload's centre is p = x_n + (reach b + drop (b_y, -b_x)) / piece, b the last piece: linear in two nodes.
    ahead, beside = laws.payload_reach / piece, laws.payload_drop / piece
    carried = laws.payload * (1.0 + 0.5 * laws.water / laws.payload_density)
    sunk = laws.payload * (1.0 - laws.water / laws.payload_density)
    memory, kept = np.zeros((n, BRANCHES + 2)), np.zeros((n, BRANCHES + 2))
    force, band, right = np.zeros((n + 1, 2)), np.zeros((2 * n, 6)), np.zeros(2 * n)
    rounds = ROUNDS_SLIDING if slides(laws) else ROUNDS
    steps = (theta.size - 1) // 2
    found, pulls = np.zeros((steps // every + 1, n + 1, 2)), np.zeros(steps // every + 1)
    nx, ny = 1.0, 0.0  # of a piece; after the last one, of the tip
    down_x, down_y = laws.gravity * np.sin(laws.tilt), laws.gravity * np.cos(laws.tilt)
    for k in range(steps):
        if k % every == 0:
            found[k // every] = x
        t, angle = (k + 0.5) * step, theta[2 * k + 1]
        turning = (theta[2 * k + 2] - theta[2 * k]) / step
        for _ in range(rounds):
            force[:] = 0.0
            band[:] = 0.0
            for i in range(1, n + 1):
                _add(band, i, i, (2.0 * mass[i] / step, 0.0, 0.0, 2.0 * mass[i] / step))
                force[i] -= 2.0 * mass[i] / step * (v_mid[i] - v[i])
            for i in range(n):
                ax, ay = x[i] + 0.5 * step * v_mid[i], x[i + 1] + 0.5 * step * v_mid[i + 1]
                bx, by = ay[0] - ax[0], ay[1] - ax[1]
                long = np.sqrt(bx * bx + by * by)
                tx, ty = bx / long, by / long
                nx, ny = ty, -tx
                # Stretch: a spring and a dashpot.
                apart = (v_mid[i + 1, 0] - v_mid[i, 0]) * tx + (v_mid[i + 1, 1] - v_mid[i, 1]) * ty
                pull = area[i] * (laws.E * (long - piece) + laws.eta * apart) / piece
                along = area[i] * (0.5 * step * laws.E + laws.eta) / piece
                across = 0.5 * step * max(pull, 0.0) / long
                # Water, weight.
                ux, uy = 0.5 * (v_mid[i] + v_mid[i + 1])
                wx, wy = 2.0 / step * (0.5 * (v_mid[i] + v_mid[i + 1]) - 0.5 * (v[i] + v[i + 1]))
                spin = ((v_mid[i + 1, 0] - v_mid[i, 0]) * -nx + (v_mid[i + 1, 1] - v_mid[i, 1]) * -ny) / long
                s = (i + 0.5) / n
                px, py = 0.5 * (ax[0] + ay[0]), 0.5 * (ax[1] + ay[1])
                push_n, push_t, couple, inertia, slope = on_piece(
                    laws, (s, radius[i]), (px, py, nx, ny), (ux, uy, wx, wy), spin, t
                )
                own_x, own_y, own_slope = law_on_piece(laws, radius[i], (px, py, nx, ny), (ux, uy), t)
                slope += own_slope
                # The piece's own inertia against turning, beyond that of its masses at its ends and middle.
                line = laws.density * area[i]
                wheel = laws.density * (1.0 + laws.heavier) * 0.25 * np.pi * radius[i] ** 4
                wheel += (inertia + (laws.heavier - 2.0) * line) * piece**2 / 12.0
                gain_x = v_mid[i + 1, 0] - v[i + 1, 0] - v_mid[i, 0] + v[i, 0]
                gain_y = v_mid[i + 1, 1] - v[i + 1, 1] - v_mid[i, 1] + v[i, 1]
                couple += 2.0 / step * wheel * (gain_x * nx + gain_y * ny) / long
                fx = piece * (push_n * nx + push_t * tx + own_x)
                fy = piece * (push_n * ny + push_t * ty + own_y)
                net = (laws.density * (1.0 + laws.heavier) - laws.water * (1.0 + laws.saltier)) * area[i] * piece
                fx, fy = fx + net * down_x, fy + net * down_y
                # A couple C turns the piece: a pair of forces along its normal; n turns with t by +90 degrees of -n.
                cx, cy = piece * couple / long * -nx, piece * couple / long * -ny
                extra = laws.heavier * laws.density * area[i] * piece
                force[i, 0] += pull * tx + 0.5 * fx - cx - 0.5 * extra * wx
                force[i, 1] += pull * ty + 0.5 * fy - cy - 0.5 * extra * wy
                force[i + 1, 0] += -pull * tx + 0.5 * fx + cx - 0.5 * extra * wx
                force[i + 1, 1] += -pull * ty + 0.5 * fy + cy - 0.5 * extra * wy
                across += piece * wheel * 2.0 / step / long**2
                sxx, sxy, syy = along * tx * tx + across * nx * nx, (along - across) * tx * ty, along * ty * ty
                syy += across * ny * ny
                weighted = 0.25 * piece * (2.0 / step * inertia + slope)
                mxx, mxy, myy = weighted * nx * nx, weighted * nx * ny, weighted * ny * ny
                mxx, myy = mxx + 0.5 * extra / step, myy + 0.5 * extra / step
                _add(band, i, i, (sxx + mxx, sxy + mxy, sxy + mxy, syy + myy))
                _add(band, i + 1, i + 1, (sxx + mxx, sxy + mxy, sxy + mxy, syy + myy))
                _add(band, i + 1, i, (mxx - sxx, mxy - sxy, mxy - sxy, myy - syy))
            # The payload, and what pulls at the tip.
            end = x[n] + 0.5 * step * v_mid[n]
            for node in range(2):
                # d p / d x of the last node (1) and of the one before (0): a turn and a stretch.
                real = 1.0 + ahead if node else -ahead
                turn = beside if node else -beside
                for other in range(node + 1):
                    real_o = 1.0 + ahead if other else -ahead
                    turn_o = beside if other else -beside
                    same, cross = real * real_o + turn * turn_o, real * turn_o - turn * real_o
                    heavy = 2.0 / step * carried
                    _add(band, n - 1 + node, n - 1 + other, (heavy * same, heavy * cross, -heavy * cross, heavy * same))
            qx = 2.0 / step * (v_mid[n, 0] - v[n, 0] + ahead * (v_mid[n, 0] - v[n, 0] - v_mid[n - 1, 0] + v[n - 1, 0])
                               + beside * (v_mid[n, 1] - v[n, 1] - v_mid[n - 1, 1] + v[n - 1, 1]))  # fmt: skip
            qy = 2.0 / step * (v_mid[n, 1] - v[n, 1] + ahead * (v_mid[n, 1] - v[n, 1] - v_mid[n - 1, 1] + v[n - 1, 1])
                               - beside * (v_mid[n, 0] - v[n, 0] - v_mid[n - 1, 0] + v[n - 1, 0]))  # fmt: skip
            gx, gy = sunk * down_x - carried * qx, sunk * down_y - carried * qy
            force[n, 0] += (1.0 + ahead) * gx - beside * gy
            force[n, 1] += (1.0 + ahead) * gy + beside * gx
            force[n - 1, 0] += -ahead * gx + beside * gy
            force[n - 1, 1] += -ahead * gy - beside * gx
            dx, dy = laws.magnet_x - end[0], laws.magnet_y - end[1]
            draw = laws.magnet / (dx * dx + dy * dy + 2.5e-5) ** 1.5
            reach_x, reach_y = laws.anchor_x - end[0], laws.anchor_y - end[1]
            far = np.sqrt(reach_x * reach_x + reach_y * reach_y)
            taut = laws.thread * max(0.0, far - laws.slack) / max(far, 1e-9)
            own_x, own_y = law_at_end(laws, (end[0], end[1]), (v_mid[n, 0], v_mid[n, 1]), (nx, ny))
            force[n, 0] += draw * dx + taut * reach_x + own_x
            force[n, 1] += draw * dy + taut * reach_y + own_y
            # Bends: the joint below piece i; the clamp's direction stands for a piece before the first.
            for i in range(n):
                here, ahead_of = x[i] + 0.5 * step * v_mid[i], x[i + 1] + 0.5 * step * v_mid[i + 1]
                b_x, b_y = ahead_of[0] - here[0], ahead_of[1] - here[1]
                square_b = b_x * b_x + b_y * b_y
                up_x, up_y = -b_y / square_b, b_x / square_b
                rate = up_x * (v_mid[i + 1, 0] - v_mid[i, 0]) + up_y * (v_mid[i + 1, 1] - v_mid[i, 1])
                if i == 0:
                    a_x, a_y, low_x, low_y = -np.sin(angle), np.cos(angle), 0.0, 0.0
                    rate -= turning
                else:
                    before = x[i - 1] + 0.5 * step * v_mid[i - 1]
                    a_x, a_y = here[0] - before[0], here[1] - before[1]
                    square_a = a_x * a_x + a_y * a_y
                    low_x, low_y = -a_y / square_a, a_x / square_a
                    rate -= low_x * (v_mid[i, 0] - v_mid[i - 1, 0]) + low_y * (v_mid[i, 1] - v_mid[i - 1, 1])
                span = 0.5 * piece if i == 0 else piece
                turn = np.arctan2(a_x * b_y - a_y * b_x, a_x * b_x + a_y * b_y)
                unit = length / span  # curvature per unit of s
                moment, stiff = bending(
                    laws, (joint_s[i], second[i]), (unit * turn, unit * rate), (memory[i], kept[i]), t, step
                )
                late, held, late_slope = delayed_moment(
                    laws, joint_s[i], second[i], unit * rate, memory[i, BRANCHES + 1], step
                )
                kept[i, BRANCHES + 1] = held
                moment, stiff = moment + late, unit * (stiff + late_slope)
                for node, gx_, gy_ in ((i + 1, up_x, up_y), (i, -up_x - low_x, -up_y - low_y), (i - 1, low_x, low_y)):
                    if node < 0:
                        continue
                    force[node, 0] -= moment * gx_
                    force[node, 1] -= moment * gy_
                _add(
                    band,
                    i + 1,
                    i + 1,
                    (stiff * up_x * up_x, stiff * up_x * up_y, stiff * up_x * up_y, stiff * up_y * up_y),
                )
                if i > 0:
                    mid_x, mid_y = -up_x - low_x, -up_y - low_y
                    _add(
                        band,
                        i,
                        i,
                        (stiff * mid_x * mid_x, stiff * mid_x * mid_y, stiff * mid_x * mid_y, stiff * mid_y * mid_y),
                    )
                    _add(
                        band,
                        i + 1,
                        i,
                        (stiff * up_x * mid_x, stiff * up_x * mid_y, stiff * up_y * mid_x, stiff * up_y * mid_y),
                    )
                    if i > 1:
                        _add(
                            band,
                            i - 1,
                            i - 1,
                            (
                                stiff * low_x * low_x,
                                stiff * low_x * low_y,
                                stiff * low_x * low_y,
                                stiff * low_y * low_y,
                            ),
                        )
                        _add(
                            band,
                            i,
                            i - 1,
                            (
                                stiff * mid_x * low_x,
                                stiff * mid_x * low_y,
                                stiff * mid_y * low_x,
                                stiff * mid_y * low_y,
                            ),
                        )
                        _add(
                            band,
                            i + 1,
                            i - 1,
                            (stiff * up_x * low_x, stiff * up_x * low_y, stiff * up_y * low_x, stiff * up_y * low_y),
                        )
            for i in range(n):
                right[2 * i], right[2 * i + 1] = force[i + 1, 0], force[i + 1, 1]
            _solve(band, right)
            for i in range(n):
                v_mid[i + 1, 0] += right[2 * i]
                v_mid[i + 1, 1] += right[2 * i + 1]
        if k % every == 0:
            pulls[k // every] = force[0, 1]
        for i in range(n):
            memory[i] = 2.0 * kept[i] - memory[i]
        for i in range(1, n + 1):
            for axis in range(2):
                x[i, axis] += step * v_mid[i, axis]
                after = 2.0 * v_mid[i, axis] - v[i, axis]
                v_mid[i, axis] = after + 0.5 * (after - v[i, axis])  # the next middle, by the last acceleration
                v[i, axis] = after
    found[-1] = x
    return found, pulls

"""Code of the forces that act at the tip: the tip's state, each effect's force there, its part of the equations."""

from __future__ import annotations

import re
import textwrap

from affine_model.effects import catalogue
from affine_model.kernel.trace import lines, slope_along, traced

TIP_QUANTITIES = (
    "x",
    "y",
    "phi",
    "phi_rate",
    "u_n",
    "u_t",
    "speed",
)  # of the section quantities, what the tip has of its own
_AT_NODE = re.compile(rf"\b({'|'.join(TIP_QUANTITIES)})\[i, b\]")

_STATE = """\
end_phi = mid[n, b] + total(A_end[j] * mid[j, b] for j in unrolled(n))
end_phi_rate = mid_rate[n, b] + total(A_end[j] * mid_rate[j, b] for j in unrolled(n))
end_sine, end_cosine = sincos(end_phi)
for j in unrolled(n + 1):
    tip_x[j, b] = length * total(wA[j, k] * normal_x[k, b] for k in unrolled(NODES))
    tip_y[j, b] = length * total(wA[j, k] * normal_y[k, b] for k in unrolled(NODES))
tip_x[n + 1, b] = 0.0
tip_y[n + 1, b] = 1.0
for _ in unrolled(FREE):
    tip_x[n + 2, b] = 1.0
    tip_y[n + 2, b] = 0.0
end_x = travel[0, b] + tip_y[n, b]
end_y = travel[1, b] - tip_x[n, b]
end_going_x = travel[2, b] + total(tip_x[j, b] * mid_rate[j, b] for j in unrolled(n + 1)) - water_x[b]
end_going_y = travel[3, b] + mid_rate[n + 1, b] - water_y[b]
end_going_y = end_going_y + total(tip_y[j, b] * mid_rate[j, b] for j in unrolled(n + 1))
for _ in unrolled(FREE):
    end_x += mid[n + 2, b]
    end_y += mid[n + 1, b]
    end_going_x += mid_rate[n + 2, b]
end_u_n = end_going_x * end_cosine + end_going_y * end_sine
end_u_t = end_going_y * end_cosine - end_going_x * end_sine
end_speed = math.sqrt(end_u_n * end_u_n + end_u_t * end_u_t + 1e-16)
end_n = 0.0
end_t = 0.0
slip_n = 0.0
slip_t = 0.0
"""

_SUMS = """\
push_x = end_n * end_cosine - end_t * end_sine
push_y = end_n * end_sine + end_t * end_cosine
fluid_x[b] += push_x
fluid_y[b] += push_y
xx = 0.5 * h * (slip_n * end_cosine * end_cosine + slip_t * end_sine * end_sine)
xy = 0.5 * h * (slip_n - slip_t) * end_cosine * end_sine
yy = 0.5 * h * (slip_n * end_sine * end_sine + slip_t * end_cosine * end_cosine)
for j in unrolled(D):
    residual[j, b] += tip_x[j, b] * push_x + tip_y[j, b] * push_y
    for l in unrolled(j + 1):
        matrix[j, l, b] += (tip_x[j, b] * (xx * tip_x[l, b] + xy * tip_y[l, b])
                            + tip_y[j, b] * (xy * tip_x[l, b] + yy * tip_y[l, b]))
"""


def tip_forces() -> str:
    """The block of all effects with a tip_force; nothing where there is none."""
    text: list[str] = []
    for number, effect in enumerate(catalogue().values()):
        if effect.tip_force is None:
            continue
        normal, tangential = traced(effect, "tip_force")
        assignments = [
            ("end_n", "+=", normal),
            ("end_t", "+=", tangential),
            ("slip_n", "-=", slope_along(normal, "u_n")),
            ("slip_t", "-=", slope_along(tangential, "u_t")),
        ]
        own = [_AT_NODE.sub(r"end_\1", line) for line in lines(assignments, "")]
        text += [f"if active[{number}]:", "    for b in range(BLOCK):"]
        text += textwrap.indent(_STATE + "\n".join(own) + "\n" + _SUMS, " " * 8).splitlines()
    return textwrap.indent("\n".join(text), " " * 12)

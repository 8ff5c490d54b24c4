"""Each effect at a typical size: its numbers, which of them are its strength, and the largest useful strength."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Numbers = dict[str, float]
Size = tuple[Numbers, tuple[str, ...], float]


@dataclass(frozen=True)
class Draw:
    """The random choices for an effect: the arm on which it acts, its law, a sign, a direction [rad], a share (0 ..
    1).
    """

    arm: Numbers
    law: str
    sign: float
    turn: float
    share: float


Typical = Callable[[Draw], Size]


def _tip_mass(d: Draw) -> Size:
    base, tip, length = d.arm["base_radius"], d.arm["tip_radius"], d.arm["length"]
    weight = np.pi / 3.0 * (base**2 + base * tip + tip**2) * length * d.arm["density"]
    reach = (0.05 + 0.1 * d.share) * length if d.law == "ahead" else 0.0
    drop = d.sign * (0.05 + 0.1 * d.share) * length if d.law == "below" else 0.0
    return {"payload": 0.05 * weight, "payload_reach": reach, "payload_drop": drop}, ("payload",), 2.0 * weight


TYPICAL: dict[str, Typical] = {
    "added_mass": lambda d: ({"C_a": 0.8 + 0.4 * d.share}, ("C_a",), 1.5),
    "skin_drag": lambda _: ({"C_t": 0.2}, ("C_t",), 3.0),
    "linear_drag": lambda d: ({"c_n": 0.3, "tangent": 0.5 * int(3.0 * d.share)}, ("c_n",), 20.0),
    "current": lambda d: (
        {"U_x": 0.05 * np.cos(d.turn), "U_y": 0.05 * np.sin(d.turn)}, ("U_x", "U_y"), 0.5,
    ),
    "sloshing": lambda d: (
        {"U_cos": 0.03 * np.cos(d.turn), "U_sin": 0.03 * np.sin(d.turn), "slosh_f": 0.5 + d.share},
        ("U_cos", "U_sin"), 0.5,
    ),
    "wall": lambda d: (
        {"wall_B": 20.0, "wall_x": d.sign * (0.3 + 0.3 * d.share) * d.arm["length"]}, ("wall_B",), 200.0,
    ),
    "buoyancy": lambda d: (
        {"heavier" if d.law == "arm" else "saltier": 0.03 * d.sign}, ("heavier" if d.law == "arm" else "saltier",), 0.3,
    ),
    "gravity_tilt": lambda d: (
        {"tilt": 0.1 * d.sign, "weakened": 0.0 if d.law == "in_plane" else 0.02 + 0.03 * d.share}, ("tilt",), 1.2,
    ),
    "tip_mass": _tip_mass,
    "cubic_stiffness": lambda _: ({"beta": 0.3}, ("beta",), 5.0),
    "intrinsic_curvature": lambda d: ({"c0": 0.1 * d.sign}, ("c0",), 2.0),
    "viscoelasticity": lambda d: (
        {"g": 0.3, "tau": float(np.exp(np.log(0.1) + d.share * np.log(15.0)))}, ("g",), 4.0,
    ),
    "dry_friction": lambda d: ({"c_f": 0.05, "slip": 0.005 + 0.02 * d.share}, ("c_f",), 1.0),
    "soft_spot": lambda d: ({"depth": 0.3, "s0": 0.15 + 0.4 * d.share}, ("depth",), 0.9),
    "stiffness_drift": lambda d: ({"rate": 3e-3 * d.sign, "settling": 8.0 + 10.0 * d.share}, ("rate",), 0.02),
    "amplitude_damping": lambda _: ({"b": 0.03}, ("b",), 1.0),
    "servo_lag": lambda _: ({"lag": 0.03}, ("lag",), 0.15),
    "backlash": lambda _: ({"play": 0.04}, ("play",), 0.3),
    "time_offset": lambda d: ({"offset": 0.02 * d.sign}, ("offset",), 0.2),
    "camera_roll": lambda d: ({"roll": 0.02 * d.sign}, ("roll",), 0.3),
    "camera_scale": lambda d: ({"excess": 0.02 * d.sign}, ("excess",), 0.2),
    "magnet": lambda d: (
        {"magnet": 5e-6, "magnet_x": 0.4 * d.sign * d.arm["length"],
         "magnet_y": (1.0 + 0.2 * d.share) * d.arm["length"]},
        ("magnet",), 1e-3,
    ),
    "thread": lambda d: (
        {"thread": 0.05, "anchor_x": 0.5 * d.sign * d.arm["length"],
         "anchor_y": (0.9 + 0.2 * d.share) * d.arm["length"], "slack": 0.5 * d.arm["length"]}, ("thread",), 50.0,
    ),
    "vortex": lambda d: (
        {"vortex": 0.6,
         "vortex_f": 0.03 / (d.arm["base_radius"] + d.arm["tip_radius"]) * (0.8 + 0.7 * d.share)},
        ("vortex",), 6.0,
    ),
}  # fmt: skip

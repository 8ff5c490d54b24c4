"""Strengths of hidden effects: drawn at random around a typical size, then scaled to the requested change of the
midline.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mujoco_ref.influence import KNOWN, UNCATALOGUED
from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.specimen import Cone

# Midline change by the effect, rms over points and frames, in standard deviations of the midline's noise.
STRENGTH_SIZES: dict[str, tuple[float, float]] = {"visible": (6.0, 15.0), "faint": (0.7, 2.0)}

Generator = np.random.Generator


def _sign(random: Generator) -> float:
    return float(random.choice([-1.0, 1.0]))


def _widest(model: Model) -> float:
    """A typical width of the section [m]."""
    section = model.specimen.section
    return 2.0 * section.base_radius if isinstance(section, Cone) else section.section_width


# Per effect: the parameters of which all strengths scale together, and a draw of typical values.
SCALED_TOGETHER: dict[str, tuple[str, ...]] = {
    "added_mass": ("C_a",),
    "skin_drag": ("C_t",),
    "linear_drag": ("c_n",),
    "current": ("U_x", "U_y"),
    "sloshing": ("U_cos", "U_sin"),
    "wall": ("B",),
    "buoyancy": ("density_error",),
    "gravity_tilt": ("tilt",),
    "tip_mass": ("mass",),
    "cubic_stiffness": ("beta",),
    "intrinsic_curvature": ("c0",),
    "viscoelasticity": ("g",),
    "dry_friction": ("c_f",),
    "soft_spot": ("depth",),
    "stiffness_drift": ("rate",),
    "servo_lag": ("tau",),
    "backlash": ("play",),
    "time_offset": ("offset",),
    "camera_roll": ("roll",),
    "camera_scale": ("excess",),
    "third_curvature": (),
    "thread": ("stiffness",),
    "clamp_slip": ("moment",),
    "suction": ("U",),
    "mount_resonance": ("mass",),
    "vortex": ("C_L",),
    "magnet": ("strength",),
}
# A larger value of these makes the effect smaller: a clamp that slips later, a heavier stand.
INVERSE = ("clamp_slip", "mount_resonance")
# Strengths beyond these have no meaning: a soft spot that breaks, a drift that makes the stiffness negative.
LARGEST_STRENGTH: dict[str, float] = {
    "soft_spot": 0.9,
    "camera_scale": 0.3,
    "camera_roll": 0.5,
    "stiffness_drift": 0.02,
    "servo_lag": 0.3,
    "backlash": 0.4,
    "time_offset": 0.3,
    "viscoelasticity": 5.0,
    "dry_friction": 1.0,
    "cubic_stiffness": 10.0,
    "added_mass": 4.0,
    "skin_drag": 3.0,
    "wall": 100.0,
    "gravity_tilt": 1.2,
    "buoyancy": 300.0,
    "current": 0.6,
    "sloshing": 0.6,
    "vortex": 5.0,
    "suction": 1.0,
}


def _direction(random: Generator, size: float) -> dict[str, float]:
    angle = random.uniform(0.0, 2.0 * np.pi)
    return {"U_x": float(size * np.cos(angle)), "U_y": float(size * np.sin(angle))}


def typical(effect: str, model: Model, random: Generator) -> dict[str, float]:
    """Parameters of a typical size, drawn at random: sign, direction, place, frequency. InputError for an unknown
    effect."""
    length = model.specimen.length
    phase = random.uniform(0.0, 2.0 * np.pi)
    draws: dict[str, Callable[[], dict[str, float]]] = {
        "added_mass": lambda: {"C_a": 1.0},
        "skin_drag": lambda: {"C_t": 0.2},
        "linear_drag": lambda: {"c_n": 0.5},
        "current": lambda: _direction(random, 0.05),
        "sloshing": lambda: {
            "U_cos": float(0.05 * np.cos(phase)),
            "U_sin": float(0.05 * np.sin(phase)),
            "f": random.uniform(0.6, 1.8),
        },
        "wall": lambda: {"B": 5.0, "distance": _sign(random) * random.uniform(0.3, 0.7)},
        "buoyancy": lambda: {"density_error": _sign(random) * 30.0},
        "gravity_tilt": lambda: {"tilt": _sign(random) * 0.1},
        "tip_mass": lambda: {"mass": 0.05 * model.specimen.mass},
        "cubic_stiffness": lambda: {"beta": 0.3},
        "intrinsic_curvature": lambda: {"c0": _sign(random) * 0.1},
        "viscoelasticity": lambda: {"g": 0.3, "tau": float(np.exp(random.uniform(np.log(0.1), np.log(2.0))))},
        "dry_friction": lambda: {"c_f": 0.05},
        "soft_spot": lambda: {"depth": 0.3, "s0": random.uniform(0.15, 0.6)},
        "stiffness_drift": lambda: {"rate": _sign(random) * 2e-3},
        "servo_lag": lambda: {"tau": 0.03},
        "backlash": lambda: {"play": 0.04},
        "time_offset": lambda: {"offset": _sign(random) * 0.02},
        "camera_roll": lambda: {"roll": _sign(random) * 0.02},
        "camera_scale": lambda: {"excess": _sign(random) * 0.02},
        "third_curvature": dict,
        "thread": lambda: {
            "stiffness": 0.05,
            "slack": 0.5 * length,
            "anchor_x": _sign(random) * 0.5 * length,
            "anchor_y": random.uniform(0.9, 1.1) * length,
        },
        "clamp_slip": lambda: {"moment": 3e-3},
        "suction": lambda: {"U": _sign(random) * 0.3, "f": random.uniform(0.3, 0.8), "reach": 0.5 * length},
        "mount_resonance": lambda: {"mass": 0.1, "f": random.uniform(1.5, 3.5), "damping_ratio": 0.05},
        "vortex": lambda: {"C_L": 0.6, "f": 0.2 * 0.15 / _widest(model) * random.uniform(0.8, 1.5)},
        "magnet": lambda: {"strength": _sign(random) * 5e-6, "x": _sign(random) * 0.4 * length, "y": 1.1 * length},
    }
    if effect not in draws:
        hidden = [*(name for name in KNOWN if name in draws)]
        raise InputError("cannot be hidden", field=effect, expected=f"one of {', '.join(hidden)}")
    return draws[effect]()


def scaled(effect: str, parameters: dict[str, float], factor: float) -> dict[str, float]:
    """The parameters with all strengths multiplied, the largest one cut at the limit of the effect."""
    names = SCALED_TOGETHER[effect]
    largest = max((abs(parameters[name]) for name in names if name in parameters), default=0.0)
    if largest > 0.0 and effect in LARGEST_STRENGTH:
        factor = min(factor, LARGEST_STRENGTH[effect] / largest)
    if effect in INVERSE:
        factor = 1.0 / factor
    return {name: value * factor if name in names else value for name, value in parameters.items()}


def is_catalogued(effect: str) -> bool:
    """Whether the loop's catalogue has the effect."""
    return effect not in UNCATALOGUED

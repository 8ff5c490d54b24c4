"""All effects on an arm in a tank as numbers, in one record that every plant's compiled code reads.

Zero: the effect is absent. Each effect has two or more published laws; a number says which one acts (the `_law` fields,
named in LAWS).
"""

from __future__ import annotations

import numpy as np

from validation.plants.hidden_law import NUMBERS

# effect -> the names of its laws; the law's number is its place.
LAWS: dict[str, tuple[str, ...]] = {
    "added_mass": ("kirchhoff", "morison", "kirchhoff_with_end", "morison_with_end"),
    "skin_drag": ("speed", "independent"),
    "linear_drag": ("uniform", "radius"),
    "current": ("uniform", "boundary_layer"),
    "sloshing": ("one_frequency", "two_frequencies"),
    "wall": ("drag_dnv", "drag_inverse_square", "drag_and_added_mass"),
    "buoyancy": ("arm", "water"),
    "gravity_tilt": ("in_plane", "also_out_of_plane"),
    "tip_mass": ("at_tip", "ahead", "below"),
    "cubic_stiffness": ("duffing", "sinh"),
    "intrinsic_curvature": ("uniform", "towards_clamp"),
    "viscoelasticity": ("one_branch", "two_branches", "fractional"),
    "dry_friction": ("tanh", "dahl", "lugre"),
    "soft_spot": ("gaussian", "box", "taper", "compliance"),
    "stiffness_drift": ("linear", "settling"),
    "amplitude_damping": ("square", "hysteretic"),
    "servo_lag": ("first_order", "second_order"),
    "backlash": ("stiff", "sprung"),
    "time_offset": ("constant", "drifting_clock"),
    "camera_roll": ("about_clamp", "about_picture"),
    "camera_scale": ("uniform", "with_distortion"),
}
OUTSIDE = ("magnet", "thread", "vortex")  # outside the catalogue

_LAW_FIELDS = tuple(f"{effect}_law" for effect in LAWS)
_FIELDS = (
    # the arm and its surroundings [SI]
    "length", "base_radius", "tip_radius", "density", "water", "gravity", "tilt", "E", "eta", "C_perp",
    "payload", "payload_reach", "payload_drop", "payload_density",
    # fluid
    "C_a", "C_t", "c_n", "tangent", "U_x", "U_y", "U_cos", "U_sin", "slosh_f", "wall_B", "wall_x", "saltier", "vortex",
    "vortex_f",
    # material; curvatures per unit of s [rad]
    "heavier", "beta", "c0", "g", "tau", "c_f", "slip", "depth", "s0", "rate", "settling", "b",
    # at the tip, outside the catalogue
    "magnet", "magnet_x", "magnet_y", "thread", "anchor_x", "anchor_y", "slack",
)  # fmt: skip
RECORD = np.dtype([(name, np.float64) for name in (*_FIELDS, *NUMBERS, *_LAW_FIELDS)])


def law_record(**values: float) -> np.ndarray:
    """One record (1,) with these numbers, all others zero. ValueError for an unknown name."""
    made = np.zeros(1, RECORD)
    made["tau"], made["slip"], made["s0"], made["slosh_f"], made["settling"] = 1.0, 0.01, 0.3, 1.0, 10.0
    made["payload_density"], made["slack"] = 7850.0, 1.0
    made["law_reach"], made["law_tau"] = 1.0, 1.0
    for name, value in values.items():
        if name not in (RECORD.names or ()):
            raise ValueError(f"no number is called {name!r}")
        made[name] = value
    return made


def law_number(effect: str, law: str) -> int:
    """The index of a law among those of its effect. ValueError if there is none of that name."""
    return LAWS[effect].index(law)

"""Where an export carries each effect of a model: in MuJoCo alone, in arm_forces.py, or in neither."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

from mujoco_ref.chain import clamp_gives
from tentacle.errors import InputError
from tentacle.model import Model

# Effect -> MuJoCo's own means for it.
NATIVE = {
    "elasticity": "joint stiffness",
    "damping": "joint damping",
    "inertia": "link masses",
    "weight": "gravity",
    "third_curvature": "the chain's hinges",
    "buoyancy": "gravcomp, link masses",
    "gravity_tilt": "direction of gravity",
    "tip_mass": "a body at the tip",
    "payload_place": "where the payload's body hangs",
    "cubic_stiffness": "cubic joint stiffness",
    "intrinsic_curvature": "springref",
    "soft_spot": "joint stiffness",
    "current": "wind",
}
# Effect -> its substitute in arm.xml, which arm_forces.py replaces by the exact law.
SUBSTITUTED = {
    "added_mass": "added to the links' mass, the same in every direction",
    "drag": "plates in MuJoCo's ellipsoid fluid, exact where the flow is along or across a link",
    "skin_drag": "slender drag of those plates, exact where the flow is along a link",
}
# Effects that are in arm_forces.py only.
CALLBACK_ONLY = ("linear_drag", "sloshing", "viscoelasticity", "dry_friction", "stiffness_drift",
                 "amplitude_damping", "wall", "cross_flow", "reynolds_drag", "oscillating_drag", "shed_tip",
                 "vortex_lift")  # fmt: skip
# Effect -> where it belongs instead.
NOT_IN_THE_ARM = {
    "servo_lag": "the command: delay theta before it goes to ctrl",
    "backlash": "the command: put the play before ctrl",
    "time_offset": "the measurement: shift and stretch the recording's clock",
    "camera_roll": "the measurement: turn the points that are compared",
    "camera_scale": "the measurement: scale the points that are compared",
}


@dataclass(frozen=True)
class Carried:
    """kept: the model without what is in neither file. native, substituted, callback: effect names; left: name -> why
    not.
    """

    kept: Model
    native: tuple[str, ...]
    substituted: tuple[str, ...]
    callback: tuple[str, ...]
    left: dict[str, str]

    def sentences(self) -> list[str]:
        """One line for each effect or group of effects: which file has it."""
        lines = ["arm.xml carries: " + ", ".join(f"{name} ({NATIVE[name]})" for name in self.native) + "."]
        lines += [f"arm.xml stands in for {name}: {SUBSTITUTED[name]}." for name in self.substituted]
        exact = [*self.substituted, *self.callback]
        if exact:
            lines.append("arm_forces.py carries: " + ", ".join(exact) + ".")
        return lines + [f"Neither carries {name}: {why}." for name, why in self.left.items()]


def refuse_clamp(model: Model) -> None:
    """InputError where the arm's clamp gives, of an export that has no hinge for it."""
    if clamp_gives(model.specimen):
        given = f"{model.specimen.clamp_length!r} is not exported"
        raise InputError(given, field="clamp_length_m", expected="0, a rigid clamp, or --to mjcf")


def carried_by(model: Model) -> Carried:
    """Sort the model's effects, including those that every model has."""
    names = list(dict.fromkeys(("inertia", "weight", *model.parameters)))
    left = {
        name: NOT_IN_THE_ARM.get(name, "no law of it is known to the exporter") for name in names
        if name not in NATIVE and name not in SUBSTITUTED and name not in CALLBACK_ONLY
    }  # fmt: skip
    kept = replace(model, parameters={name: values for name, values in model.parameters.items() if name not in left})
    wet = model.fluid.density > 0.0

    def those(known: Collection[str]) -> tuple[str, ...]:
        return tuple(name for name in names if name in known)

    return Carried(kept, those(NATIVE), those(SUBSTITUTED) if wet else (), those(CALLBACK_ONLY), left)

"""The input of `optimise`: an arm, fitted or assumed, the servo's limits, and the hull that swims freely."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from affine_model.free_body import Hull
    from affine_model.swim import GaitLimits
    from tentacle.model import Model

SERVO = ("angle_rad", "speed_rad_s", "acceleration_rad_s2")
DRIVE = ("torque_n_m", "bandwidth_hz", "lowest_frequency_hz", "highest_frequency_hz")
HULL = {
    "mass_kg": "mass", "yaw_inertia_kg_m2": "yaw_inertia",
    "viscous_across_n_s_m": "viscous_across", "viscous_along_n_s_m": "viscous_along",
    "drag_across_n_s2_m2": "drag_across", "drag_along_n_s2_m2": "drag_along",
    "yaw_viscous_n_m_s": "yaw_viscous", "yaw_drag_n_m_s2": "yaw_drag",
}  # fmt: skip


def read_arm(path: Path, silicone: str) -> Model:
    """The model in a model.toml, or textbook numbers for the specimen of a recording.toml or import folder."""
    from affine_model.swim import assumed_model
    from tentacle.io.declaration_file import read_recording_file
    from tentacle.io.model_file import read_model
    from tentacle.io.toml_table import read_toml
    from tentacle.specimen import WATER

    file = path / "recording.toml" if path.is_dir() else path
    _, values = read_toml(file)
    if "effects" in values:
        return read_model(file)
    declaration = read_recording_file(file).declaration
    fluid = declaration.fluid if "fluid" in values else WATER
    return assumed_model(declaration.specimen, silicone, fluid, declaration.gravity)


def read_limits(path: Path | None) -> GaitLimits:
    """The servo's limits in a TOML file, with defaults for missing fields; InputError names the wrong field."""
    from dataclasses import replace

    from affine_model.swim import HOBBY_SERVO, GaitLimits
    from tentacle.io.toml_table import Table, read_toml

    if path is None:
        return GaitLimits()
    text, values = read_toml(path)
    document = Table(values, file=path, text=text)
    table = document.required_table("limits")
    servo = {name: table.number(name, above=0) for name in SERVO if name in table}
    drive = {name: table.number(name, above=0) for name in DRIVE if name in table}
    table.finish()
    document.finish()

    def field(name: str) -> str:  # bandwidth_hz -> bandwidth
        return next(
            name.removesuffix(unit) for unit in ("_rad_s2", "_rad_s", "_rad", "_n_m", "_hz") if name.endswith(unit)
        )

    limited = replace(HOBBY_SERVO, **{field(name): value for name, value in servo.items()})
    return GaitLimits(limited, **{field(name): value for name, value in drive.items()})


def read_hull(path: Path | None) -> Hull:
    """The hull in a TOML file: its mass and yaw inertia, and of its drags those that it has; without a file, the
    package's own. InputError names the wrong field.
    """
    from affine_model.free_body import Hull
    from affine_model.swim import SERVO_HULL
    from tentacle.io.toml_table import Table, read_toml

    if path is None:
        return SERVO_HULL
    text, values = read_toml(path)
    document = Table(values, file=path, text=text)
    table = document.required_table("hull")
    needed = {HULL[name]: table.number(name, above=0) for name in ("mass_kg", "yaw_inertia_kg_m2")}
    drags = {HULL[name]: table.number(name, least=0) for name in list(HULL)[2:] if name in table}
    table.finish()
    document.finish()
    return Hull(**needed, **drags)

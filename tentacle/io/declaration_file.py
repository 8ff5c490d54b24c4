"""recording.toml: the declaration of a recording, as text and back. The format is in docs/import_folder.md."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

import tomli_w

from tentacle.declared import Uncertain
from tentacle.io.acceleration_file import acceleration_table, parse_acceleration
from tentacle.io.strain_file import parse_strain, strain_table
from tentacle.io.toml_table import Table, read_toml
from tentacle.recording import Camera, Declaration
from tentacle.signals import Accelerometer, StrainGauge
from tentacle.specimen import (
    AIR,
    HANGING_DOWN,
    MOST_SHEAR,
    STANDARD_GRAVITY,
    STEEL,
    AddedMass,
    Cone,
    Fluid,
    Gravity,
    Rectangle,
    Section,
    Specimen,
    StiffnessLaw,
)

UNIT_VECTOR_SLACK = 0.01  # arm_px read off a screen has two digits; it is normalised
LONGEST_ARM = 10.0  # m; more is millimetres by mistake
LIGHTEST_SOLID = 10.0  # kg/m^3; less is g/cm^3 by mistake


@dataclass(frozen=True)
class RecordingFile:
    """The content of recording.toml: the declaration, the place of each marker (s, d [m]), the strain gauges,
    the accelerometers, a name and notes.
    """

    declaration: Declaration
    markers: dict[str, tuple[float, float]] = field(default_factory=dict)
    strain: dict[str, StrainGauge] = field(default_factory=dict)
    acceleration: dict[str, Accelerometer] = field(default_factory=dict)
    name: str | None = None
    notes: dict[str, str] = field(default_factory=dict)


def parse_recording_file(values: dict[str, Any], *, file: Path | None = None, text: str = "") -> RecordingFile:
    """recording.toml's content, checked. InputError names line and field of the first thing that is wrong."""
    document = Table(values, file=file, text=text)
    specimen = parse_specimen(document.required_table("specimen"))
    fluid, gravity, camera = (document.table(key, optional=True) for key in ("fluid", "gravity", "camera"))
    motor, release, base, plane = (document.table(k, optional=True) for k in ("motor", "release", "base", "plane"))
    declaration = Declaration(
        specimen=specimen,
        fluid=parse_fluid(fluid) if fluid else AIR,
        gravity=parse_gravity(gravity) if gravity else HANGING_DOWN,
        camera=_parse_camera(camera) if camera else None,
        motor_mode=cast(Any, _parse_motor_mode(motor)) if motor else "prescribed",
        release_t=_parse_release(release) if release else None,
        seen_from=cast(Any, _parse_base(base)) if base else "ground",
        out_of_plane=_parse_plane(plane) if plane else None,
    )
    markers, notes = document.table("markers", optional=True), document.table("notes", optional=True)
    positions = _parse_markers(markers) if markers else {}
    strain = document.table("strain", optional=True)
    gauges = parse_strain(strain, specimen.length) if strain else {}
    acceleration = document.table("acceleration", optional=True)
    accelerometers = parse_acceleration(acceleration) if acceleration else {}
    found = RecordingFile(
        declaration=replace(declaration, uncertain=tuple(document.uncertain)),
        markers=positions,
        strain=gauges,
        acceleration=accelerometers,
        name=document.string("name", "") or None,
        notes={key: notes.string(key) for key in notes} if notes else {},
    )
    document.finish()
    return found


def parse_specimen(table: Table) -> Specimen:
    """[specimen]: section, sizes, density, payload, stiffness law."""
    kind = table.choice("section", ("cone", "rectangle"))
    section: Section
    if kind == "cone":
        section = Cone(table.measured("base_radius_m", above=0), table.measured("tip_radius_m", least=0))
        foreign = ("width_m", "height_m")
    else:
        section = Rectangle(table.measured("width_m", above=0), table.measured("height_m", above=0))
        foreign = ("base_radius_m", "tip_radius_m")
    for key in foreign:
        if key in table:
            raise table.error(f'does not belong to section = "{kind}"', key)
    length = table.measured("length_m", above=0, most=LONGEST_ARM)
    specimen = Specimen(
        section=section,
        length=length,
        density=table.measured("density_kg_m3", least=LIGHTEST_SOLID),
        tip_mass=table.measured("tip_mass_kg", 0.0, least=0),
        stiffness=cast(StiffnessLaw, table.choice("stiffness", ("section", "affine"), "section")),
        tip_mass_reach=table.measured("tip_mass_reach_m", 0.0, least=-length, most=length),
        tip_mass_drop=table.measured("tip_mass_drop_m", 0.0, least=-length, most=length),
        tip_mass_density=table.measured("tip_mass_density_kg_m3", STEEL, least=LIGHTEST_SOLID),
        tip_rounding=table.number("tip_rounding_m", least=0) if "tip_rounding_m" in table else None,
        laws=table.names("laws"),
        clamp_length=table.measured("clamp_length_m", 0.0, least=0, most=length),
        shear_compliance=table.measured("shear_compliance", 0.0, least=0, most=MOST_SHEAR),
    )
    table.finish()
    thickness = 2.0 * float(section.half_thickness(0.0))
    if thickness > specimen.length:
        raise table.error(
            f"{specimen.length!r} is less than the arm is thick ({thickness:g} m)", "length_m", "metres, a slender arm"
        )
    return specimen


def parse_fluid(table: Table) -> Fluid:
    """[fluid]: density, 0 or absent for air; the declared added mass."""
    density = table.measured("density_kg_m3", 0.0, least=0)
    fluid = Fluid(density, cast(AddedMass, table.choice("added_mass", ("none", "section", "fit"), "none")))
    table.finish()
    return fluid


def parse_gravity(table: Table) -> Gravity:
    """[gravity]: angle_rad, and magnitude_m_s2 if it is not the standard one."""
    angle = table.measured("angle_rad", 0.0, least=-2 * math.pi, most=2 * math.pi)
    gravity = Gravity(angle, table.number("magnitude_m_s2", STANDARD_GRAVITY, least=0))
    table.finish()
    return gravity


def _parse_camera(table: Table) -> Camera:
    fps = table.number("fps", above=0)
    scale = table.measured("m_per_px", above=0)
    base = table.numbers("base_px", 2)
    arm = table.numbers("arm_px", 2)
    norm = math.hypot(*arm)
    if abs(norm - 1.0) > UNIT_VECTOR_SLACK:
        raise table.error(f"{list(arm)} has length {norm:.4g}", "arm_px", "a unit vector along the straight arm")
    if abs(norm - 1.0) > 1e-9:  # a vector that is already a unit vector stays as it was written, to the last bit
        arm = (arm[0] / norm, arm[1] / norm)
    camera = Camera(
        fps=fps,
        metres_per_px=scale,
        base_px=(base[0], base[1]),
        arm_px=(arm[0], arm[1]),
        exposure=table.number("exposure_s", 0.0, least=0),
        mirrored=table.boolean("mirrored", False),
    )
    table.finish()
    if camera.exposure * fps > 1.0:
        raise table.error(
            f"{camera.exposure!r} is longer than a frame lasts at {fps:g} fps", "exposure_s", f"seconds, <= {1 / fps:g}"
        )
    return camera


def _parse_motor_mode(table: Table) -> str:
    mode = table.choice("mode", ("prescribed", "servo"), "prescribed")
    table.finish()
    return mode


def _parse_base(table: Table) -> str:
    """[base]: the frame in which the positions of an arm on a travelling base are counted."""
    seen_from = table.choice("seen_from", ("ground", "base"), "ground")
    table.finish()
    return seen_from


def _parse_plane(table: Table) -> float:
    """[plane]: the share of a spatial arm's motion out of the plane of the points."""
    share = table.number("out_of_plane_share", least=0, most=1)
    table.finish()
    return share


def _parse_release(table: Table) -> float:
    time = table.measured("t_s", least=0)
    table.finish()
    return time


def _parse_markers(table: Table) -> dict[str, tuple[float, float]]:
    positions = {}
    for name in table:
        marker = table.required_table(name)
        positions[name] = (marker.measured("s", least=0, most=1), marker.measured("d"))
        marker.finish()
    return positions


def declaration_tables(declaration: Declaration) -> dict[str, Any]:
    """A declaration as recording.toml's tables; parse_recording_file gives it back exactly."""
    specimen, camera = declaration.specimen, declaration.camera
    tables: dict[str, Any] = {
        "specimen": specimen_table(specimen),
        "fluid": fluid_table(declaration.fluid),
        "gravity": gravity_table(declaration.gravity),
    }
    if camera is not None:
        tables["camera"] = {
            "fps": camera.fps,
            "m_per_px": camera.metres_per_px,
            "base_px": list(camera.base_px),
            "arm_px": list(camera.arm_px),
            "exposure_s": camera.exposure,
            "mirrored": camera.mirrored,
        }
    tables["motor"] = {"mode": declaration.motor_mode}
    if declaration.release_t is not None:
        tables["release"] = {"t_s": declaration.release_t}
    if declaration.seen_from != "ground":
        tables["base"] = {"seen_from": declaration.seen_from}
    if declaration.out_of_plane is not None:
        tables["plane"] = {"out_of_plane_share": declaration.out_of_plane}
    _state_uncertain(tables, declaration.uncertain)
    return tables


def _state_uncertain(tables: dict[str, Any], uncertain: Sequence[Uncertain]) -> None:
    """Replace means by uncertain numbers in the given tables of recording.toml."""
    for number in uncertain:
        *path, key = number.field.split(".")
        if path[0] in tables:
            table = tables
            for name in path:
                table = table[name]
            table[key] = number.table()


def specimen_table(specimen: Specimen) -> dict[str, Any]:
    """[specimen] of recording.toml and model.toml."""
    section = specimen.section
    if isinstance(section, Cone):
        sizes = {"section": "cone", "base_radius_m": section.base_radius, "tip_radius_m": section.tip_radius}
    else:
        sizes = {"section": "rectangle", "width_m": section.section_width, "height_m": section.height}
    rounded = {} if specimen.tip_rounding is None else {"tip_rounding_m": specimen.tip_rounding}
    placed = (
        ("tip_mass_reach_m", specimen.tip_mass_reach, 0.0),
        ("tip_mass_drop_m", specimen.tip_mass_drop, 0.0),
        ("tip_mass_density_kg_m3", specimen.tip_mass_density, STEEL),
        ("clamp_length_m", specimen.clamp_length, 0.0),
        ("shear_compliance", specimen.shear_compliance, 0.0),
    )
    laws = {"laws": list(specimen.laws)} if specimen.laws else {}
    return {
        **sizes,
        "length_m": specimen.length,
        "density_kg_m3": specimen.density,
        "tip_mass_kg": specimen.tip_mass,
        "stiffness": specimen.stiffness,
        **rounded,
        **laws,
    } | {key: value for key, value, usual in placed if value != usual}


def fluid_table(fluid: Fluid) -> dict[str, Any]:
    """[fluid] of recording.toml and model.toml."""
    added = {} if fluid.added_mass == "none" else {"added_mass": fluid.added_mass}
    return {"density_kg_m3": fluid.density, **added}


def gravity_table(gravity: Gravity) -> dict[str, Any]:
    """[gravity] of recording.toml and model.toml."""
    magnitude = {} if gravity.magnitude == STANDARD_GRAVITY else {"magnitude_m_s2": gravity.magnitude}
    return {"angle_rad": gravity.angle, **magnitude}


def format_recording_file(recording_file: RecordingFile) -> str:
    """recording.toml as text; numbers keep every digit."""
    tables = declaration_tables(recording_file.declaration)
    if recording_file.markers:
        tables["markers"] = {name: {"s": s, "d": d} for name, (s, d) in recording_file.markers.items()}
    if recording_file.strain:
        tables["strain"] = strain_table(recording_file.strain)
    if recording_file.acceleration:
        tables["acceleration"] = acceleration_table(recording_file.acceleration)
    _state_uncertain(tables, recording_file.declaration.uncertain)
    if recording_file.notes:
        tables["notes"] = dict(recording_file.notes)
    head = {} if recording_file.name is None else {"name": recording_file.name}
    return tomli_w.dumps({**head, **tables})


def read_recording_file(file: Path) -> RecordingFile:
    """recording.toml from disk."""
    text, values = read_toml(file, "the declaration: [specimen], [fluid], [camera] (docs/import_folder.md)")
    return parse_recording_file(values, file=file, text=text)

"""Arms in the tank, in 3D: tubes with the section's radius, markers with lines to where a model puts them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import rerun as rr

from tentacle.recording import Declaration
from tentacle.signals import Array
from tentacle.specimen import Specimen
from viz.palette import MEASURED, NEUTRAL, Role
from viz.scene import Party, ViewedRun
from viz.topics.paths import seconds
from viz.tube import planar_to_space, tube

CORE = 0.3  # a model's arm is drawn this thick, in front of the measured one: both are seen where they agree


@dataclass(frozen=True)
class MidlineCourse:
    """A midline over time: t (T,) [s], s (P,), xy (T, P, 2) [m]."""

    t: Array
    s: Array
    xy: Array


def log_tube(
    session: rr.RecordingStream, path: str, role: Role, course: MidlineCourse, arm: Specimen, full: bool
) -> None:
    """An arm over time, in full thickness, or its core in front of it."""
    drawn = (
        tube(course.xy, course.s, arm)
        if full
        else tube(course.xy, course.s, arm, thickness=CORE, lift=float(arm.section.half_thickness(0.0)))
    )
    session.log(path, rr.LineStrips3D.from_fields(colors=[role.colour]), static=True)
    columns = rr.LineStrips3D.columns(strips=drawn.ends, radii=drawn.radius)
    session.send_columns(path, [seconds(course.t)], columns.partition(drawn.lengths))


def log_markers(session: rr.RecordingStream, path: str, role: Role, t: Array, xy: Array, radius: float) -> None:
    """Points over time: xy (T, M, 2) [m]; missing ones (NaN) are left out."""
    present = np.isfinite(xy).all(axis=-1)
    session.log(path, rr.Points3D.from_fields(colors=[role.colour], radii=[radius]), static=True)
    columns = rr.Points3D.columns(positions=planar_to_space(xy)[present])
    session.send_columns(path, [seconds(t)], columns.partition(present.sum(axis=1)))


def log_tank(session: rr.RecordingStream, path: str, declaration: Declaration) -> None:
    """What stands still: the servo at the clamp and, in a fluid, the outline of the water around the arm's reach."""
    arm = declaration.specimen
    reach = 1.25 * arm.length
    half = 2.0 * float(arm.section.half_thickness(0.0))
    session.log(
        f"{path}/servo",
        rr.Boxes3D(half_sizes=[[half, half, half]], centers=[[0.0, -half, 0.0]], colors=[NEUTRAL.colour]),
        static=True,
    )
    if declaration.fluid.density > 0:
        water = rr.Boxes3D(
            half_sizes=[[reach, 0.5 * (reach + 3 * half), 0.5 * reach]],
            centers=[[0.0, 0.5 * (reach - 3 * half), 0.0]],
            colors=[(*MEASURED.colour, 120)],
            labels=[f"water, {declaration.fluid.density:.0f} kg/m3 (outline drawn, not measured)"],
            show_labels=False,
        )
        session.log(f"{path}/water", water, static=True)


def log_misses(session: rr.RecordingStream, path: str, scene: ViewedRun, party: Party, radius: float) -> None:
    """Lines from each measured marker to where a model puts it."""
    misses = planar_to_space(np.stack([scene.subject.xy, party.xy], axis=2))
    present = np.isfinite(misses).all(axis=(2, 3))
    session.log(path, rr.LineStrips3D.from_fields(colors=[party.role.colour], radii=[radius]), static=True)
    columns = rr.LineStrips3D.columns(strips=misses[present])
    session.send_columns(path, [seconds(scene.t)], columns.partition(present.sum(axis=1)))


def log_arms(session: rr.RecordingStream, path: str, scene: ViewedRun, declaration: Declaration) -> None:
    """Every party's arm of a scene."""
    arm = declaration.specimen
    log_tank(session, f"{path}/arms", declaration)
    for party in scene.parties:
        where = f"{path}/arms/{party.key}"
        if scene.points == "midline":
            log_tube(
                session, where, party.role, MidlineCourse(scene.t, scene.s, party.xy), arm, full=party is scene.subject
            )
            continue
        log_markers(session, where, party.role, scene.t, party.xy, arm.length / 60)
        if party is not scene.subject:
            log_misses(session, f"{where}/miss", scene, party, arm.length / 300)

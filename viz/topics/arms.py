"""Arms in the tank, in 3D: tubes with the section's radius, markers with lines to where a model puts them, the drag."""

from __future__ import annotations

import numpy as np
import rerun as rr

from tentacle.diagnosis import RunComparison
from tentacle.recording import Declaration
from tentacle.signals import Array
from tentacle.specimen import Specimen
from viz.palette import AUGMENTED, BASE, MEASURED, NEUTRAL, REFERENCE, Role
from viz.topics.paths import seconds
from viz.tube import planar_to_space, thin, tube

CORE = 0.3  # a model's arm is drawn this thick, in front of the measured one: both are seen where they agree


def log_tube(session: rr.RecordingStream, path: str, role: Role, t: Array, s: Array, xy: Array, arm: Specimen) -> None:
    """An arm over time: midline xy (T, P, 2) [m] at s (P,); the measured one in full thickness, a model's as a core."""
    if role is MEASURED:
        drawn = tube(xy, s, arm)
    else:
        drawn = tube(xy, s, arm, thickness=CORE, lift=float(arm.section.half_thickness(0.0)))
    session.log(path, rr.LineStrips3D.from_fields(colors=[role.colour]), static=True)
    columns = rr.LineStrips3D.columns(strips=drawn.ends, radii=drawn.radius)
    session.send_columns(path, [seconds(t)], columns.partition(drawn.lengths))


def log_markers(session: rr.RecordingStream, path: str, role: Role, t: Array, xy: Array, radius: float) -> None:
    """Points over time: xy (T, M, 2) [m]; missing ones (NaN) are left out."""
    present = np.isfinite(xy).all(axis=-1)
    session.log(path, rr.Points3D.from_fields(colors=[role.colour], radii=[radius]), static=True)
    columns = rr.Points3D.columns(positions=planar_to_space(xy)[present])
    session.send_columns(path, [seconds(t)], columns.partition(present.sum(axis=1)))


def log_drag(session: rr.RecordingStream, path: str, t: Array, xy: Array, drag: Array, length: float) -> None:
    """The water's force per length, drag (T, P, 2) [N/m], as arrows; a run's largest is a third of the arm long."""
    keep = thin(xy.shape[1], 10)
    points, force = planar_to_space(xy[:, keep]), planar_to_space(drag[:, keep])
    largest = float(np.nanmax(np.linalg.norm(force, axis=-1), initial=0.0))
    scale = length / 3.0 / largest if largest > 0 else 0.0
    present = np.isfinite(points).all(axis=-1) & np.isfinite(force).all(axis=-1)
    session.log(path, rr.Arrows3D.from_fields(colors=[REFERENCE.colour], radii=[length / 250]), static=True)
    columns = rr.Arrows3D.columns(vectors=scale * force[present], origins=points[present])
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


def log_arms(session: rr.RecordingStream, path: str, run: RunComparison, declaration: Declaration) -> None:
    """Measured, base and augmented arms of a run, and the drag on the augmented one where it was computed."""
    arm = declaration.specimen
    log_tank(session, f"{path}/arms", declaration)
    parties = (("measured", MEASURED, run.measured), ("base", BASE, run.base), ("augmented", AUGMENTED, run.augmented))
    for name, role, xy in parties:
        if run.points == "midline":
            log_tube(session, f"{path}/arms/{name}", role, run.t, run.s, xy, arm)
        else:
            log_markers(session, f"{path}/arms/{name}", role, run.t, xy, arm.length / 60)
    if run.points == "markers":
        for name, role, xy in parties[1:]:
            misses = planar_to_space(np.stack([run.measured, xy], axis=2))
            present = np.isfinite(misses).all(axis=(2, 3))
            style = rr.LineStrips3D.from_fields(colors=[role.colour], radii=[arm.length / 300])
            session.log(f"{path}/arms/{name}/miss", style, static=True)
            columns = rr.LineStrips3D.columns(strips=misses[present])
            session.send_columns(f"{path}/arms/{name}/miss", [seconds(run.t)], columns.partition(present.sum(axis=1)))
    if run.drag is not None:
        log_drag(session, f"{path}/arms/drag", run.t, run.augmented, run.drag, arm.length)

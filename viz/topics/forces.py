"""Force arrows in 3D: the water's drag along each arm, and beside the servo what it adds up to, the thrust (eq. 17)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import rerun as rr

from tentacle.proposed_law import MissingForce
from tentacle.signals import Array
from tentacle.specimen import Specimen
from viz.palette import WARNING, Role
from viz.scene import Party, ViewedRun
from viz.topics.paths import run_path, seconds
from viz.tube import planar_to_space, thin

ARROWS = 12  # along an arm
LONGEST_ARROW = 0.5  # arm lengths: the longest arrow of a kind in a run
ARROW_LANE = 3.0  # half thicknesses at the clamp between two thrust arrows


def thrust_of(drag: Array, s: Array, length: float) -> Array:
    """The drag's sum along y (T,) [N], eq. 17 with L ds: int drag_y L ds by the trapezium rule."""
    return np.asarray(length * np.trapezoid(drag[..., 1], s, axis=1))


@dataclass(frozen=True)
class Arrows:
    """Arrows over time t (T,) [s]: origins, vectors (T, A, 2)."""

    t: Array
    origins: Array
    vectors: Array


def log_arrows(session: rr.RecordingStream, path: str, role: Role, arrows: Arrows, thickness: float) -> None:
    """Arrows over time, thickness [m as drawn]; missing (NaN) ones are left out."""
    present = np.isfinite(arrows.origins).all(axis=-1) & np.isfinite(arrows.vectors).all(axis=-1)
    session.log(path, rr.Arrows3D.from_fields(colors=[role.colour]), static=True)
    columns = rr.Arrows3D.columns(
        vectors=planar_to_space(arrows.vectors)[present],
        origins=planar_to_space(arrows.origins)[present],
        radii=np.full(int(present.sum()), thickness),
    )
    session.send_columns(path, [seconds(arrows.t)], columns.partition(present.sum(axis=1)))


def log_forces(session: rr.RecordingStream, path: str, scene: ViewedRun, arm: Specimen) -> str:
    """Arrows of every party whose drag is known, all on one scale; says what the longest are, or nothing."""
    known: list[tuple[Party, Array]] = [(party, party.drag) for party in scene.parties if party.drag is not None]
    if not known:
        return ""
    thrusts = [thrust_of(drag, scene.s, arm.length) for _, drag in known]
    strongest = max(float(np.nanmax(np.linalg.norm(drag, axis=-1), initial=0.0)) for _, drag in known)
    hardest = max(float(np.nanmax(np.abs(thrust), initial=0.0)) for thrust in thrusts)
    if strongest == 0.0 or hardest == 0.0:
        return ""
    keep = thin(len(scene.s), ARROWS)
    beside = ARROW_LANE * float(arm.section.half_thickness(0.0))
    for lane, ((party, drag), thrust) in enumerate(zip(known, thrusts, strict=True), start=1):
        arrows = LONGEST_ARROW * arm.length / strongest * drag[:, keep]
        where = party.xy[:, keep]
        log_arrows(
            session, f"{path}/arms/drag/{party.key}", party.role, Arrows(scene.t, where, arrows), arm.length / 200
        )
        start = np.broadcast_to([lane * beside, 0.0], (len(thrust), 1, 2))
        whole = LONGEST_ARROW * arm.length / hardest * np.stack([np.zeros_like(thrust), thrust], axis=-1)[:, None]
        log_arrows(
            session, f"{path}/arms/thrust/{party.key}", party.role, Arrows(scene.t, start, whole), arm.length / 80
        )
    return f"longest arrows: drag {strongest:.2g} N/m, thrust {1e3 * hardest:.2g} mN"


def log_missing_force(session: rr.RecordingStream, scene: ViewedRun, arm: Specimen, missing: MissingForce) -> None:
    """Arrows of the missing force on the measured arm, on a band of faint ones a standard deviation longer, and of that
    at the tip; where the run has a map of it.
    """
    for shown in missing.maps:
        if shown.name != scene.name or scene.points != "midline":
            continue
        seen = np.isfinite(np.interp(scene.t, shown.t, shown.tip_force))  # an interval beside a NaN is NaN
        frames = np.flatnonzero(seen & (scene.t >= shown.t[0]) & (scene.t <= shown.t[-1]))
        keep = thin(len(shown.s), ARROWS)
        measured = scene.parties[0].xy[frames]
        place = np.stack([_at(scene.s, measured[..., axis], shown.s[keep]) for axis in range(2)], axis=-1)
        slope = np.gradient(measured, scene.s, axis=1)
        tangent = np.stack([_at(scene.s, slope[..., axis], shown.s[keep]) for axis in range(2)], axis=-1)
        tangent /= np.maximum(np.linalg.norm(tangent, axis=-1, keepdims=True), 1e-12)
        normal = np.stack([tangent[..., 1], -tangent[..., 0]], axis=-1)
        size, spread = (_in_time(shown.t, part[:, keep], scene.t[frames]) for part in (shown.force, shown.spread))
        scale = LONGEST_ARROW * arm.length / max(float(np.nanmax(np.abs(shown.force))), 1e-300)
        path = f"{run_path(scene.name)}/arms/missing"
        thick = arm.length / 150
        band = np.abs(size) + spread
        wide = np.sign(size)[..., None] * band[..., None] * normal
        faint = Role(WARNING.name, (235, 190, 150), WARNING.dash)
        at_tip = np.interp(scene.t[frames], shown.t, shown.tip_force)[:, None, None] * normal[:, -1:]
        longest = LONGEST_ARROW * arm.length / max(float(np.nanmax(np.abs(shown.tip_force))), 1e-300)
        t = scene.t[frames]
        drawn = (
            ("band", faint, Arrows(t, place, scale * wide), thick / 2),
            ("force", WARNING, Arrows(t, place, scale * size[..., None] * normal), thick),
            ("tip", WARNING, Arrows(t, place[:, -1:], longest * at_tip), 2.0 * thick),
        )
        for part, role, arrows, thickness in drawn:
            log_arrows(session, f"{path}/{part}", role, arrows, thickness)


def _at(s: Array, values: Array, places: Array) -> Array:
    """Values (T, P) at s (P,) interpolated to other places (A,): (T, A)."""
    return np.array([np.interp(places, s, row) for row in values])


def _in_time(t: Array, values: Array, times: Array) -> Array:
    """Values (T, A) at t (T,) interpolated to other times (F,): (F, A)."""
    return np.array([np.interp(times, t, column) for column in values.T]).T

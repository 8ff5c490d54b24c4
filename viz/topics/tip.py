"""The tip, enlarged: each party's last part of the arm in a frame that moves with the subject's tip, in millimetres.

In the view of the tank a model with an error of 1 mm covers the measured arm. This view is only a little wider than the
distance of the tips.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from tentacle.signals import Array
from viz.palette import NEUTRAL
from viz.scene import ViewedRun
from viz.topics.paths import seconds

LEAST_MM = 1.0  # the view reaches this far from the tip at least
OF_DISTANCE = 1.3  # and this many times as far as the models' tips are from it, for all but 1 % of the run


def tip_reach(scene: ViewedRun) -> float:
    """How far the view reaches from the subject's tip [mm]; NaN where no model's tip is known."""
    found = [scene.residual_mm(party)[:, scene.tip] for party in scene.models]
    known = np.concatenate([distance[np.isfinite(distance)] for distance in found]) if found else np.empty(0)
    return max(OF_DISTANCE * float(np.percentile(known, 99)), LEAST_MM) if known.size else float("nan")


def cut_to(line: Array, half: float) -> Array:
    """A line's (P, 2) points from its last one back to the first outside a square of that half side; NaN left out."""
    line = line[np.isfinite(line).all(axis=1)]
    outside = np.flatnonzero(np.abs(line).max(axis=1) > half)
    return line[outside[-1] :] if len(outside) and outside[-1] < len(line) - 1 else line


def log_tip(session: rr.RecordingStream, path: str, scene: ViewedRun) -> float:
    """Every party's end about the subject's tip; returns how far the view reaches [mm], 0 where there is no model."""
    reach = tip_reach(scene)
    if not np.isfinite(reach):
        return 0.0
    order = np.argsort(scene.s, kind="stable")
    origin = scene.subject.xy[:, scene.tip, :][:, None, :]
    for party in scene.parties:
        where = f"{path}/tip/{party.key}"
        shifted = 1e3 * (party.xy - origin)[:, order]
        kept = np.isfinite(shifted[:, -1]).all(axis=1)
        strips = [cut_to(line, 3.0 * reach).astype(np.float32) for line in shifted]
        enough = kept & np.array([len(strip) > 1 for strip in strips])
        width = -3.0 if party is scene.subject else -1.25  # both are seen where they agree
        session.log(where, rr.LineStrips2D.from_fields(colors=[party.role.colour], radii=[width]), static=True)
        columns = rr.LineStrips2D.columns(strips=[s for s, good in zip(strips, enough, strict=True) if good])
        session.send_columns(where, [seconds(scene.t)], columns.partition(enough.astype(int)))
        ends = rr.Points2D.columns(positions=shifted[kept, -1].astype(np.float32))
        session.log(f"{where}/end", rr.Points2D.from_fields(colors=[party.role.colour], radii=[-4.0]), static=True)
        session.send_columns(f"{where}/end", [seconds(scene.t)], ends.partition(kept.astype(int)))
    length, low = 10.0 ** np.floor(np.log10(reach)), 0.85 * reach
    bar = rr.LineStrips2D([[[-length / 2, low], [length / 2, low]]], colors=[NEUTRAL.colour], radii=[-1.5])
    session.log(f"{path}/tip/scale", bar, static=True)
    words = rr.Points2D([[0.0, low]], labels=[f"{length:g} mm"], colors=[NEUTRAL.colour], radii=0.0, show_labels=True)
    session.log(f"{path}/tip/scale/words", words, static=True)
    return reach

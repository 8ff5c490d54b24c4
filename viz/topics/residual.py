"""The residual: over arc length and time as a picture with a moving time mark, its rms over time, and spectra."""

from __future__ import annotations

import warnings

import numpy as np
import rerun as rr

from tentacle.signals import Array
from viz.heat import colour_limit, heat_map
from viz.palette import NEUTRAL, WARNING
from viz.scene import Party, ViewedRun
from viz.topics.lines import log_line
from viz.topics.paths import seconds

MARK_STEPS = 400  # the time mark moves in this many steps over a run


def rms_over_points(values: Array) -> Array:
    """Root mean square (T,) over the points of values (T, P); NaN where an instant has none."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # an instant without any point: NaN is the answer
        return np.sqrt(np.nanmean(values**2, axis=1))


def log_heat(session: rr.RecordingStream, path: str, scene: ViewedRun, party: Party) -> None:
    """One model's residual map [mm] on the colour scale shared by all."""
    drawn = heat_map(scene, party, colour_limit(scene))
    height, width = drawn.picture.shape[:2]
    session.log(f"{path}/map", rr.Image(drawn.picture), static=True)
    labels = [f"dark 0, yellow {drawn.limit:.2g} mm", "base", "tip", f"{drawn.start:.1f} s", f"{drawn.stop:.1f} s"]
    # a label's size is the screen's: beside the map also where the view is narrow
    positions = [[width / 2, -100], [-90, 20], [-90, height - 40], [40, height + 30], [width - 40, height + 30]]
    points = rr.Points2D(positions, labels=labels, colors=[NEUTRAL.colour], radii=0.1, show_labels=True)
    session.log(f"{path}/axes", points, static=True)
    t = np.linspace(drawn.start, drawn.stop, MARK_STEPS)
    column = drawn.column(t)
    mark = np.stack([np.stack([column, np.zeros_like(t)], -1), np.stack([column, np.full_like(t, height)], -1)], axis=1)
    session.log(f"{path}/now", rr.LineStrips2D.from_fields(colors=[WARNING.colour], radii=[1.0]), static=True)
    session.send_columns(f"{path}/now", [seconds(t)], rr.LineStrips2D.columns(strips=mark.astype(np.float32)))


def log_residual(session: rr.RecordingStream, path: str, scene: ViewedRun) -> None:
    """Maps and rms [mm] of every model's residual."""
    for party in scene.models:
        log_heat(session, f"{path}/residual/{party.key}", scene, party)
        rms = rms_over_points(scene.residual_mm(party))
        log_line(session, f"{path}/error/{party.key}", party.role, scene.t, rms)


def log_spectra(session: rr.RecordingStream, path: str, scene: ViewedRun) -> None:
    """Amplitude spectra of the tip as a picture: the viewer's charts have no logarithmic and no frequency axis."""
    from viz.figures.spectrum import spectrum_figure
    from viz.figures.style import png

    picture = png(spectrum_figure(scene, height=3.4, width=5.0), dpi=150, ink="#dddddd", paper="#101010")
    session.log(f"{path}/spectrum", rr.EncodedImage(contents=picture, media_type="image/png"), static=True)

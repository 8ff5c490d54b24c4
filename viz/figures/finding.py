"""What a diagnosis found, as one picture: the arm at the worst moment, the models over it, before and after."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tentacle.recording import Camera, Recording
from tentacle.rounding import number
from tentacle.signals import Array
from viz.figures.style import house_style, new_figure
from viz.palette import NEUTRAL
from viz.scene import Party, ViewedRun
from viz.video import frames, upright

GreyImage = NDArray[np.uint8]
PICTURE_MARGIN = 0.12  # of the arm's length, around it
LEAST_WINDOW, OF_ERROR = 0.06, 2.6  # the inset's side: of the arm's length at least, and of the error
WIDEST_PICTURE = 520  # pixels of the film's frame that are kept
PAPER_GREY = 255


@dataclass(frozen=True)
class Still:
    """A frame of the film as the base frame sees it: grey picture, and its extent (left, right, bottom, top) [mm]."""

    picture: GreyImage
    extent: tuple[float, float, float, float]


def worst_instant(scene: ViewedRun) -> int | None:
    """The judged instant at which the first model misses most; None where nothing was measured."""
    if not scene.models:
        return None
    error = np.where(scene.judged, rms_at(scene, scene.models[0]), np.nan)
    return None if np.isnan(error).all() else int(np.nanargmax(error))


def rms_at(scene: ViewedRun, party: Party) -> Array:
    """Root mean square distance (T,) [mm] between a party and what was measured, at each instant."""
    residual = scene.residual_mm(party)
    seen = np.isfinite(residual)
    total = np.where(seen, residual, 0.0) ** 2
    count = seen.sum(axis=1)
    return np.sqrt(np.divide(total.sum(axis=1), count, out=np.full(len(count), np.nan), where=count > 0))


def still_of(recording: Recording | None, t: float, box: Array) -> Still | None:
    """The film's frame nearest to t, turned into the base frame's axes; None without a film.

    box (2, 2) [mm]: the least and the largest x and y that are to be seen.
    """
    if recording is None or recording.video is None or recording.declaration.camera is None:
        return None
    nearest, gap = None, np.inf
    for time, frame in frames(recording):
        if abs(time - t) > gap:
            break
        nearest, gap = frame, abs(time - t)
    if nearest is None:
        return None
    grey = np.asarray(upright(nearest).to_ndarray(format="gray"), dtype=np.uint8)
    return Still(in_base_frame(grey, recording.declaration.camera, box), (box[0, 0], box[1, 0], box[1, 1], box[0, 1]))


def in_base_frame(picture: GreyImage, camera: Camera, box: Array) -> GreyImage:
    """The picture sampled over a box [mm] of the base frame, rows along y, columns along x; pale, white outside."""
    side = (box[1] - box[0]) * 1e-3 / camera.metres_per_px
    across, down = (max(2, round(float(s * min(1.0, WIDEST_PICTURE / side.max())))) for s in side)
    x, y = np.linspace(box[0, 0], box[1, 0], across), np.linspace(box[0, 1], box[1, 1], down)
    at = camera.to_pixels(1e-3 * np.stack(np.meshgrid(x, y), axis=-1)).round().astype(int)
    inside = ((at >= 0) & (at < [picture.shape[1], picture.shape[0]])).all(axis=-1)
    at = np.clip(at, 0, [picture.shape[1] - 1, picture.shape[0] - 1])
    return np.where(inside, 110 + 145 * (picture[at[..., 1], at[..., 0]] / 255.0), PAPER_GREY).astype(np.uint8)


def finding_figure(scene: ViewedRun, recording: Recording | None) -> Figure | None:
    """A panel a model: film, measured shape, the model's shape, and the tip again, magnified. None without a shape."""
    instant = worst_instant(scene)
    if instant is None:
        return None
    shown = [party.xy[instant] for party in scene.parties]
    points = 1e3 * np.concatenate([*shown, np.zeros((1, 2))])
    size = float(np.nanmax(np.ptp(points[np.isfinite(points).all(axis=1)], axis=0)))
    box = np.stack([np.nanmin(points, axis=0), np.nanmax(points, axis=0)]) + PICTURE_MARGIN * size * np.array(
        [[-1.0], [1.0]]
    )
    narrow = max(0.0, 0.8 * (box[1, 1] - box[0, 1]) - (box[1, 0] - box[0, 0]))  # a hanging arm is shown with its water
    box += 0.5 * narrow * np.array([[-1.0, 0.0], [1.0, 0.0]])
    still = still_of(recording, float(scene.t[instant]), box)
    with house_style():
        shape = (box[1, 1] - box[0, 1]) / (box[1, 0] - box[0, 0])
        figure = new_figure(min(6.4, 2.4 + 3.4 * shape))
        count = len(scene.models)
        panels = figure.subplots(2, count, squeeze=False, height_ratios=(2.6, 1.0))
        window = max(OF_ERROR * float(np.nanmax(scene.residual_mm(scene.models[0])[instant])), LEAST_WINDOW * size)
        labelled: dict[str, Artist] = {}
        for (whole, tip), party in zip(panels.T, scene.models, strict=True):
            if still is not None:
                whole.imshow(still.picture, cmap="gray", vmin=0, vmax=255, extent=still.extent, interpolation="none")
            _lines(whole, scene, party, instant, 1.0)
            whole.set(xlim=box[:, 0], ylim=box[::-1, 1], aspect="equal", xlabel="x [mm]")
            whole.set_title(f"{party.role.name}: {number(float(rms_at(scene, party)[instant]))} mm off")
            if still is not None:
                tip.imshow(still.picture, cmap="gray", vmin=0, vmax=255, extent=still.extent, interpolation="none")
            _tip(whole, tip, scene, party, instant, window)
            labelled |= dict(zip(*reversed(whole.get_legend_handles_labels()), strict=True))
        panels[0, 0].set_ylabel("y along the straight arm [mm]")
        figure.legend(labelled.values(), labelled.keys(), loc="outside upper center", ncols=len(labelled))
        return figure


def _lines(axes: Axes, scene: ViewedRun, party: Party, instant: int, size: float) -> None:
    subject = scene.subject
    axes.plot(*(1e3 * subject.xy[instant].T), "o", ms=2.6 * size, color=subject.role.hex, label=subject.role.name)
    style = "-" if scene.points == "midline" else "x"
    axes.plot(*(1e3 * party.xy[instant].T), style, color=party.role.hex, lw=2.0 * size, ms=5, label=party.role.name)


def _tip(whole: Axes, axes: Axes, scene: ViewedRun, party: Party, instant: int, window: float) -> None:
    """The tip magnified below the whole arm, where a millimetre is seen."""
    tip = 1e3 * scene.subject.xy[instant, scene.tip]
    if not np.isfinite(tip).all():
        axes.set_axis_off()
        return
    _lines(axes, scene, party, instant, 1.6)
    half = np.array([0.5 * window, 0.2 * window])
    axes.set(xlim=(tip[0] - half[0], tip[0] + half[0]), ylim=(tip[1] + half[1], tip[1] - half[1]), aspect="equal")
    axes.set(xticks=[], yticks=[], title=f"its tip, {number(window)} mm across")
    for spine in axes.spines.values():
        spine.set_visible(True)
    whole.indicate_inset((*(tip - half), *(2.0 * half)), edgecolor=NEUTRAL.hex, alpha=1.0)

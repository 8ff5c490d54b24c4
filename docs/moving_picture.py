"""The README's moving picture: the film with the measured shape, the model as declared, and the model with what was
found, side by side; below them the residual of each.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from tentacle.recording import Recording
from tentacle.signals import Array
from viz.figures.finding import in_base_frame, rms_at
from viz.palette import MEASURED
from viz.scene import Party, ViewedRun
from viz.video import frames, upright

PANEL, STRIP = (360, 394), 70  # px
BOX = np.array([[-75.0, -12.0], [75.0, 152.0]])  # mm: what is shown of the base frame
EVERY, SECONDS = 2, 6.0  # of the film's frames; of the film's end, where the motion is fastest
INK, FAINT = (27, 27, 27), (120, 120, 120)


def moving_picture(scene: ViewedRun, recording: Recording, file: Path) -> Path:
    """Write an animated WebP of a run's end: frames that were fitted and frames that were held out."""
    camera = recording.declaration.camera
    assert camera is not None
    chosen = np.flatnonzero(scene.t > scene.t[-1] - SECONDS)[::EVERY]
    wanted = {round(float(scene.t[k]), 3): int(k) for k in chosen}
    pages = []
    for t, frame in frames(recording):
        nearest = min(wanted, key=lambda time: abs(time - t))
        if abs(nearest - t) > 0.5 / camera.fps:
            continue
        grey = np.asarray(upright(frame).to_ndarray(format="gray"), dtype=np.uint8)
        under = Image.fromarray(in_base_frame(grey, camera, BOX)).convert("RGB").resize(PANEL)
        pages.append(page(scene, under, wanted.pop(nearest), chosen))
        if not wanted:
            break
    step = round(1000 * EVERY / camera.fps)
    pages[0].save(file, save_all=True, append_images=pages[1:], duration=step, loop=0, quality=70, method=6)
    return file


def page(scene: ViewedRun, under: Image.Image, instant: int, chosen: Array) -> Image.Image:
    """One picture: a panel a model, and under each its error so far."""
    width, height = PANEL
    whole = Image.new("RGB", (2 * width + 12, height + STRIP + 26), "white")
    top = max(float(np.nanmax(rms_at(scene, scene.models[0])[chosen])), 1e-6)
    for place, (party, words) in enumerate(zip(scene.models, ("as declared", "with the current"), strict=True)):
        left = place * (width + 12)
        panel = under.copy()
        draw = ImageDraw.Draw(panel)
        line(draw, scene.subject, instant, 7)
        line(draw, party, instant, 3)
        whole.paste(panel, (left, 26))
        draw = ImageDraw.Draw(whole)
        error, at = rms_at(scene, party), left + 4.0
        for text, colour in (
            (words, party.role.colour), (" and ", INK), ("measured", MEASURED.colour),
            (f": {float(error[instant]):.2f} mm apart", INK),
        ):  # fmt: skip
            draw.text((at, 4), text, fill=colour, font=font(14))
            at += draw.textlength(text, font=font(14))
        shown = [k for k in chosen if k <= instant and np.isfinite(error[k])]
        x = [left + width * (k - chosen[0]) / (chosen[-1] - chosen[0]) for k in shown]
        y = [26 + height + STRIP - 4 - (STRIP - 10) * float(error[k]) / top for k in shown]
        draw.text((left + 4, 28 + height), f"apart, up to {top:.1f} mm", fill=FAINT, font=font(11))
        draw.line([(left, 22 + height + STRIP), (left + width, 22 + height + STRIP)], fill=FAINT)
        if len(shown) > 1:
            draw.line(list(zip(x, y, strict=True)), fill=party.role.colour, width=3)
    return whole


def line(draw: ImageDraw.ImageDraw, party: Party, instant: int, width: int) -> None:
    """A party's shape in the panel's pixels."""
    points = (1e3 * party.xy[instant] - BOX[0]) / (BOX[1] - BOX[0]) * np.array(PANEL)
    seen = [(float(u), float(v)) for u, v in points if np.isfinite(u)]
    colour = MEASURED.colour if party.role is MEASURED else party.role.colour
    if len(seen) < 2:  # a picture that was not trusted
        return
    draw.line(seen, fill=colour, width=width, joint="curve")


def font(size: int) -> ImageFont.FreeTypeFont:
    """The letters that matplotlib brings along: the same on every machine."""
    from matplotlib import font_manager

    return ImageFont.truetype(font_manager.findfont("DejaVu Sans"), size)

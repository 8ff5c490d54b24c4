"""Tracking of the outside program's films: accepted, wrongly accepted, and errors against the film's own limit.

_outside_limit has a film's limit. What is declared is what a user reads off a picture: a base that is 2 px off, and no
rounding of the tip.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _outside_films import Drawn, draw_film
from _outside_limit import limit, sideways
from _outside_motion import REST, STEPS, Film

from tentacle.errors import InputError
from tentacle.recording import Camera, Declaration
from tentacle.signals import Array, MotorSignal, ShapeTrack
from tentacle.specimen import Cone, Specimen
from vision.encode import write_video
from vision.track import Tracking, track_fully

METRES_PER_PX = 1e-3
WRONG = 2.0  # px that an accepted midline may be off
SIGMAS = 4.0  # of its own stated error, where that is larger
DECLARED_OFF = (1.5, -1.0)  # px: a base that was read off the picture by hand


@dataclass(frozen=True)
class Judged:
    """One film: visible frames that are not repeats, those accepted; all accepted, and of them the wrong ones.

    rms_px, limit_px: of the midline's sideways error. z_rms: error over stated sigma. hidden, hidden_accepted,
    hidden_z: frames of which a part is covered, those accepted, and the z-rms there. words: why others were refused.
    """

    film: str
    visible: int
    seen: int
    accepted: int
    wrong: int
    rms_px: float
    limit_px: float
    z_rms: float
    hidden: int
    hidden_accepted: int
    hidden_z: float
    words: str


def declared(film: Film, base: Array) -> Declaration:
    """The arm's numbers as a user states them."""
    u, v = base + DECLARED_OFF
    heading = REST[film.side]
    camera = Camera(60.0, METRES_PER_PX, (float(u), float(v)), (float(np.cos(heading)), float(np.sin(heading))))
    radii = [0.5 * width * METRES_PER_PX for width in film.widths]
    return Declaration(Specimen(Cone(*radii), film.length * METRES_PER_PX, density=1000.0), camera=camera)


def track_drawn(drawn: Drawn) -> tuple[Tracking, Declaration, Array]:
    """The film tracked, what was declared of it, and the servo's angle (T,) that was given."""
    film = drawn.painter.film
    declaration = declared(film, drawn.painter.base)
    motor = MotorSignal(drawn.t, drawn.theta, drawn.theta) if film.servo else None
    with tempfile.TemporaryDirectory() as folder:
        video = Path(folder) / "film.mp4"
        write_video(video, drawn.pictures, drawn.t)
        tracked = track_fully(video, declaration, motor)
    return tracked, declaration, drawn.theta if film.servo else np.zeros(len(drawn.t))


def seen_midlines(shape: ShapeTrack, declaration: Declaration, theta: Array) -> tuple[Array, Array]:
    """Midlines (T, STEPS + 1, 2) [px] that a track states, and the sigma (T, STEPS + 1) [px] sideways of each point."""
    camera = declaration.camera
    assert camera is not None
    count = shape.coefficients.shape[1]
    middle = (np.arange(STEPS) + 0.5) / STEPS
    powers = np.array([np.ones(STEPS), *(middle**k / k for k in range(1, count))])
    heading = np.arctan2(camera.arm_px[1], camera.arm_px[0]) + theta[:, None] + shape.coefficients @ powers
    step = declaration.specimen.length / camera.metres_per_px * shape.scale / STEPS
    walk = step * np.stack([np.cos(heading), np.sin(heading)], axis=2)
    lines = camera.to_pixels(shape.base_shift) + np.concatenate(
        [np.zeros((len(theta), 1, 2)), walk.cumsum(axis=1)], axis=1
    )
    turned = step * np.stack([-np.sin(heading), np.cos(heading)], axis=2)
    moved = np.cumsum(turned[:, :, None] * powers.T[None, :, :, None], axis=1)  # (T, STEPS, K, 2)
    across = np.einsum("tskx,tsx->tsk", moved, turned / step)
    sigma = np.sqrt(np.maximum(np.einsum("tsi,tij,tsj->ts", across, shape.covariance, across), 0.0))
    return lines, np.concatenate([np.zeros((len(theta), 1)), sigma], axis=1)


def judge_film(film: Film, seed: int = 1) -> Judged:
    """Draw, track, compare; a film that is refused as a whole counts as none accepted."""
    drawn = draw_film(film, seed)
    visible = drawn.fresh & (drawn.covered == 0.0)
    hidden = drawn.fresh & ~visible
    try:
        tracked, declaration, theta = track_drawn(drawn)
    except InputError as error:
        return Judged(
            film.name, int(visible.sum()), 0, 0, 0, np.nan, np.nan, np.nan, int(hidden.sum()), 0, np.nan, error.line()
        )
    shape = tracked.shape
    index = np.searchsorted(drawn.t, shape.t - 1e-3)
    lines, sigma = seen_midlines(shape, declaration, theta[index])
    off = sideways(lines, drawn.midlines[index])
    kept = shape.accepted
    allowed = np.maximum(WRONG, SIGMAS * sigma)
    wrong = kept & (np.abs(off) > allowed).any(axis=1)
    plain, part = kept & visible[index], kept & hidden[index]
    least = limit(drawn, np.flatnonzero(visible if visible.any() else hidden), int(drawn.fresh.sum()))
    stated = np.sqrt(np.maximum(sigma[:, 20:], 1e-6) ** 2)
    z = np.sqrt(np.mean((off[:, 20:] / stated) ** 2, axis=1))
    reasons = [reason for reason in shape.reason if reason]
    return Judged(
        film.name, int(visible.sum()), int(plain.sum()), int(kept.sum()), int(wrong.sum()),
        _rms(off[plain if plain.any() else part]), least, _rms(z[plain]),
        int(hidden.sum()), int(part.sum()), _rms(z[part]),
        "; ".join(f"{reasons.count(reason)} {reason}" for reason in sorted(set(reasons))),
    )  # fmt: skip


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else np.nan

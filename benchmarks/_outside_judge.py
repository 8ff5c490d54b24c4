"""Tracking of the outside program's films: accepted, wrongly accepted, and errors against the film's own limit.

The limit is Cramer and Rao's of the delivered pictures, I_ij = sum over waves k of conj(G_i) G_j / S: G is the spectrum
of a slope (a central difference of the painted pictures), S that of the noise which camera, coding and a dirty ground
leave about the arm. Codecs and dirt err alike in neighbouring pixels, so S is not that of white noise. Base, angle
offset and length are constants that the film's frames must tell.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from _outside_films import Drawn, draw_film
from _outside_motion import REST, STEPS, Film
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.recording import Camera, Declaration
from tentacle.signals import Array, MotorSignal, ShapeTrack
from tentacle.specimen import Cone, Specimen
from vision.encode import write_video
from vision.track import Tracking, track_fully

METRES_PER_PX = 1e-3
WRONG = 2.0  # px that an accepted midline may be off
SIGMAS = 4.0  # of its own stated error, where that is larger
VISIBLE = 0.03  # share of the midline that may be hidden
DECLARED_OFF = (1.5, -1.0)  # px: a base that was read off the picture by hand
BEND_STEP, TURN_STEP, SHIFT_STEP, LENGTH_STEP = 4e-3, 4e-3, 0.15, 2e-3
POLYNOMIAL, WAVE = 3, 5  # free coordinates of the limit: those of the motion; a wave is not known to be one
CODED, DIRTY = 8, 40  # px: farther apart, pixels err independently (a codec's block; dirt of 10 px and less)
ROUNDING = 1.0 / 12.0  # variance of a rounded grey


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


def sideways(lines: Array, true: Array) -> Array:
    """How far (T, STEPS + 1) [px] each point lies from the true one, across the true line."""
    along = np.gradient(true, axis=1)
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    off = lines - true
    return off[:, :, 1] * along[:, :, 0] - off[:, :, 0] * along[:, :, 1]


def limit(drawn: Drawn, order: int, frames: NDArray[np.intp], count: int) -> float:
    """Rms over the midline of the least sideways standard deviation [px] that count such frames allow."""
    painter = drawn.painter
    middle = (np.arange(STEPS) + 0.5) / STEPS
    changes: list[tuple[dict[str, Any], float]] = []
    for k in range(1, order + 1):
        changes += [({"turn": sign * BEND_STEP * middle**k / k}, BEND_STEP) for sign in (1, -1)]
    for name, step in (("turn", TURN_STEP), ("longer", LENGTH_STEP)):
        changes += [({name: step}, step), ({name: -step}, step)]
    for axis in np.eye(2):
        changes += [({"shift": SHIFT_STEP * axis}, SHIFT_STEP), ({"shift": -SHIFT_STEP * axis}, SHIFT_STEP)]
    steps = np.array([step for _, step in changes])[::2]
    shown = {k: int(np.flatnonzero(np.all(drawn.midlines == painter.line(k), axis=(1, 2)))[0]) for k in frames.tolist()}
    rates, left, slopes = [], [], []
    for k, at in shown.items():
        lines = [painter.line(k, **change) for change, _ in changes]
        pictures = np.array([painter.paint(k, line)[0] for line in lines])
        rate = (pictures[::2] - pictures[1::2]) / (2.0 * steps[:, None, None])
        near = np.abs(rate).sum(axis=0) > 0.02 * np.abs(rate).sum(axis=0).max()
        rates.append(rate)
        left.append(np.where(near, drawn.pictures[at] - drawn.plain[at], np.nan))
        moved = np.array([sideways(line[None], painter.line(k)[None])[0] for line in lines])
        slopes.append((moved[::2] - moved[1::2]) / (2.0 * steps[:, None]))
    noise = (
        noise_spectrum(left, CODED) + noise_spectrum([painter.dirt], DIRTY) + ROUNDING
    )  # a dirty ground is not known to anybody
    information = [_information(rate, noise) for rate in rates]
    shared = np.zeros((4, 4))
    for info in information:
        shared += info[order:, order:] - info[order:, :order] @ np.linalg.solve(
            info[:order, :order], info[:order, order:]
        )
    common = np.linalg.inv(shared * count / len(information))
    variances = []
    for info, slope in zip(information, slopes, strict=True):
        own = np.linalg.inv(info[:order, :order])
        dx_dg = -own @ info[:order, order:]
        covariance = np.block([[own + dx_dg @ common @ dx_dg.T, dx_dg @ common], [common @ dx_dg.T, common]])
        variances.append(np.mean(np.einsum("is,ij,js->s", slope, covariance, slope)))
    return float(np.sqrt(np.mean(variances)))


def noise_spectrum(pictures: list[Array], alike: int) -> Array:
    """Power (H, W) of stationary noise from pictures (H, W) that show it, NaN where they do not.

    White noise of variance v has the power v everywhere. The covariance at each distance is averaged over the pairs of
    pixels that show it and tapered to zero at alike px (Bartlett's window, which keeps powers positive).
    """
    height, width = pictures[0].shape
    product, pairs = np.zeros((height, width)), np.zeros((height, width))
    for picture in pictures:
        there = np.isfinite(picture)
        seen = np.fft.fft2(np.where(there, picture, 0.0))
        product += np.fft.ifft2(np.abs(seen) ** 2).real
        pairs += np.fft.ifft2(np.abs(np.fft.fft2(there.astype(float))) ** 2).real
    apart = [np.abs(np.fft.fftfreq(size, 1.0 / size)) for size in (height, width)]
    taper = np.multiply.outer(*(np.clip(1.0 - far / alike, 0.0, None) for far in apart))
    return np.maximum(np.fft.fft2(taper * product / np.maximum(pairs, 1.0)).real, 0.0)


def _information(rate: Array, noise: Array) -> Array:
    """Fisher information (P, P) of slopes (P, H, W) in noise of that power (H, W)."""
    waves = np.fft.fft2(rate) / np.sqrt(noise * noise.size)
    return np.asarray(np.einsum("ixy,jxy->ij", waves.conj(), waves).real, dtype=float)


def judge_film(film: Film, seed: int = 1) -> Judged:
    """Draw, track, compare; a film that is refused as a whole counts as none accepted."""
    drawn = draw_film(film, seed)
    visible = drawn.fresh & (drawn.covered < VISIBLE)
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
    some = np.flatnonzero(visible)[:: max(visible.sum() // 3, 1)] if visible.any() else np.flatnonzero(hidden)[::20]
    own = np.unique(np.cumsum(drawn.fresh)[some] - 1)
    least = limit(drawn, WAVE if film.wave else POLYNOMIAL, own, int(drawn.fresh.sum()))
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

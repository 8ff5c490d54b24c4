"""The least sideways error of an outside film's midlines, by the errors that its delivered pictures really have.

Cramer and Rao's bound holds for the noise that one assumes. A codec's errors are not stationary: they gather where the
arm moves and where it is faint. So the covariance is that of Huber (1967) and White (1982), J^-1 K J^-1: J = G' W G of
the slopes G (central differences of painted pictures) and weights W, and K the covariance of the scores G' W r of the
errors r, delivered minus clean picture. If r has the spectrum S and W = 1 / S, then K = J and this is Cramer and Rao's
bound. W = 1 / S and W = 1 are tried, and the better one is the limit: the error of an estimate that begins at the truth
and knows the arm's look, its light and the noise.

Base and length are constants of the film, and so is the base's angle if the servo's log is given. Codecs and dirt err
alike in pictures that follow each other, so K of these has the covariances between pictures too (Newey and West 1987).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from _outside_films import Drawn, Painter
from _outside_motion import STEPS
from numpy.typing import NDArray

from tentacle.signals import Array

BEND_STEP, TURN_STEP, SHIFT_STEP, LENGTH_STEP = 4e-3, 4e-3, 0.15, 2e-3
POLYNOMIAL, WAVE = 3, 5  # free coordinates of the limit: those of the motion; a wave is not known to be one
CODED, DIRTY = 8, 40  # px: farther apart, pixels err independently (a codec's block; dirt of 10 px and less)
ROUNDING = 1.0 / 12.0  # variance of a rounded grey
NEAR = 0.02  # of the largest slope: pixels that show where the arm is
STRETCHES, LONG = 3, 6  # stretches of a film, of so many pictures, from which its errors are known
LAGS = 3  # 4 (T / 100)^(2 / 9), of 60 pictures


@dataclass(frozen=True)
class _Look:
    """One picture: slopes (P, H, W), the pixels that show them (H, W), errors (H, W) [grey], slopes (P, STEPS + 1) [px]
    of the midline, sideways.
    """

    rate: Array
    near: NDArray[np.bool_]
    error: Array
    slope: Array


def limit(drawn: Drawn, pictures: NDArray[np.intp], count: int) -> float:
    """Rms over the midline of the least sideways standard deviation [px] in those pictures of a film of count."""
    film, painter = drawn.painter.film, drawn.painter
    order = WAVE if film.wave else POLYNOMIAL
    own = order if film.servo else order + 1  # without a log each frame has its own base angle
    clean = Painter(replace(film, texture=0.0), painter.seed)
    long = min(LONG, len(pictures))
    begins = np.unique(np.linspace(0, len(pictures) - long, STRETCHES).astype(int))
    stretches = [[_look(drawn, clean, at, order) for at in pictures[b : b + long].tolist()] for b in begins]
    looks = [look for stretch in stretches for look in stretch]
    coded = [np.where(look.near, look.error - painter.dirt, np.nan) for look in looks]
    spectrum = noise_spectrum(coded, CODED) + noise_spectrum([painter.dirt], DIRTY) + ROUNDING
    return min(_rms_error(stretches, weight, own, count) for weight in (1.0 / spectrum, np.ones_like(spectrum)))


def sideways(lines: Array, true: Array) -> Array:
    """How far (T, STEPS + 1) [px] each point lies from the true one, across the true line."""
    along = np.gradient(true, axis=1)
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    off = lines - true
    return off[:, :, 1] * along[:, :, 0] - off[:, :, 0] * along[:, :, 1]


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


def _look(drawn: Drawn, clean: Painter, at: int, order: int) -> _Look:
    k = int(np.cumsum(drawn.fresh)[at] - 1)
    middle = (np.arange(STEPS) + 0.5) / STEPS
    changes: list[tuple[str, Any]] = [("turn", BEND_STEP * middle**n / n) for n in range(1, order + 1)]
    changes += [("turn", TURN_STEP), ("longer", LENGTH_STEP), *(("shift", SHIFT_STEP * axis) for axis in np.eye(2))]
    steps = np.array([*[BEND_STEP] * order, TURN_STEP, LENGTH_STEP, SHIFT_STEP, SHIFT_STEP])
    true = clean.line(k)
    pairs = [[clean.line(k, **{name: sign * change}) for sign in (1.0, -1.0)] for name, change in changes]
    painted = np.array([[clean.paint(k, line)[0] for line in pair] for pair in pairs])
    moved = np.array([[sideways(line[None], true[None])[0] for line in pair] for pair in pairs])
    rate = (painted[:, 0] - painted[:, 1]) / (2.0 * steps[:, None, None])
    size = np.abs(rate).sum(axis=0)
    error = drawn.pictures[at] - clean.paint(k, true)[0]
    return _Look(rate, size > NEAR * size.max(), error, (moved[:, 0] - moved[:, 1]) / (2.0 * steps[:, None]))


def _rms_error(stretches: list[list[_Look]], weight: Array, own: int, count: int) -> float:
    """The limit with one weight (H, W) of the waves; a frame's first own parameters are its own.

    With H = J_oo of the own parameters o and c those in common, a frame's own error is H^-1 u_o where c is known; c has
    the efficient score v = u_c - J_co H^-1 u_o and moves o by -H^-1 J_oc.
    """
    variances, leans, scores = [], [], []
    information = np.zeros((0, 0))
    for stretch in stretches:
        told = [_information(look, weight) for look in stretch]
        efficient = []
        for look, (normal, score) in zip(stretch, told, strict=True):
            gain = np.linalg.solve(normal[:own, :own], normal[:own, own:])
            variances.append(np.mean((np.linalg.solve(normal[:own, :own], score[:own]) @ look.slope[:own]) ** 2))
            leans.append(look.slope[own:] - gain.T @ look.slope[:own])
            efficient.append(score[own:] - gain.T @ score[:own])
            part = normal[own:, own:] - normal[own:, :own] @ gain
            information = part if not information.size else information + part
        scores.append(np.array(efficient))
    mean = np.linalg.inv(information / len(leans))
    common = mean @ _long_run(scores) @ mean / count
    shared = np.mean([np.mean(np.einsum("is,ij,js->s", lean, common, lean)) for lean in leans])
    return float(np.sqrt(np.mean(variances) + shared))


def _long_run(scores: list[Array]) -> Array:
    """Covariance (C, C) of a mean of many scores, times their number: by lag, with Bartlett's weights."""
    total = np.sum([score.T @ score for score in scores], axis=0) / sum(len(score) for score in scores)
    for lag in range(1, LAGS + 1):
        apart = [(score[lag:], score[:-lag]) for score in scores if len(score) > lag]
        if apart:
            product = np.sum([late.T @ early for late, early in apart], axis=0) / sum(len(late) for late, _ in apart)
            total = total + (1.0 - lag / (LAGS + 1.0)) * (product + product.T)
    return np.asarray(total, dtype=float)


def _information(look: _Look, weight: Array) -> tuple[Array, Array]:
    """J (P, P) and the score (P,) of one picture."""
    waves = np.fft.fft2(look.rate)
    weighted = waves.conj() * (weight / weight.size)
    normal = np.einsum("ixy,jxy->ij", weighted, waves).real
    return normal, np.einsum("ixy,xy->i", weighted, np.fft.fft2(look.error)).real

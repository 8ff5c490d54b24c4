"""The Cramer-Rao limit of a rendered picture: every pixel's information on the shape, smear, light and JPEG included.

Light, reflection, bubbles and radius are known. Base, base angle offset and length are known too, or are constants that
the frames must show. A bubble hides what lies behind it. JPEG rounds each block's cosine coefficients; a normal
coefficient rounded to steps has the information sum (dP)^2 / P over the steps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.fft import dctn
from scipy.special import ndtr

from tentacle.signals import Array
from vision.looks import Look
from vision.render import Renderer, RenderSettings
from vision.scene import Scene, exact_midline

DIFFERENCE_STEP = 2e-3  # rad, of the central differences
COMMON = {"offset": 1e-3, "u": 0.2, "v": 0.2, "length": 1e-3}  # steps: rad, px, px, relative
BLOCK_PIXELS = 8  # px
LUMA = np.array(  # ITU-T T.81, Table K.1: JPEG's steps at quality 50
    [
        [16, 11, 10, 16, 24, 40, 51, 61],
        [12, 12, 14, 19, 26, 58, 60, 55],
        [14, 13, 16, 24, 40, 57, 69, 56],
        [14, 17, 22, 29, 51, 87, 80, 62],
        [18, 22, 37, 56, 68, 109, 103, 77],
        [24, 35, 55, 64, 81, 104, 113, 92],
        [49, 64, 78, 87, 103, 121, 120, 101],
        [72, 92, 95, 98, 112, 100, 103, 99],
    ]
)


def picture_information(scene: Scene, look: Look, seed: int, order: int, frames: range) -> Array:
    """Fisher information (F, order + 4, order + 4) of each frame on its q and on the recording's offset, base and
    length.

    Per rad, px, px and relative length; by central differences of the mean pictures.
    """
    q = np.zeros((len(scene.t), order))
    q[:, : min(order, scene.q.shape[1])] = scene.q[:, :order]
    changes: list[tuple[Array, dict[str, float]]] = [(DIFFERENCE_STEP * row, {}) for row in np.eye(order)]
    changes += [(np.zeros(order), {name: step}) for name, step in COMMON.items()]
    steps = np.array([DIFFERENCE_STEP] * order + list(COMMON.values()))
    pairs = []
    for dq, common in changes:
        back = {name: -step for name, step in common.items()}
        pairs.append((_renderer(scene, q + dq, look, seed, common), _renderer(scene, q - dq, look, seed, back)))
    still = _renderer(scene, q, look, seed, {})
    information = []
    for frame in frames:
        time = float(scene.t[frame])
        slopes = [still.mean(time, up.coverage(time)) - still.mean(time, down.coverage(time)) for up, down in pairs]
        slopes = np.array(slopes) / (2.0 * steps[:, None, None])
        information.append(_information(still.mean(time), slopes, look))
    return np.array(information)


def pose_known_limit(information: Array, order: int) -> Array:
    """Root mean square (order,) over the frames of the least standard deviations of q [rad], if all else is known."""
    variance = np.linalg.inv(information[:, :order, :order])
    return np.sqrt(np.mean(np.diagonal(variance, axis1=1, axis2=2), axis=0))


def recording_limit(information: Array, order: int, count: int) -> Array:
    """As pose_known_limit, but offset, base and length are unknown constants of the recording's `count` frames.

    The constants' information is the sum over the frames of each frame's information with q free (Schur complement);
    the given frames represent all `count`. Their covariance G acts on q through L = -A^-1 B, so that the variance of q
    is A^-1 + L G L'.
    """
    within, across = information[:, :order, :order], information[:, :order, order:]
    covariance = np.linalg.inv(within)
    dx_dg = -covariance @ across
    told = information[:, order:, order:] + np.swapaxes(across, 1, 2) @ dx_dg
    constants = np.linalg.inv(count * told.mean(axis=0))
    variance = covariance + dx_dg @ constants @ np.swapaxes(dx_dg, 1, 2)
    return np.sqrt(np.mean(np.diagonal(variance, axis1=1, axis2=2), axis=0))


def _renderer(scene: Scene, q: Array, look: Look, seed: int, changes: Mapping[str, float]) -> Renderer:
    """The scene drawn with shapes q and small changes: offset [rad] of the base angle, u and v [px] of the base, length
    (relative)."""
    offset, u, v, length = (changes.get(name, 0.0) for name in ("offset", "u", "v", "length"))
    base = (scene.camera.base_px[0] + u, scene.camera.base_px[1] + v)
    camera = replace(scene.camera, base_px=base)
    midline = exact_midline(scene.t, scene.theta + scene.offset + offset, q, scene.specimen.length * (1.0 + length))
    return Renderer(midline, scene.specimen, camera, RenderSettings(scene.size, look, seed), scene.theta)


def _information(mean: Array, slopes: Array, look: Look) -> Array:
    """Fisher information (order, order) from slopes (order, H, W) of the mean picture (H, W)."""
    variance = look.noise**2 + 1.0 / 12.0  # rounding to whole greys
    if not look.jpeg_quality:
        return np.einsum("iab,jab->ij", slopes, slopes) / variance
    spread = np.sqrt(variance)
    steps, centre, turned = jpeg_steps(look.jpeg_quality), _blocks(mean - 128.0), np.array([_blocks(s) for s in slopes])
    told = np.any(np.abs(turned) > 1e-6, axis=0)
    centre, step = centre[told], np.broadcast_to(steps, told.shape)[told]
    information = np.zeros(len(centre))
    nearest, reach = np.rint(centre / step), int(np.ceil(6.0 * spread / steps.min())) + 1
    for k in range(-reach, reach + 1):
        low = ((nearest + k - 0.5) * step - centre) / spread
        high = low + step / spread
        share = ndtr(high) - ndtr(low)
        change = (np.exp(-0.5 * low**2) - np.exp(-0.5 * high**2)) / (np.sqrt(2.0 * np.pi) * spread)
        information += np.where(share > 1e-14, change**2 / np.maximum(share, 1e-14), 0.0)
    return np.einsum("in,n,jn->ij", turned[:, told], information, turned[:, told])


def jpeg_steps(quality: int) -> Array:
    """Rounding steps (8, 8) of the cosine coefficients, as libjpeg scales Table K.1 by quality 1 to 100."""
    scale = 5000 // quality if quality < 50 else 200 - 2 * quality
    return np.clip((LUMA * scale + 50) // 100, 1, 255).astype(float)


def _blocks(picture: Array) -> Array:
    """Orthonormal cosine coefficients of 8 x 8 blocks; incomplete blocks at the picture's edge are left out."""
    height, width = (size // BLOCK_PIXELS for size in picture.shape)
    whole = picture[: height * BLOCK_PIXELS, : width * BLOCK_PIXELS].reshape(height, BLOCK_PIXELS, width, BLOCK_PIXELS)
    return np.asarray(dctn(whole, axes=(1, 3), norm="ortho")).transpose(0, 2, 1, 3)

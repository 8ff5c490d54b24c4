"""The Cramer-Rao limit of a rendered picture: every pixel's information on the shape, smear, light and JPEG included.

What is known to it: base, base angle, light, bubbles. A bubble hides what lies behind it. JPEG rounds each block's
cosine coefficients; a normal coefficient that is seen rounded to steps tells sum (dP)^2 / P over the steps.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.fft import dctn
from scipy.special import ndtr

from tentacle.signals import Array
from vision.looks import Look
from vision.render import Renderer
from vision.scene import Scene, exact_midline

STEP = 2e-3  # rad, of the central differences
BLOCK = 8  # px
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


def picture_limit(scene: Scene, look: Look, seed: int, order: int, frames: range) -> Array:
    """Root mean square (order,) of the least standard deviations of q [rad] over some frames of a scene."""
    q = np.zeros((len(scene.t), order))
    q[:, : min(order, scene.q.shape[1])] = scene.q[:, :order]
    changed = [(j, sign) for j in range(order) for sign in (1.0, -1.0)]
    renderers = {(j, sign): _renderer(scene, q + sign * STEP * np.eye(order)[j], look, seed) for j, sign in changed}
    still = _renderer(scene, q, look, seed)
    variances = []
    for frame in frames:
        time = float(scene.t[frame])
        mean = still.mean(time)
        pictures = {key: still.mean(time, renderer.coverage(time)) for key, renderer in renderers.items()}
        slopes = [(pictures[j, 1.0] - pictures[j, -1.0]) / (2.0 * STEP) for j in range(order)]
        variances.append(np.diag(np.linalg.inv(_information(mean, np.array(slopes), look))))
    return np.sqrt(np.mean(variances, axis=0))


def _renderer(scene: Scene, q: Array, look: Look, seed: int) -> Renderer:
    midline = exact_midline(scene.t, scene.theta + scene.offset, q, scene.specimen.length)
    return Renderer(midline, scene.specimen, scene.camera, scene.size, replace(look), seed, scene.theta)


def _information(mean: Array, slopes: Array, look: Look) -> Array:
    """Fisher information (order, order) from slopes (order, H, W) of the mean picture (H, W)."""
    variance = look.noise**2 + 1.0 / 12.0  # the rounding to whole greys
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
    """Orthonormal cosine coefficients of 8 x 8 blocks; what does not fill a block at the picture's edge is left out."""
    height, width = (size // BLOCK for size in picture.shape)
    whole = picture[: height * BLOCK, : width * BLOCK].reshape(height, BLOCK, width, BLOCK)
    return np.asarray(dctn(whole, axes=(1, 3), norm="ortho")).transpose(0, 2, 1, 3)

"""The measurement of a blind trial: points of the midline, markers, a track or a video, and its noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from affine_model.curvature import Array, legendre_to_monomial
from inference.measured_shapes import information_root
from tentacle.signals import ShapeTrack

MeasurementKind = Literal["midline", "video", "track", "markers"]
EVERYWHERE = tuple(np.linspace(0.0, 1.0, 41).tolist())


@dataclass(frozen=True)
class Measurement:
    """The kind of measurement and its noise.

    kind: points of the midline; a video that is rendered and tracked; a track, with the noise that it states but
    without a video; or markers. noise [m] of each coordinate of a point; of a video or a track: the noise of points (s)
    with the same information. stated [m]: the noise that a midline states (None: it states none). s (P,) where
    points or markers are, d (M,) [m] along the normal, of markers. angle_noise [rad] of the servo's log.

    Of a track: covariance (K, K) of [base angle offset, q1 .. q_(K-1)] as it states it, gain (K,) of the true noise
    over that in its whitened channels, scale_sigma of its scale (NaN is None).
    """

    kind: MeasurementKind
    noise: float
    stated: float | None = None
    s: tuple[float, ...] = EVERYWHERE
    d: tuple[float, ...] = ()
    angle_noise: float = 0.0
    covariance: tuple[tuple[float, ...], ...] = ()
    gain: tuple[float, ...] = ()
    scale_sigma: float | None = None

    def table(self) -> dict[str, Any]:
        """The sight as JSON holds it."""
        rows = [list(row) for row in self.covariance]
        return {**asdict(self), "s": list(self.s), "d": list(self.d), "covariance": rows, "gain": list(self.gain)}

    @staticmethod
    def of(table: Mapping[str, Any]) -> Measurement:
        """The sight of a table."""
        lists = {name: tuple(table[name]) for name in ("s", "d", "gain")}
        return Measurement(**{**table, **lists, "covariance": tuple(tuple(row) for row in table["covariance"])})


def track_of(sight: Measurement, t: Array, coefficients: Array, scale: float) -> ShapeTrack:
    """A track with the sight's covariance in every frame; t (F,) [s], coefficients (F, K)."""
    covariance = np.repeat(np.array(sight.covariance)[None], t.size, axis=0)
    sigma = np.nan if sight.scale_sigma is None else sight.scale_sigma
    accepted, reason = np.full(t.size, True), ("",) * t.size
    return ShapeTrack(t, coefficients, covariance, accepted, reason, scale, sigma, np.zeros(2))


def track_noise(sight: Measurement, frames: int, random: np.random.Generator) -> Array:
    """Errors (F, K) of a track's coefficients [base angle offset, q1 ..], white from frame to frame.

    The gain is that of the whitened channels, in Legendre coordinates, as the fit found it.
    """
    covariance = np.array(sight.covariance)
    order = covariance.shape[0] - 1
    to_monomial = np.eye(order + 1)
    to_monomial[1:, 1:] = legendre_to_monomial(order)
    inverse = np.linalg.inv(to_monomial)
    root = information_root(inverse @ covariance @ inverse.T)
    white = np.array(sight.gain) * random.standard_normal((frames, order + 1))
    return np.linalg.solve(root, white.T).T @ to_monomial.T

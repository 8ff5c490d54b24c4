"""The result of one frame: its shape with covariance and its information on the shared parameters, or the reason of a
rejection.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.signals import Array
from vision.fit import FrameFit
from vision.kinematics import SHARED


@dataclass(frozen=True)
class TrackedFrame:
    """One frame's result. x (K,): base angle offset and q [rad]; covariance (K, K), given the recording's parameters.

    reason is "" where the frame was accepted; otherwise x is NaN. dx_dg (K, G): derivative of x by g.
    shared_information (G, G), shared_gradient (G,): information on g with x free. sigma [px] and waves (W,) are those
    of its edges; outline_px (N, 2) is for the overlay.
    """

    t: float
    theta: float
    x: Array
    covariance: Array
    reason: str
    dx_dg: Array
    shared_information: Array
    shared_gradient: Array
    sigma: float
    waves: Array
    outline_px: Array

    @property
    def accepted(self) -> bool:
        """Whether the frame can be trusted."""
        return not self.reason


def refused(t: float, theta: float, size: int, reason: str) -> TrackedFrame:
    """A rejected frame with `size` coordinates."""
    nothing = np.full(size, np.nan)
    return TrackedFrame(
        t=t, theta=theta, x=nothing, covariance=np.full((size, size), np.nan), reason=reason,
        dx_dg=np.zeros((size, SHARED)), shared_information=np.zeros((SHARED, SHARED)),
        shared_gradient=np.zeros(SHARED), sigma=np.nan, waves=np.zeros(0), outline_px=np.zeros((0, 2)),
    )  # fmt: skip


def eliminate(fit: FrameFit) -> tuple[Array, Array, Array, Array]:
    """Covariance of x given g (K, K), dx_dg (K, G), and information and gradient on g: (G, G) and (G,)."""
    k = len(fit.x)
    normal = fit.information / fit.sigma**2
    gradient = fit.gradient / fit.sigma**2
    covariance = np.asarray(np.linalg.inv(normal[:k, :k] + 1e-6 * np.eye(k)), dtype=float)
    dx_dg = -covariance @ normal[:k, k:]
    return covariance, dx_dg, normal[k:, k:] + normal[k:, :k] @ dx_dg, gradient[k:] + dx_dg.T @ gradient[:k]

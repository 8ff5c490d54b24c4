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
    """Covariance of x given g (K, K), dx_dg (K, G), and information and gradient of the edges on g: (G, G) and (G,).

    The usual bend (fit.held) says nothing of g. A polynomial that is counted from another place, or over another
    length, is another polynomial, so the sides hardly show where an arm begins and how long it is. A prior on less
    bend, which a shorter arm needs, would decide both.
    """
    k = len(fit.x)
    normal = fit.information / fit.sigma**2
    gradient = fit.gradient / fit.sigma**2
    within, across = normal[:k, :k] + 1e-6 * np.eye(k), normal[:k, k:]
    covariance = np.asarray(np.linalg.inv(within + fit.held / fit.sigma**2), dtype=float)
    free = np.linalg.solve(within, np.column_stack([across, gradient[:k]]))
    told, slope = normal[k:, k:] - across.T @ free[:, :-1], gradient[k:] - across.T @ free[:, -1]
    return covariance, -covariance @ across, 0.5 * (told + told.T), slope


def doubted_end(fit: FrameFit, covariance: Array, off: float) -> Array:
    """The covariance (K, K) of a fit that ends off [px] beside the seen end: C + off^2 d d', d = C j / (j' C j).

    d is the likeliest change of x that moves the last side edge by 1 px, j (K,) the derivative of that edge by x. The
    other edges hardly move.
    """
    last = np.flatnonzero(fit.expected.kind == 0)[-1]
    lean = fit.expected.jacobian[last, : len(fit.x)]
    way = covariance @ lean / float(lean @ covariance @ lean)
    return covariance + off**2 * np.outer(way, way)

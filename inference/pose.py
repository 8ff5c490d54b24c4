"""What the evidence would be if the constant errors of the camera's pose were known more accurately.

    E(S') = E(S) - 1/2 log det(S' S^-1) - 1/2 log det(1 + V D) - 1/2 m' (D^-1 + V)^-1 m,        D = S'^-1 - S^-1

S and S' (2 R, 2 R): prior covariances of roll and scale of R recordings, S' the smaller; m (2 R,), V (2 R, 2 R): their
posterior mean and covariance under S, all other unknowns marginalised. The identity is exact for Gaussians: D is the
precision of a further measurement of the pose that found no error.

The decision coarsens the likelihood (discovery.decide), because declared laws are known only approximately. What is
known of the set-up does not depend on these laws. In Miller and Dunson's posterior (2019) the prior is not coarsened:
p(y | pose)^(1/T) p(pose) is [p(y | pose) p'(pose)]^(1/T), with p' of the variance S / T.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from affine_model.curvature import Array
from inference.latent_force import Filter, pose_variance


@dataclass(frozen=True)
class PosteriorPose:
    """Posterior of the pose errors beside one share of unknown forces: mean (2 R,) and covariance (2 R, 2 R)."""

    share: float
    mean: Array
    covariance: Array

    def evidence_gained(self, coarsening: float) -> float:
        """Change of the log evidence [nats] with the pose's prior of this coarsening."""
        before, after = pose_variance(self.share), pose_variance(self.share, coarsening)
        further = 1.0 / after - 1.0 / before
        if further <= 0.0:
            return 0.0
        volume = np.linalg.slogdet(np.eye(self.mean.size) + further * self.covariance)[1]
        surprise = self.mean @ np.linalg.solve(np.eye(self.mean.size) / further + self.covariance, self.mean)
        return 0.5 * float(self.mean.size * np.log(before / after) - volume - surprise)


def posterior_pose(filters: Sequence[Filter], white: tuple[Array, Array], information: Array) -> PosteriorPose:
    """The posterior of the pose errors. white: whitened residual (N,) at the best unknowns, and the unknowns' columns
    (N, P); information (P, P): of the unknowns, priors included.
    """
    residual, columns = white
    seen_errors = np.asarray(block_diag(*(one.pose_rows() for one in filters)), dtype=np.float64)
    rows = np.concatenate([seen_errors, np.zeros((residual.size - seen_errors.shape[0], seen_errors.shape[1]))])
    crossed = columns.T @ rows
    seen = rows.T @ rows - crossed.T @ np.linalg.lstsq(information, crossed, rcond=1e-12)[0]
    before = pose_variance(filters[0].share)
    covariance = before * np.eye(rows.shape[1]) - before**2 * seen
    return PosteriorPose(filters[0].share, -before * (rows.T @ residual), 0.5 * (covariance + covariance.T))

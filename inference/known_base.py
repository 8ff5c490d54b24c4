"""Which frames show the base where the servo's log knows its angle.

    root(t) - theta(t) = shift(t) theta'(t) + noise,        shift(t) = a + b t        (least squares)

root: the seen direction of the arm's root; theta: the logged angle at the frame's stamp. Camera and servo may run by
clocks that differ. A frame whose instant t + shift(t) lies beyond an end of the log at which the base moves shows an
angle that nobody measured: one such frame can cost more than all others, and looks like an effect of the servo. Beyond
an end at which the base rests it rests on.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from inference.observation import Observation
from tentacle.base_motion import BaseMotion

AnyObservation = TypeVar("AnyObservation", bound=Observation)
SURE = 3.0  # standard errors by which an instant must lie beyond the log


def within_log(observation: AnyObservation, motion: BaseMotion | None) -> tuple[AnyObservation, int]:
    """The observation without the frames beyond the log (motion; None: there is none), and their number."""
    beyond = ~_known(observation, motion)
    return (observation.without(beyond) if beyond.any() else observation), int(beyond.sum())


def _known(observation: Observation, motion: BaseMotion | None) -> NDArray[np.bool_]:
    t = observation.t
    known: NDArray[np.bool_] = np.ones(t.size, dtype=bool)
    if motion is None:
        return known
    shift, error = _shift(observation, motion)
    shown, surely = t + shift, SURE * error
    if not motion.rests_at(motion.start, t.size):
        known &= shown >= motion.start - surely
    if not motion.rests_at(motion.stop, t.size):
        known &= shown <= motion.stop + surely
    return known


def _shift(observation: Observation, motion: BaseMotion) -> tuple[Array, Array]:
    """How much later (T,) [s] the base is seen than the frames are stamped, and its standard error (T,) [s].

    Both are 0 where no root is seen.
    """
    t = observation.t
    none = np.zeros(t.size)
    seen, offset = observation.root_offset()
    use = seen & (t >= motion.start) & (t <= motion.stop)
    rate = motion(t[use])[1]
    columns, root = np.stack([rate, rate * t[use]], axis=1), offset[use]
    if use.sum() <= columns.shape[1] or np.linalg.matrix_rank(columns) < columns.shape[1]:
        return none, none
    values, *_ = np.linalg.lstsq(columns, root, rcond=None)
    variance = float(np.sum((root - columns @ values) ** 2)) / (root.size - columns.shape[1])
    covariance = variance * np.linalg.inv(columns.T @ columns)
    at = np.stack([np.ones(t.size), t], axis=1)
    return at @ values, np.sqrt(np.einsum("tj,jk,tk->t", at, covariance, at))

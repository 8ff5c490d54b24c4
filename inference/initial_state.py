"""Where a run begins: its initial shape and rates as the first frames show them, without dynamics."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from affine_model.curvature import Array, legendre_to_monomial
from affine_model.points_beside import points_beside
from inference.experiment import Experiment
from inference.motion_spread import likely_shapes
from inference.observation import POSE, ShapeObservation

FIRST_FRAMES = 6  # of a recording: a marker's place at the start is their mean
PLACED = 0.003  # arm lengths: deviation of a marker beside 1 rad of prior on the shape


def initial_nuisances(experiment: Experiment, order: int) -> Array:
    """Initial shape and rates of a run from its first frames (released: from all frames before)."""
    observation = experiment.observation.shapes
    start = np.zeros(order)
    rates = np.zeros(order)
    if observation is not None:
        seen = np.flatnonzero(observation.seen)
        kept = min(order, observation.order)
        if experiment.release is not None:
            held = seen[observation.t[seen] <= experiment.release]
            held = held if held.size else seen[:1]
            start[:kept] = np.median(_shapes(experiment, observation, held)[:, :kept], axis=0)
        else:
            first = seen[:6]
            shapes = _shapes(experiment, observation, first)[:, :kept]
            slope, offset = np.polyfit(observation.t[first] - experiment.t0, shapes, 1)
            start[:kept], rates[:kept] = offset, slope
    else:
        start = _shape_of_points(experiment, order)
    moving = rates if experiment.release is None else np.zeros(1)
    known = np.concatenate([start, moving])
    return np.concatenate([known, np.zeros(len(experiment.nuisance_names(order)) - known.size)])


def _shapes(experiment: Experiment, observation: ShapeObservation, frames: NDArray[np.intp]) -> Array:
    """Legendre coordinates (F, K) of these frames, as likely as the motion of the recording makes them."""
    if experiment.shapes_seen.size < observation.order:
        return observation.coefficients[frames, POSE:]
    return likely_shapes(observation, frames, experiment.shapes_seen)


def _shape_of_points(experiment: Experiment, order: int) -> Array:
    """The Legendre coordinates (order,) that markers show at the start (released: before it), without dynamics.

    A coordinate that the markers do not show stays near zero.
    """
    markers = experiment.observation
    (s, xy), d = markers.points(np.zeros(0)), markers.beside
    assert d is not None
    seen = np.flatnonzero(np.isfinite(xy).all(axis=(1, 2)))
    until = experiment.release if experiment.release is not None else markers.t[seen[:FIRST_FRAMES][-1]]
    early = seen[markers.t[seen] <= until]
    early = early if early.size else seen[:1]
    there, theta = xy[early].mean(axis=0), markers.theta[early].mean()
    to_monomial = legendre_to_monomial(order)

    def missed(z: Array) -> Array:
        points = points_beside(to_monomial @ z, theta, markers.length, s, d)
        return np.concatenate([(points - there).ravel() / (PLACED * markers.length), z])

    found = least_squares(missed, np.zeros(order))
    return np.asarray(found.x) if found.success else np.zeros(order)  # the straight arm, from which the fit begins too

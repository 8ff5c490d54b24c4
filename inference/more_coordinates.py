"""A model with more curvature coordinates: the same motion at first, for the higher Legendre coordinates begin at 0."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from affine_model.curvature import Array
from inference.trajectory import Problem


def with_coordinates(problem: Problem, nuisances: tuple[Array, ...], order: int) -> tuple[Problem, tuple[Array, ...]]:
    """The problem with `order` coordinates, no fewer than it has, and its nuisances."""
    before, more = problem.arm.order, np.zeros(order - problem.arm.order)
    arm = replace(problem.arm, order=order, nodes=max(problem.arm.nodes, order + 4))
    found = []
    for experiment, own in zip(problem.experiments, nuisances, strict=True):
        shape, moving, memory, shift = experiment.parts(before, own)
        last = own[len(own) - len(experiment.varies) :]
        rates = np.concatenate([moving, more]) if experiment.release is None else moving
        remembered = np.concatenate([memory, more]) if experiment.begins_with_memory else memory
        found.append(np.concatenate([shape, more, rates, remembered, shift, last]))
    return replace(problem, arm=arm), tuple(found)

"""What Table II's ratio depends on: the gain of the best gait over the best sine, over the map's edge and the rail.

The paper states neither the largest frequency of its thrust map nor the friction of its rail. Both decide the ratio, so
it is shown as a curve over each of them, found by the paper's kind of search (speed on the rail, within pi/6).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from affine_model.curvature import Array
from affine_model.simulate import Rail
from affine_model.swim.objectives import OBJECTIVES
from affine_model.swim.optimise import optimise_gait
from affine_model.swim.search import SearchPlan
from affine_model.swim.silicones import assumed_model, paper_cone
from affine_model.swim.table2 import MAP_LIMITS, PRINTED_SPEEDS, TABLE2_SILICONE
from affine_model.swim.trial import PAPER_RAIL, trial_of

EDGES = (0.6, 0.75, 0.9, 1.0, 1.25, 1.5)  # Hz
FRICTIONS = (0.05, 0.1, 0.2, 0.35, 0.7, 1.4)  # N s/m


@dataclass(frozen=True)
class RatioCurves:
    """lengths (A,) [m]; by_edge (A, E): gait over best sine with the map's edge at edges (E,) [Hz], the rail as in
    Table II; by_friction (A, F): at frictions (F,) [N s/m] of the rail, the edge as in Table II.
    """

    lengths: Array
    edges: Array
    by_edge: Array
    frictions: Array
    by_friction: Array


def gain(length: float, edge: float, friction: float, *, evaluations: int, seed: int, device: str | None) -> float:
    """Speed of the best gait over that of the best sine, base within pi/6 and `edge` [Hz], rail `friction` [N s/m]."""
    limits = replace(MAP_LIMITS, highest_frequency=edge)
    trial = replace(trial_of(assumed_model(paper_cone(length), TABLE2_SILICONE), limits), device=device)
    rail = Rail(PAPER_RAIL.mass, friction)
    return optimise_gait(trial, OBJECTIVES["speed"], SearchPlan(evaluations=evaluations, seed=seed), rail=rail).gain


def ratio_curves(
    *,
    evaluations: int = 1500,
    seed: int = 0,
    device: str | None = None,
    edges: tuple[float, ...] = EDGES,
    frictions: tuple[float, ...] = FRICTIONS,
    watch: Callable[[str], None] | None = None,
) -> RatioCurves:
    """The curves of the paper's three arms; watch hears of every arm before it is computed."""
    settings = {"evaluations": evaluations, "seed": seed}
    by_edge, by_friction = [], []
    for length in PRINTED_SPEEDS:
        if watch is not None:
            watch(f"ratios of the {100 * length:.0f} cm arm")
        by_edge.append([gain(length, edge, PAPER_RAIL.viscous, **settings, device=device) for edge in edges])
        highest = MAP_LIMITS.highest_frequency
        by_friction.append([gain(length, highest, friction, **settings, device=device) for friction in frictions])
    arrays = (np.array(tuple(PRINTED_SPEEDS)), edges, by_edge, frictions, by_friction)
    return RatioCurves(*(np.array(values, dtype=float) for values in arrays))

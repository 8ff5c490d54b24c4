"""R of one of two hidden effects beside the other: how much of its change no fit of the other's law absorbs.

    R(b | a) = rms of what is left of  h(a, b) - h(a)  after the base and a's law in the catalogue are fitted

h: the shapes without noise, whitened, in a plant with these effects. R of an effect by itself (plant_recording) says
how far it can be seen in an arm that has no other; of two that move the arm alike, each may hide the other. a's law is
first fitted to h(a), because the plant's law has another form; what it then leaves is no part of R.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from affine_model.curvature import Array
from affine_model.effect import Effect
from affine_model.effects import catalogue
from discovery.starts import strength_grid
from inference.fit import Fit, fit
from inference.multistart import fit_multistart
from inference.trajectory import Problem
from validation.plants import shown
from validation.plants.filmed import film
from validation.trials.plant_design import PlantDesign
from validation.trials.plant_recording import arm_of_trial, sizing_problem, whitened_shapes

SIZES = (0.03, 0.1, 0.3, 1.0, 3.0, 10.0)  # of a strength, in nominal sizes: trials hide small ones too
KEPT = 4  # starts that are fitted roughly: the best of the grid


def sizes_beside(design: PlantDesign) -> list[float]:
    """R of each of a midline trial's hidden effects beside the other [noise sigmas]; [] where there are not two.

    FloatingPointError where the plant runs away.
    """
    trial, plant = arm_of_trial(design)
    run = shown(trial, plant)
    if len(run.hidden) != 2:
        return []
    problem, nuisances = sizing_problem(design, trial)
    midlines = (run.bare, *(film(trial, plant, (one,))[0] for one in run.hidden), run.xy)
    bare, first, second, both = (whitened_shapes(problem, trial, run, xy) for xy in midlines)
    found = []
    for other, alone in ((1, second), (0, first)):  # what stands beside the first, then beside the second
        known = _fitted(problem, nuisances, run.hidden[other].effect, bare - alone)
        found.append(_left(known, alone - both))
    return found


def _fitted(problem: Problem, nuisances: Array, effect: str, rows: Array) -> tuple[Problem, Fit]:
    """The base and an effect of the catalogue, fitted to the bare arm's shapes with this change; rows (T, K): whitened,
    before minus after.
    """
    (experiment,) = problem.experiments
    measured = replace(experiment, observation=experiment.observation.subtract_residual(rows))
    law = catalogue()[effect]
    free = (*problem.free, *((effect, one.name) for one in law.parameters))
    wider = replace(problem, experiments=(measured,), free=free)
    base = problem.parameters[problem.rows()]
    starts = np.array([[*base, *values] for values in starts_of(law)]).T
    return wider, fit_multistart(wider, (nuisances,), starts, keep=KEPT)


def starts_of(law: Effect) -> list[tuple[float, ...]]:
    """Starts of a law's parameters in their order: its scanned shapes with each point of the grid of strengths."""
    found = []
    for shapes, strengths in product(product(*(one.scan for one in law.shapes)), strength_grid(law, SIZES)):
        values = dict(zip(law.shapes, shapes, strict=True)) | dict(zip(law.strengths, strengths, strict=True))
        found.append(tuple(float(values[one]) for one in law.parameters))
    return found


def _left(known: tuple[Problem, Fit], rows: Array) -> float:
    """R of a change of the data beside a fitted law: rms of what refitting it and the base leaves."""
    wider, law = known
    (experiment,) = wider.experiments
    exact = experiment.observation.subtract_residual(law.residuals[0]).subtract_residual(rows)
    changed = replace(wider, experiments=(replace(experiment, observation=exact),), parameters=law.parameters)
    refitted = fit(changed, law.nuisances)
    return float(np.sqrt(np.mean(refitted.residuals[0][experiment.used] ** 2)))

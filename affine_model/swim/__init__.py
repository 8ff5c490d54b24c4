"""Optimal swimming: the gait of eq. 20 within a servo's limits, searched over the batched model (eq. 21) and beyond."""

from affine_model.swim.limits import HOBBY_SERVO, Box, GaitLimits, search_box
from affine_model.swim.methods import METHODS
from affine_model.swim.objectives import OBJECTIVES, Objective, cost_of_transport
from affine_model.swim.optimise import Promise, Swimming, optimise_gait, promises
from affine_model.swim.pareto import Front, pareto_front
from affine_model.swim.robust import parameter_samples, robust_trial
from affine_model.swim.search import Generation, SearchPlan, search
from affine_model.swim.silicones import SILICONES, assumed_model, paper_cone
from affine_model.swim.thrust_map import SineMap, best_sine, sine_gaits, sine_map
from affine_model.swim.trial import PAPER_RAIL, SERVO_HULL, GaitOutcome, GaitTrial, run, trial_of, within_limits
from affine_model.swim.waves import best_wave, single_waves

__all__ = [
    "HOBBY_SERVO",
    "METHODS",
    "OBJECTIVES",
    "PAPER_RAIL",
    "SERVO_HULL",
    "SILICONES",
    "SearchPlan",
    "Box",
    "Front",
    "Generation",
    "Objective",
    "GaitOutcome",
    "Promise",
    "GaitLimits",
    "SineMap",
    "Swimming",
    "GaitTrial",
    "assumed_model",
    "best_sine",
    "best_wave",
    "cost_of_transport",
    "optimise_gait",
    "paper_cone",
    "parameter_samples",
    "pareto_front",
    "promises",
    "robust_trial",
    "run",
    "search",
    "search_box",
    "sine_gaits",
    "sine_map",
    "single_waves",
    "trial_of",
    "within_limits",
]

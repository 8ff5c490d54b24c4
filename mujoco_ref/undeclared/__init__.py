"""Test recordings with effects that their declaration leaves out, made by the reference simulation.

The loop that looks for them (discovery) must not import this; the import rules check it.
"""

from mujoco_ref.undeclared.make import Noise, Scenario, make_recording
from mujoco_ref.undeclared.trials import SealedPlan, SimulatedTrial, trial_name

__all__ = ["Noise", "SealedPlan", "Scenario", "SimulatedTrial", "make_recording", "trial_name"]

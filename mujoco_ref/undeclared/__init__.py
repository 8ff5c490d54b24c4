"""Test recordings with effects that their declaration leaves out, made by the reference simulation.

The loop that looks for them (discovery) may not import this: the import rules see to it.
"""

from mujoco_ref.undeclared.make import Noise, Scenario, make_recording
from mujoco_ref.undeclared.trials import SealedPlan, SimulatedTrial, trial_name

__all__ = ["Noise", "SealedPlan", "Scenario", "SimulatedTrial", "make_recording", "trial_name"]

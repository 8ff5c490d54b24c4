"""The stranger: a filmed rod of point masses (validation.plants.rod). It imports neither of the project's models."""

from __future__ import annotations

from validation.plants.draw import Trial
from validation.plants.filmed import Plant
from validation.plants.rod import move


def plant(_: Trial) -> Plant:
    """The trial's rod: every trial has the same pieces and steps."""
    return Plant(move)

"""The stranger: a rod of point masses (validation.plants.rod), filmed. It imports neither of the project's models."""

from __future__ import annotations

from typing import Any

from tentacle.recording import Recording
from validation.plants import filmed
from validation.plants.draw import Trial
from validation.plants.rod import move


def run(trial: Trial) -> tuple[Recording, dict[str, Any]]:
    """The trial's recording and its truth."""
    return filmed.run(trial, move)

"""The arm and a recording's observation at other values of the uncertain declared numbers.

A fit moves declared numbers (length, radii, density, payload, gravity's angle, scale, marker positions) through the
exact arm that has them: sections, masses and quadrature are made anew.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from affine_model.arm import Arm
from affine_model.curvature import Array
from inference.arm_at import arm_at
from inference.experiment import Experiment
from tentacle.declared import Uncertain

SCALE = "camera.m_per_px"
DECLARED = "declared"  # used instead of an effect's name for a declared number


def names_of(declared: tuple[Uncertain, ...]) -> tuple[tuple[str, str], ...]:
    """The declared numbers as names of free parameters."""
    return tuple((DECLARED, number.name) for number in declared)


def with_declared_numbers(
    arm: Arm, experiments: tuple[Experiment, ...], numbers: tuple[Uncertain, ...], values: Array
) -> tuple[Arm, tuple[Experiment, ...]]:
    """The first recording's arm, and the experiments, with the uncertain numbers at these values (D,)."""
    stated = list(zip(numbers, values.tolist(), strict=True))
    shared = {number.field: value for number, value in stated if not number.only_in}
    of_first = {number.field: value for number, value in stated if number.only_in in ("", experiments[0].name)}
    found = arm_at(arm, tuple(of_first.items()))
    moved = []
    for experiment in experiments:
        alone = {number.field: value for number, value in stated if number.only_in == experiment.name}
        means = {number.field: number.value for number in numbers if number.only_in in ("", experiment.name)}
        own = {**dict(experiment.differs), **alone}
        changed = replace(experiment, differs=tuple(own.items()))
        moved.append(_experiment_at(changed, changed.arm(found), {**shared, **own}, means))
    return found, tuple(moved)


def _experiment_at(
    experiment: Experiment, arm: Arm, values: Mapping[str, float], means: Mapping[str, float]
) -> Experiment:
    """The experiment with these declared values instead of their means."""
    scale = values.get(SCALE, 1.0) / means.get(SCALE, 1.0)
    return replace(experiment, observation=experiment.observation.declared_as(arm.specimen.length, scale, values))

"""The arm and a recording's observation at other values of the uncertain declared numbers.

A fit moves declared numbers (length, radii, density, payload, gravity's angle, scale, marker positions) through the
exact arm that has them: sections, masses and quadrature are made anew.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from affine_model.arm import Arm
from affine_model.curvature import Array
from inference.arm_at import arm_at
from inference.experiment import Experiment
from tentacle.declared import Uncertain

SCALE = "camera.m_per_px"
SHEAR = "specimen.shear_compliance"
DECLARED = "declared"  # used instead of an effect's name for a declared number
ARM_TABLES = ("specimen", "fluid", "gravity")  # of recording.toml: the other numbers say how the arm is seen


@dataclass(frozen=True)
class SeenAs:
    """A recording with its uncertain numbers at some values: its arm, its experiment, and the individuals (L,) with
    these values.
    """

    arm: Arm
    experiment: Experiment
    lanes: np.ndarray


def names_of(declared: tuple[Uncertain, ...]) -> tuple[tuple[str, str], ...]:
    """The declared numbers as names of free parameters."""
    return tuple((DECLARED, number.name) for number in declared)


def with_declared_numbers(
    arm: Arm, experiments: tuple[Experiment, ...], numbers: tuple[Uncertain, ...], values: Array
) -> tuple[Arm, tuple[Experiment, ...]]:
    """The first recording's arm, and the experiments, with the uncertain numbers at these values (D,)."""
    found = arm_at(arm, tuple(_stated(numbers, values, experiments[0].name).items()))
    moved = []
    for experiment in experiments:
        own = _own(experiment, numbers, values)
        changed = replace(experiment, differs=tuple(own.items()))
        moved.append(_experiment_at(changed, changed.arm(found), numbers, {**_stated(numbers, values), **own}))
    return found, tuple(moved)


def runs_of(
    arm: Arm, experiments: tuple[Experiment, ...], place: int, numbers: tuple[Uncertain, ...], values: Array
) -> list[list[SeenAs]]:
    """What is simulated of one recording for individuals whose uncertain numbers have the values (D, B): for each arm
    the ways in which it is seen. A run serves all of these.
    """
    experiment, first = experiments[place], experiments[0].name
    here = values[that_matter_in(experiment, first, numbers)]
    kinds, whose, kind = np.unique(here, axis=1, return_index=True, return_inverse=True)
    runs: dict[int, list[SeenAs]] = {}
    for k in range(kinds.shape[1]):
        at = values[:, whose[k]]
        own = _own(experiment, numbers, at)
        of_arm = {name: v for name, v in {**_stated(numbers, at, first), **own}.items() if _is_of_arm(name)}
        there = arm_at(arm, tuple(sorted(of_arm.items())))  # the same object where its own numbers are the same
        known = replace(experiment, differs=())
        seen = _experiment_at(known, there, numbers, {**_stated(numbers, at), **own})
        runs.setdefault(id(there), []).append(SeenAs(there, seen, np.flatnonzero(kind.ravel() == k)))
    return list(runs.values())


def that_matter_in(experiment: Experiment, first: str, numbers: tuple[Uncertain, ...]) -> list[bool]:
    """Of each number whether it may matter in a recording; first: the first recording's name."""
    return [number.only_in in ("", experiment.name, first) for number in numbers]


def _stated(numbers: tuple[Uncertain, ...], values: Array, only: str = "") -> dict[str, float]:
    """The values that all recordings share, and those of one recording alone."""
    return {n.field: v for n, v in zip(numbers, values.tolist(), strict=True) if n.only_in in ("", only)}


def _own(experiment: Experiment, numbers: tuple[Uncertain, ...], values: Array) -> dict[str, float]:
    """The values in which a recording is not as the first one declares it."""
    alone = {n.field: v for n, v in zip(numbers, values.tolist(), strict=True) if n.only_in == experiment.name}
    return {**dict(experiment.differs), **alone}


def _is_of_arm(field: str) -> bool:
    return field.partition(".")[0] in ARM_TABLES


def _experiment_at(
    experiment: Experiment, arm: Arm, numbers: tuple[Uncertain, ...], values: Mapping[str, float]
) -> Experiment:
    """The experiment with these declared values instead of their means."""
    means = {n.field: n.value for n in numbers if n.only_in in ("", experiment.name)}
    scale = values.get(SCALE, 1.0) / means.get(SCALE, 1.0)
    return replace(experiment, observation=experiment.observation.declared_as(arm.specimen.length, scale, values))

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


def runs_of(
    arm: Arm, experiments: tuple[Experiment, ...], place: int, numbers: tuple[Uncertain, ...], values: Array
) -> list[list[SeenAs]]:
    """What is simulated of one recording for individuals whose uncertain numbers have the values (D, B): for each arm
    the ways in which it is seen. A run serves all of these.
    """
    own = experiments[place]
    here = [n.only_in in ("", own.name, experiments[0].name) for n in numbers]
    kinds, first, kind = np.unique(values[here], axis=1, return_index=True, return_inverse=True)
    runs: dict[int, list[SeenAs]] = {}
    for k in range(kinds.shape[1]):
        there, seen = _in_recording(arm, (experiments[0].name, own), numbers, values[:, first[k]])
        runs.setdefault(id(there), []).append(SeenAs(there, seen, np.flatnonzero(kind.ravel() == k)))
    return list(runs.values())


def _in_recording(
    arm: Arm, named: tuple[str, Experiment], numbers: tuple[Uncertain, ...], values: Array
) -> tuple[Arm, Experiment]:
    """The arm of a recording, the same object where its own numbers are the same, and the experiment that sees it.
    named: the first recording's name, and the experiment.
    """
    first, experiment = named
    stated = list(zip(numbers, values.tolist(), strict=True))
    of_first = {number.field: value for number, value in stated if number.only_in in ("", first)}
    shared = {number.field: value for number, value in stated if not number.only_in}
    alone = {number.field: value for number, value in stated if number.only_in == experiment.name}
    means = {number.field: number.value for number in numbers if number.only_in in ("", experiment.name)}
    own = {**dict(experiment.differs), **alone}
    of_arm = {name: v for name, v in {**of_first, **own}.items() if name.partition(".")[0] in ARM_TABLES}
    there = arm_at(arm, tuple(sorted(of_arm.items())))
    return there, _experiment_at(replace(experiment, differs=()), there, {**shared, **own}, means)


def _experiment_at(
    experiment: Experiment, arm: Arm, values: Mapping[str, float], means: Mapping[str, float]
) -> Experiment:
    """The experiment with these declared values instead of their means."""
    scale = values.get(SCALE, 1.0) / means.get(SCALE, 1.0)
    return replace(experiment, observation=experiment.observation.declared_as(arm.specimen.length, scale, values))

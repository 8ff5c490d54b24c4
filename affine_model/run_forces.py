"""Forces on the arms of both models, computed for the pictures after a run was compared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tentacle.diagnosis import RunComparison
    from tentacle.model import Model
    from tentacle.signals import Array


def with_forces(runs: Sequence[RunComparison], base: Model, augmented: Model) -> tuple[RunComparison, ...]:
    """The runs with drag_base and drag_augmented (in water, for frames with a midline). The two thrusts are given minus
    each model's reading at rest, like those of a tared load cell.
    """
    return tuple(
        replace(
            run,
            thrust_base=_tared(run.thrust_base, base),
            thrust_augmented=_tared(run.thrust_augmented, augmented),
            drag_base=_drag(run, run.base, base),
            drag_augmented=_drag(run, run.augmented, augmented),
        )
        for run in runs
    )


def _tared(thrust: Array | None, model: Model) -> Array | None:
    return None if thrust is None else thrust - rest_load(model)


def rest_load(model: Model) -> float:
    """Force [N] along +y of the straight arm at rest on its mount: weight minus buoyancy, plus a current's force."""
    import numpy as np

    from affine_model.arm import active_effects, arm_of, parameter_vector
    from affine_model.dynamics import balance

    arm, parameters = arm_of(model), parameter_vector(model)
    still = np.zeros(arm.order + 2)
    return float(balance(arm, active_effects(parameters), parameters, still, still).force[-1])


def _drag(run: RunComparison, xy: Array, model: Model) -> Array | None:
    from affine_model.arm import arm_of, parameter_vector
    from affine_model.drag_along import drag_along

    if run.points != "midline" or model.fluid.density <= 0.0:
        return None
    return drag_along(arm_of(model), parameter_vector(model), run.t, run.s, xy)

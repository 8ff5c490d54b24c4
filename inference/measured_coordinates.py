"""Data for figures: q over time as measured, and an identified model beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tentacle.diagnosis import RunComparison
    from tentacle.model import Model
    from tentacle.recording import Recording
    from tentacle.signals import Array


def coordinates(recording: Recording) -> tuple[Array, Array]:
    """t (T,) [s] and the paper's q1, q2 (T, 2) [rad] as measured, NaN where not. InputError for markers alone."""
    import numpy as np

    from inference.compare import reduced_shape
    from inference.prepare import prepare
    from tentacle.errors import InputError

    observation = prepare(recording, hold_out=False).experiment.observation.shapes
    if observation is None:
        raise InputError("has markers only", file=recording.name, expected="a video or a midline")
    q, _ = reduced_shape(observation, observation.coefficients, np.ones(1))
    return observation.t, q


def beside_model(recording: Recording, model: Model) -> RunComparison:
    """A recording beside an identified model that runs open loop. Only initial state and camera shift are fitted."""
    from affine_model.arm import arm_of, parameter_vector
    from inference.base_fit import FIRST_STEP, refit_noise_and_step
    from inference.compare import run_comparison
    from inference.fit import fit
    from inference.initial_state import initial_nuisances
    from inference.prepare import prepare
    from inference.trajectory import Problem

    prepared = prepare(recording, hold_out=False)
    problem = Problem(arm_of(model), (prepared.experiment,), (), parameter_vector(model), FIRST_STEP)
    problem, fitted = refit_noise_and_step(
        problem, fit(problem, (initial_nuisances(prepared.experiment, model.order),))
    )
    run, _, _ = run_comparison(prepared, 0, (problem, fitted), (problem, fitted), False)
    return run


def regression_sides(recording: Recording, model: Model) -> tuple[Array, Array, Array]:
    """t (T,) and both sides of eq. 18, delta and Y pi (T, 2) [N m], of measured q at a model's base parameters."""
    import numpy as np

    from affine_model.arm import Arm, parameter_index, parameter_vector
    from inference.measured_motion import measured_motion
    from inference.regression import motion_residual
    from tentacle.base_motion import fit_base_motion
    from tentacle.errors import InputError

    if recording.motor is None:
        raise InputError("the base is clamped", file=recording.name, expected="a recording with motor.csv")
    t, q = coordinates(recording)
    seen = np.isfinite(q).all(axis=1)
    t, q = t[seen], q[seen]
    arm = Arm(model.specimen, model.fluid, model.gravity, order=2)
    motion = measured_motion(arm, t, q, fit_base_motion(recording.motor)(t))
    whole = parameter_vector(model)
    bare = whole.copy()
    for effect in ("elasticity", "damping", "drag"):
        for name in model.parameters.get(effect, {}):
            bare[parameter_index(effect, name)] = 0.0
    delta = motion_residual(arm, bare, motion)
    return t, delta, delta - motion_residual(arm, whole, motion)

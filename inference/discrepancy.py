"""The error of the affine reduction itself: the declared model is fitted to a MuJoCo chain with the same parameters.

    discrepancy(t) = chain(t; parameters) - reduced model(t; fitted to the chain)

The chain has no missing effect. The misfit of the reduced model to it is therefore an error of the reduction and no
missing physics. It is known in every frame and is subtracted from the measurement before effects are searched (a
control variate, as in multi-fidelity estimation: Peherstorfer, Willcox and Gunzburger 2018).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from affine_model.arm import parameter_index
from affine_model.curvature import Array, midline
from affine_model.effects import catalogue
from inference.compare import judged_frames
from inference.declared_arm import DECLARED, SHEAR
from inference.experiment import Experiment, predict
from inference.fit import Fit, fit
from inference.measured_shapes import Tracker, fit_shapes
from inference.observation import ShapeObservation
from inference.trajectory import Problem
from mujoco_ref.simulate import Initial, Setup, simulate
from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.signals import Midline

LONGEST_CHAIN_RUN = 40.0  # s of each recording that the chain is run for
MIDLINE_POINTS = np.linspace(0.0, 1.0, 41)
EDGE_POINTS = np.linspace(0.02, 0.98, 41)  # a tracker sees edges all along, but for the corners at the ends
RIGID = 1e-9  # rad: a base angle's offset that varies less is one number for the whole recording
BESIDE_THE_ARM = ("servo", "measurement")  # families of effects that do not bend it


@dataclass(frozen=True)
class ModelDiscrepancy:
    """The misfit of the reduced model to the chain.

    structure, judged: rms in noise sigmas over the fitted and over the held-out stretch. millimetres: rms on the
    midline over both. beyond: for each recording chain minus reduced model (T, K) at its frames, in shape coefficients;
    None if the chain was not run, or not over the whole recording.
    """

    structure: float
    judged: float
    millimetres: float
    beyond: tuple[Array | None, ...] = ()

    @property
    def worst(self) -> float:
        """The larger value of the two stretches [noise sigmas]."""
        return max(self.structure, self.judged)


@dataclass(frozen=True)
class _Later:
    """A base motion counted from another zero of time."""

    motion: Callable[[Array], Array]
    t0: float

    def __call__(self, t: ArrayLike) -> Array:
        """theta, rate, acceleration (3, ...)."""
        return self.motion(np.asarray(t) + self.t0)


def model_discrepancy(problem: Problem, fitted: Fit, added: tuple[str, ...] = ()) -> ModelDiscrepancy | None:
    """The error of the reduction at the fitted parameters.

    None if no recording shows shapes of a moving base, or if the chain cannot run with these parameters. added: absent
    effects that the model has; they stay as fitted. Effects of servo and camera do not bend the arm, so neither chain
    nor reduced model has them. Links do not shear, so that neither does.
    """
    bending = tuple(name for name in added if catalogue()[name].family not in BESIDE_THE_ARM)
    problem, parameters = problem.known(fitted.parameters.copy())
    problem = _without_shear(problem)
    for name in set(added) - set(bending):
        for parameter in catalogue()[name].parameters:
            parameters[parameter_index(name, parameter.name)] = parameter.neutral
    free = tuple(name for name in problem.free if name[0] not in (*added, DECLARED))
    acting = tuple((name, parameter.name) for name in bending for parameter in catalogue()[name].parameters)
    tables: dict[str, dict[str, Estimate]] = {}
    for effect, parameter in (*free, *acting):
        tables.setdefault(effect, {})[parameter] = Estimate.exact(float(parameters[parameter_index(effect, parameter)]))
    fitted = replace(fitted, parameters=parameters)
    problem = replace(problem, free=free)
    fitted_rows, judged_rows, distances = [], [], []
    beyond: list[Array | None] = [None] * len(problem.experiments)
    for place, experiment in enumerate(problem.experiments):
        if experiment.observation.shapes is None or experiment.release is not None:
            continue
        try:
            arm = experiment.arm(problem.arm)
            model = Model(arm.specimen, arm.fluid, arm.gravity, arm.order, tables)
            virtual, rows, distance = _against_chain(model, problem, fitted, place)
        except InputError:
            return None
        used = virtual.used
        beyond[place] = _beyond(experiment, virtual, rows)
        fitted_rows.append(rows[used])
        judged_rows.append(rows[~used] if (~used).any() else rows[used])
        distances.append(distance)
    if not distances:
        return None
    lost = 1e3 * float(np.sqrt(np.mean(np.square(distances))))
    return ModelDiscrepancy(_rms(fitted_rows), _rms(judged_rows), lost, tuple(beyond))


def _without_shear(problem: Problem) -> Problem:
    """The problem of arms whose sections stand square to the midline."""
    experiments = [replace(e, differs=tuple(one for one in e.differs if one[0] != SHEAR)) for e in problem.experiments]
    arm = replace(problem.arm, specimen=replace(problem.arm.specimen, shear_compliance=0.0))
    return replace(problem, arm=arm, experiments=tuple(experiments))


def without_discrepancy(problem: Problem, reduction: ModelDiscrepancy) -> Problem | None:
    """The problem with the discrepancy subtracted from the measurement; None if it is not known for every recording."""
    experiments = []
    for experiment, beyond in zip(problem.experiments, reduction.beyond, strict=True):
        shapes = experiment.observation.shapes
        if beyond is None or shapes is None:
            return None
        corrected = experiment.observation.with_shapes(replace(shapes, coefficients=shapes.coefficients - beyond))
        experiments.append(replace(experiment, observation=corrected))
    return replace(problem, experiments=tuple(experiments))


def _beyond(experiment: Experiment, virtual: Experiment, rows: Array) -> Array | None:
    """Residuals (T', K) of the reduced model against the chain, as coefficients at the recording's frames."""
    seen, shown = experiment.observation, virtual.observation.shapes
    assert shown is not None
    if seen.t[-1] > shown.t[-1] + 0.5:  # frames just after the chain's end keep its last value
        return None
    coefficients: Array = (rows * virtual.noise_gain) @ np.linalg.pinv(shown.root[0]).T
    # linear interpolation would cut the turns of a swing by more than the noise
    t = np.minimum(seen.t, shown.t[-1])
    return np.array([CubicSpline(shown.t, column)(t) for column in coefficients.T]).T


def _rms(parts: list[Array]) -> float:
    return float(np.sqrt(np.mean(np.concatenate([part.ravel() for part in parts]) ** 2)))


def _against_chain(model: Model, problem: Problem, fitted: Fit, place: int) -> tuple[Experiment, Array, float]:
    """The chain's run from the fitted initial state as an experiment; whitened residuals (T, K) of the reduced model
    fitted to it; rms distance [m] of the two midlines.
    """
    experiment, arm = problem.experiments[place], problem.experiments[place].arm(problem.arm)
    observation = experiment.observation.shapes
    assert observation is not None
    interval = float(np.median(np.diff(observation.t)))
    duration = min(experiment.duration - 0.3, LONGEST_CHAIN_RUN)
    shape, moving, _, _ = experiment.parts(arm.order, fitted.nuisances[place])
    chain = simulate(
        model,
        _Later(experiment.base, experiment.t0),
        duration,
        1.0 / interval,
        setup=Setup(
            s=_points(observation),
            initial=Initial(arm.to_monomial @ shape, arm.to_monomial @ moving),
            travel=None if experiment.travel is None else _Later(experiment.travel, experiment.t0),
        ),
    )
    seen = replace(chain.midline, xy=chain.midline.xy - chain.mount[:, None])  # counted from the base
    virtual = _virtual(experiment, observation, seen)
    alone = replace(problem, experiments=(virtual,), parameters=fitted.parameters)
    again = fit(alone, (experiment.without_zeros(fitted.nuisances[place]),), most=12)
    shown = predict(arm, virtual, again.parameters[:, None], again.nuisances[0][:, None], problem.step)
    points = midline(shown.q[:, :, 0], shown.theta[:, 0], arm.specimen.length, seen.s)
    points = points + shown.shift[:, 0]
    distance = np.sqrt(np.mean(np.sum((points - seen.xy) ** 2, axis=2)))
    return virtual, again.residuals[0], float(distance)


def _points(observation: ShapeObservation) -> Array:
    """Places along the arm (0 .. 1) at which the chain is read, as in the recording.

    A least-squares shape of few coordinates depends on these places.
    """
    return EDGE_POINTS if observation.tracked else MIDLINE_POINTS


def _virtual(experiment: Experiment, observation: ShapeObservation, seen: Midline) -> Experiment:
    """The chain's midline as if it had been measured without noise by this recording's camera."""
    t = experiment.t0 + seen.t
    theta = experiment.base(t)[0]
    live = np.flatnonzero(observation.seen)
    typical = observation.root[live[live.size // 2]]
    as_here = Tracker(1e-4, observation.tracked, bool(np.ptp(observation.coefficients[live, 0]) < RIGID))
    shapes = fit_shapes(replace(seen, t=t), theta, observation.length, observation.order, as_here)
    judged = observation.t[judged_frames(experiment, True) & observation.seen]
    shapes = replace(shapes, root=np.repeat(typical[None], t.size, axis=0))
    used = (t < judged.min()) | (t > judged.max()) if judged.size else np.ones(t.size, dtype=bool)
    return replace(experiment.seeing(shapes), name="chain", duration=float(seen.t[-1]) + 0.2, used=used)

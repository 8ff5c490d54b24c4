"""A free decay is followed from its release: no cycle is lost although the fit begins far away."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import arm_of, neutral_parameters, parameter_index
from affine_model.base_signal import Steps, base_table
from affine_model.points_beside import points_beside
from affine_model.simulate import Start, Timing, simulate
from inference.base_fit import Setting
from inference.decay import fit_from_release, horizons_of
from inference.declared_arm import DECLARED
from inference.fit import fit
from inference.initial_state import initial_nuisances
from inference.prepare import prepare
from inference.successive_halving import followed
from tentacle.declared import Uncertain
from tentacle.model import Model
from tentacle.recording import Declaration, Recording
from tentacle.signals import Markers
from tentacle.specimen import AIR
from tentacle.waveform import Multisine
from tests.made_recordings import SPECIMEN

TRUE_E, TRUE_ETA, RELEASE = 2e5, 60.0, 0.3
STEP, EVERY, NOISE = 1.0 / 1200.0, 12, 2e-5


@pytest.fixture(scope="module")
def problem():
    """The fit of an arm that was held bent and let go in air."""
    arm = arm_of(Model(SPECIMEN, AIR, order=2))
    parameters = neutral_parameters()
    for name, value in ((("elasticity", "E"), TRUE_E), (("damping", "eta"), TRUE_ETA)):
        parameters[parameter_index(*name)] = value
    still = Multisine((0.0,), (1.0,), (0.0,))
    steps = round(2.5 / STEP)
    base = base_table(still, Steps(RELEASE, STEP, steps), parameters[:, None])
    bent = arm.to_monomial @ np.array([[0.3], [-0.05]])
    run = simulate(arm, parameters[:, None], base, Timing(STEP, EVERY), start=Start(q=bent, t0=RELEASE))
    before = np.arange(0.0, RELEASE - 1e-9, STEP * EVERY)
    q = np.concatenate([np.repeat(bent.T, before.size, axis=0), run.q[:, :, 0]])
    t, places = np.concatenate([before, run.t]), np.array([0.6, 0.8, 1.0])
    points = points_beside(q, np.zeros(t.size), SPECIMEN.length, places, np.zeros(3))
    points = points + NOISE * np.random.default_rng(0).standard_normal(points.shape)
    seen = Markers(t, ("a", "b", "c"), places, np.zeros(3), points)
    recording = Recording("decay", Declaration(SPECIMEN, AIR, release_t=RELEASE), markers=seen)
    experiment = prepare(recording, hold_out=False).experiment
    setting = Setting(recording.declaration, (experiment,), 2, step=1.0 / 600.0)
    return setting.problem(2, setting.start()), (initial_nuisances(experiment, 2),)


def test_a_horizon_holds_the_first_periods_alone(problem):
    horizons = horizons_of(*problem)
    whole = problem[0].experiments[0]
    frames = [early.problem.experiments[0].used.sum() for early in horizons]
    assert frames == sorted(frames)
    assert frames[0] < 0.3 * whole.used.sum()
    for early in horizons:
        first = early.problem.experiments[0]
        assert first.observation.t.size == first.used.size


@pytest.mark.parametrize("wrong", [0.1, 6.0])
def test_the_growing_horizon_finds_the_stiffness_from_far(problem, wrong):
    E = parameter_index("elasticity", "E")
    begun, nuisances = problem
    parameters = begun.parameters.copy()
    parameters[E] = wrong * TRUE_E
    begun, nuisances = fit_from_release(replace(begun, parameters=parameters), nuisances)
    # Six periods, each known to the noise alone: cycles are not lost before the fit of the whole begins.
    assert begun.parameters[E] == pytest.approx(TRUE_E, rel=0.05)
    followed = fit(begun, nuisances)
    # The midpoint rule at 1/600 s lowers the squared frequency by (27 rad/s)^2 (1/600 s)^2 / 6 = .03 %; noise: .01 %.
    assert followed.parameters[E] == pytest.approx(TRUE_E, rel=2e-3)


def test_declared_numbers_are_still_until_the_last_horizon(problem):
    """An uncertain length moves on the last leg alone; E moves on each."""
    whole, nuisances = problem
    length = Uncertain("specimen.length_m", SPECIMEN.length, 0.01 * SPECIMEN.length)
    numbers = np.append(whole.parameters, length.value)
    uncertain = replace(whole, declared=(length,), parameters=numbers, free=(*whole.free, (DECLARED, length.name)))
    place = uncertain.free.index((DECLARED, length.name))
    *early, last = horizons_of(uncertain, nuisances)
    assert [place in leg.moving for leg in (*early, last)] == [False, False, True]
    softer = numbers.copy()
    for name, value in ((("elasticity", "E"), 0.95 * TRUE_E), (("damping", "eta"), TRUE_ETA)):
        softer[parameter_index(*name)] = value
    found = followed(early, nuisances, softer[:, None])
    assert np.all(found.unknowns[place] == length.value)
    assert abs(found.unknowns[uncertain.free.index(("elasticity", "E"))] / TRUE_E - 1.0) < 0.02

"""Swimming with a free hull: what speed and drift mean, the balance of forces, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.free_body import Hull
from affine_model.swim import (
    OBJECTIVES,
    PAPER_RAIL,
    SERVO_HULL,
    SearchPlan,
    assumed_model,
    optimise_gait,
    paper_cone,
    run,
    sine_gaits,
    trial_of,
)
from affine_model.swim.film import swim_film
from affine_model.swim.free import HullCourse, forward_speed, yaw_drift
from affine_model.swim.gaits import gait_of
from affine_model.swim.trial import swum_freely
from tentacle.errors import InputError
from tentacle.model import Estimate

MODEL = assumed_model(paper_cone(0.21), "dragon-skin-10")
TRIAL = trial_of(MODEL)
GAIT = sine_gaits(np.array([0.45]), np.array([2.0]))


def test_speed_is_along_the_mean_heading():
    # 0.1 m/s forward at a yaw of 0.3 rad that sways: forward is (sin psi, -cos psi).
    t = np.linspace(0.0, 10.0, 1001)
    yaw = (0.3 + 0.2 * np.sin(2.0 * np.pi * t))[:, None]
    place = (0.1 * t)[:, None] * np.array([np.sin(0.3), -np.cos(0.3)])
    course = HullCourse(place[:, :, None], yaw)
    assert forward_speed(course, 10.0)[0] == pytest.approx(0.1, rel=1e-4)
    turning = HullCourse(place[:, :, None], yaw + (0.05 * t)[:, None])
    assert yaw_drift(course, 10.0)[0] == pytest.approx(0.0, abs=1e-3)
    assert yaw_drift(turning, 10.0)[0] == pytest.approx(0.05, abs=1e-3)


def test_a_hull_bound_to_its_heading_swims_as_on_the_rail():
    # The trial's own path: hull without yaw, sideways motion or quadratic drag.
    bound = Hull(PAPER_RAIL.mass, 1e6, viscous_across=1e6, viscous_along=PAPER_RAIL.viscous)
    afloat = replace(TRIAL, hull=bound).afloat()
    # The angle is carried by the hull here and prescribed there. The steps differ, by .126, .021 and .004 % of
    # the speed at 1/120, 1/240 and 1/480 s.
    fine = replace(afloat, step=1 / 480)
    on_rail = replace(TRIAL.on_rail(PAPER_RAIL), settle=fine.settle, step=fine.step)
    assert run(fine, GAIT).speed[0, 0] == pytest.approx(run(on_rail, GAIT).speed[0, 0], rel=1e-4)


def test_the_water_gives_the_hull_what_its_drag_takes():
    # A steady swim: the mean fluid force on the arm is the hull's mean drag, which is linear here and the same in all
    # directions: 0.5 N s/m times its velocity, along the first heading too. 8 s are 16 periods.
    hull = Hull(0.3, 3.1e-4, viscous_across=0.5, viscous_along=0.5, yaw_drag=9.4e-5)
    sure = replace(replace(TRIAL, hull=hull).afloat(), settle=20.0, window=8.0, step=1 / 400)
    outcome = run(sure, GAIT)
    course, _ = swum_freely(sure, outcome.alpha)
    swum = course.after(sure.settled // 2).place[:, 1, 0]
    assert outcome.thrust[0, 0] == pytest.approx(0.5 * (swum[0] - swum[-1]) / sure.window, rel=2e-3)


def test_the_film_and_the_trial_swim_the_same_way():
    afloat = TRIAL.afloat()
    alpha = run(afloat, GAIT).alpha
    film = swim_film(afloat, gait_of(alpha[:, 0], TRIAL.limits.bandwidth), 10.0)
    course, drift = swum_freely(afloat, alpha)
    at = round(10.0 / (2.0 * afloat.step))
    # 8 and 9 nodes, and steps of 1/120 s: the way is right to 1 %.
    np.testing.assert_allclose(film.xy[-1, 0], course.place[at, :, 0], atol=0.01 * film.travel[-1])
    assert abs(drift[0]) < 0.02


def test_the_free_objective_obeys_the_servo_and_is_told():
    found = optimise_gait(TRIAL, OBJECTIVES["free"], SearchPlan(evaluations=50, seed=1))
    assert found.promise.free_speed == pytest.approx(found.value, rel=1e-6)
    assert found.promise.free_power is not None
    assert found.promise.yaw_drift is not None
    assert found.gain >= 1.0 - 1e-9
    assert np.all(found.peaks <= TRIAL.limits.bounds.kinematic * 1.001)


def test_what_cannot_swim_freely_is_refused():
    walled = MODEL.with_effect("wall", B=Estimate.exact(1.0), distance=Estimate.exact(0.3))
    with pytest.raises(InputError, match="wall"):
        trial_of(walled).afloat()
    with pytest.raises(InputError, match="device"):
        replace(TRIAL, device="cuda:0").afloat()
    with pytest.raises(InputError, match="polish"):
        optimise_gait(TRIAL, OBJECTIVES["free"], SearchPlan(evaluations=50, polish=True))
    assert SERVO_HULL.mass > PAPER_RAIL.mass  # with the water that it carries

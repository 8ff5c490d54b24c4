"""Accelerometers: what the model says that they read, and what they add to markers that a slow camera sees."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

from affine_model.acceleration_beside import gravity_of
from affine_model.arm import Arm, arm_of, neutral_parameters, parameter_index
from affine_model.base_signal import Steps, base_table
from affine_model.simulate import Batch, Timing, simulate
from discovery.diagnose import diagnose
from discovery.given import Deciding
from inference.appearance import Appearance
from inference.base_fit import FIRST_STEP
from inference.frame_readings import FAST, at_frames
from inference.identify import Identification, identify
from inference.interpolate import at_times
from inference.latent_force import LAW_KNOWN
from inference.linearise import latent_forces
from inference.prepare import prepare
from inference.run_motion import accelerations, motion_at
from inference.sensor import AccelerometerAxis
from mujoco_ref.undeclared import Noise, Scenario, make_recording
from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.recording import Recording
from tentacle.signals import AccelerationSignal, Accelerometer, Array, Markers, Midline
from tentacle.specimen import WATER
from tentacle.waveform import Rest
from tests.made_recordings import SPECIMEN, TRUTH, WAVE, base_of

RATE, FPS = 240, 15  # readings and pictures a second
NOISE, ZEROS = 0.02, (0.3, -0.2)  # m/s^2
BLUR = 1e-3  # m of a marker
GRAVITY = 9.80665
AXES = (Accelerometer(1.0, 0.0, "normal"), Accelerometer(1.0, 0.0, "tangent"))
TIP_MASS = 2e-3  # kg


def scene() -> Scenario:
    """A run of the MuJoCo chain in water, from rest."""
    tables: dict[str, dict[str, Estimate]] = {}
    for (effect, name), value in TRUTH.items():
        tables.setdefault(effect, {})[name] = Estimate.exact(value)
    model = Model(SPECIMEN, WATER, parameters=tables)
    return Scenario(model, WAVE, 8.0, RATE, s=np.linspace(0, 1, 41))


def felt(seen: Midline) -> Array:
    """What the tip of the chain feels along normal and tangent (T - 2, 2): differences of its places, less gravity."""
    tip, interval = seen.xy[:, -1], seen.t[1] - seen.t[0]
    force = (tip[2:] - 2.0 * tip[1:-1] + tip[:-2]) / interval**2 - np.array([0.0, GRAVITY])
    along = (seen.xy[:, -1] - seen.xy[:, -2])[1:-1]
    tangent = along / np.linalg.norm(along, axis=1)[:, None]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    return np.stack([np.sum(force * normal, axis=1), np.sum(force * tangent, axis=1)], axis=1)


def seen_both_ways(hidden: Mapping[str, Mapping[str, float]], run: Scenario) -> tuple[Recording, Recording]:
    """A run as two blurred markers show it in a slow camera; and as an accelerometer at the tip shows it, too."""
    made, _ = make_recording(hidden, run, 1, Noise(1e-4, 0.0, 0.0), clean_midline=True)
    seen, random = made.midline, np.random.default_rng(3)
    assert seen is not None
    values = felt(seen) + np.array(ZEROS)
    values = values + NOISE * random.standard_normal(values.shape)
    xy = seen.xy[:: RATE // FPS, [20, 40]]
    xy = xy + BLUR * random.standard_normal(xy.shape)
    markers = Markers(seen.t[:: RATE // FPS], ("middle", "tip"), np.array([0.5, 1.0]), np.zeros(2), xy)
    marked = replace(made, midline=None, load_cell=None, markers=markers)
    read = AccelerationSignal(seen.t[1:-1], ("across", "along"), AXES, values)
    return marked, replace(marked, acceleration=read)


@pytest.fixture(scope="module")
def pair() -> tuple[Recording, Recording]:
    """A run of the declared arm."""
    return seen_both_ways({}, scene())


@pytest.fixture(scope="module")
def identified(pair: tuple[Recording, Recording]) -> tuple[Identification, Identification]:
    """Both identified, with as many coordinates."""
    return identify([pair[0]], order=4), identify([pair[1]], order=4)


def with_readings(recording: Recording, change: Callable[[AccelerationSignal], AccelerationSignal]) -> Recording:
    """The recording with other readings."""
    assert recording.acceleration is not None
    return replace(recording, acceleration=change(recording.acceleration))


def simulated(step: float) -> tuple[Arm, Array, Batch]:
    """The reduced model's run of that step, which keeps every other state, as a fit's does."""
    arm, parameters = arm_of(Model(SPECIMEN, WATER, order=4)), neutral_parameters()[:, None]
    for name, value in TRUTH.items():
        parameters[parameter_index(*name)] = value
    steps = round(8.0 / step)
    base = base_table(WAVE, Steps(0.0, step, steps), parameters)
    return arm, parameters, simulate(arm, parameters, base, Timing(step, 2))


def read_by(run: tuple[Arm, Array, Batch], times: Array) -> Array:
    """What both axes at the tip read (T, 2) of a run."""
    arm, parameters, batch = run
    moving = motion_at(arm, batch, times[:, None], gravity_of(arm, parameters)[None])
    q, theta = (
        at_times(batch.t, x, rate, times[:, None])
        for x, rate in ((batch.q, batch.q_rate), (batch.theta[:, None], batch.theta_rate[:, None]))
    )
    shown = replace(Appearance.as_declared(q, theta[:, 0]), motion=moving)
    return np.stack([AccelerometerAxis("tip", 1.0, axis).read(shown, SPECIMEN.length)[:, 0] for axis in AXES], axis=1)


def test_second_derivatives_are_exact_for_a_quintic() -> None:
    t = np.linspace(0.0, 1.0, 9)
    curve = np.polynomial.Polynomial([1.0, -2.0, 0.5, 3.0, -1.0, 0.7])
    found = accelerations(curve(t), curve.deriv()(t), float(t[1]))
    np.testing.assert_allclose(found, curve.deriv(2)(t), atol=1e-11)  # rounding, over the step's square


def test_the_model_s_tip_is_accelerated_as_that_of_the_chain() -> None:
    made, _ = make_recording({}, scene(), 1, Noise(1e-4, 0.0, 0.0), clean_midline=True)
    assert made.midline is not None
    true, times = felt(made.midline)[RATE:-RATE], made.midline.t[1:-1][RATE:-RATE]
    assert true.std(axis=0).min() > 0.3
    coarse, fine = (read_by(simulated(step), times) for step in (FIRST_STEP, 1.0 / 1200.0))
    # Twenty links against four coordinates: .002 m/s^2 (forty: .001); the step with which fits begin: .004.
    assert np.std(fine - true, axis=0).max() < 0.2 * NOISE
    assert np.std(coarse - true, axis=0).max() < 0.4 * NOISE
    np.testing.assert_allclose((fine - true).mean(axis=0), 0.0, atol=0.1 * NOISE)  # the zero is gravity's


def test_the_stiffness_is_right_and_more_certain_with_an_accelerometer(
    identified: tuple[Identification, Identification],
) -> None:
    alone, read = (one.model.parameters["elasticity"]["E"] for one in identified)
    for one in (alone, read):
        assert one.low < TRUTH["elasticity", "E"] < one.high
    assert read.high - read.low < 0.15 * (alone.high - alone.low)


def test_what_it_reads_is_compared_with_what_the_fit_says(identified: tuple[Identification, Identification]) -> None:
    across, along = identified[1].runs[0].sensors
    t = identified[1].runs[0].t
    for shown in (across.measured, across.base, across.augmented):  # none where the model's acceleration jumps
        assert np.array_equal(np.isfinite(shown), (t > 0.1) & (t < t[-1] - 0.1))
    assert (across.name, along.quantity) == ("across", "acceleration")
    for one, least in ((across, 1.0), (along, 0.3)):
        assert np.nanstd(one.measured) > least
        assert np.nanstd(one.measured - one.augmented) < NOISE


def test_the_zeros_change_nothing_else(
    pair: tuple[Recording, Recording], identified: tuple[Identification, Identification]
) -> None:
    moved = with_readings(pair[1], lambda read: replace(read, values=read.values + np.array([1.0, -2.0])))
    again = identify([moved], order=4).model.parameters["elasticity"]["E"]
    before = identified[1].model.parameters["elasticity"]["E"]
    assert again.value == pytest.approx(before.value, abs=0.05 * (before.high - before.low))


def test_a_base_that_travels_is_felt() -> None:
    """20 mm to and fro across at 1.3 Hz: 1.3 m/s^2, which the accelerometer feels and the base's own frame does not."""

    def travel(t: Array) -> Array:
        omega, still = 2.0 * np.pi * 1.3, 0.0 * t
        x, rate = 0.02 * (1.0 - np.cos(omega * t)), 0.02 * omega * np.sin(omega * t)
        return np.stack([x, still, rate, still, 0.02 * omega**2 * np.cos(omega * t), still])

    found = identify([seen_both_ways({}, replace(scene(), travel=travel))[1]], order=4)
    for one in found.runs[0].sensors:
        assert np.nanstd(one.measured - one.augmented) < NOISE
    stiffness = found.model.parameters["elasticity"]["E"]
    assert stiffness.value == pytest.approx(TRUTH["elasticity", "E"], rel=0.01)


def test_an_arm_that_is_held_until_its_release_reads_gravity_alone_until_then() -> None:
    held = replace(scene(), waveform=Rest(), initial_q=np.array([0.8, 0.0]), release_t=1.0)
    marked, read = (replace(one, motor=None) for one in seen_both_ways({}, held))
    alone, found = identify([marked], order=4), identify([read], order=4)
    for one in found.runs[0].sensors:
        early = one.measured[found.runs[0].t < 0.9]
        assert np.nanstd(early) < NOISE
        assert np.nanstd(one.measured) > 0.5
        assert np.nanstd(one.measured - one.augmented) < NOISE
    without, beside = (one.model.parameters["elasticity"]["E"] for one in (alone, found))
    assert beside.low < TRUTH["elasticity", "E"] < beside.high
    assert beside.high - beside.low < 0.5 * (without.high - without.low)


def test_readings_near_a_frame_are_taken_as_a_quartic_and_rare_ones_as_a_spline() -> None:
    frames, fine, often = np.arange(0.1, 3.9, 1.0 / FPS), np.arange(0.0, 4.0, 1e-3), np.arange(0.0, 4.0, 0.01)
    curve = np.polynomial.Polynomial([0.3, -1.0, 2.0, 0.7, -0.4])
    np.testing.assert_allclose(at_frames(frames, fine, curve(fine), FAST)[0], curve(frames), atol=1e-9)
    found, share = at_frames(frames, often, np.sin(12.0 * often), FAST)
    assert share == 1.0
    np.testing.assert_allclose(found, np.sin(12.0 * frames), atol=5e-6)  # 5 / 384 of (12 rad/s 10 ms)^4, and half


def test_in_the_likelihood_an_accelerometer_sees_its_own_error_and_its_place_alone(
    pair: tuple[Recording, Recording],
) -> None:
    judged = base_of(pair[1])
    force = latent_forces(judged.problem, judged.fitted.parameters, judged.fitted.nuisances)[0]
    n = force.linearised.mass.shape[0]
    assert not force.seen[:, -2:, : n + 2].any()
    assert np.all(np.any(force.seen[:, -2:, n + 2 :] != 0.0, axis=(0, 2)))
    error, observation = force.error, judged.problem.experiments[0].observation
    spread = np.nanstd(observation.readings[judged.problem.experiments[0].used], axis=0)
    deviations = np.array([sensor.sigma for sensor in observation.sensors])
    np.testing.assert_allclose(error.size[-2:] * deviations, spread, rtol=1e-12)
    np.testing.assert_array_equal(error.time[-2:], 1.0)
    drift, diffusion, start = force.state_equation(0.1)
    sizes = np.hypot(LAW_KNOWN, 0.1) * spread / deviations
    np.testing.assert_allclose(np.sqrt(np.diag(start)[-2:]), sizes, rtol=1e-12)
    np.testing.assert_allclose(np.diag(drift)[-2:], -1.0 / force.linearised.time, rtol=1e-12)
    np.testing.assert_allclose(np.diag(diffusion)[-2:], 2.0 * sizes**2 / force.linearised.time, rtol=1e-12)


def test_a_hidden_mass_at_the_tip_is_weighed_better_with_an_accelerometer() -> None:
    found = [
        diagnose([recording], seed=1, deciding=Deciding(laws=False)).parameters["tip_mass"]["mass"]
        for recording in seen_both_ways({"tip_mass": {"mass": TIP_MASS}}, scene())
    ]
    for one in found:
        assert one.low < TIP_MASS < one.high
    assert found[1].high - found[1].low < 0.6 * (found[0].high - found[0].low)


def test_it_states_its_noise_or_has_it_found(pair: tuple[Recording, Recording]) -> None:
    said = [words for words in prepare(pair[1], hold_out=False).words if words.startswith("Accelerometer across")]
    assert len(said) == 1
    assert float(said[0].split("no noise; ")[1].split()[0]) == pytest.approx(NOISE, rel=0.1)  # 1900 readings: 3 %


def test_one_that_was_off_or_is_too_slow_is_told(pair: tuple[Recording, Recording]) -> None:
    silent = with_readings(pair[1], lambda read: replace(read, values=read.values * np.array([1.0, np.nan])))
    with pytest.raises(InputError, match=r"acceleration\.along: has no reading while the arm is seen"):
        prepare(silent, hold_out=False)
    slow = with_readings(pair[1], lambda read: replace(read, t=read.t[::24].copy(), values=read.values[::24]))
    with pytest.raises(InputError, match=r"acceleration\.across: has a reading every 0\.1 s"):
        prepare(slow, hold_out=False)

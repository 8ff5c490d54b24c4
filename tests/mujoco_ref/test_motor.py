"""The reference's motor against the response of its equation, and against the reduced model's base motion."""

import numpy as np
import pytest

from affine_model.arm import neutral_parameters, parameter_index
from affine_model.base_signal import Steps, base_table
from mujoco_ref.motor import motor_signal
from tentacle.waveform import Multisine, Sine

STEP = 2e-3
WAVE = Multisine((0.3, 0.2), (0.6, 1.7), (0.0, 1.0))


def reduced(play=0.0, delay=0.0, sprung=0.0, tau=0.0, period=0.0):
    parameters = neutral_parameters()
    given = {"backlash": {"play": play, "delay": delay, "period": sprung}, "servo_lag": {"tau": tau, "period": period}}
    for effect, values in given.items():
        for name, value in values.items():
            parameters[parameter_index(effect, name)] = value
    return parameters[:, None]


@pytest.mark.parametrize(("tau", "period"), [(0.05, 0.0), (0.05, 0.3), (0.02, 0.1)])
def test_a_lag_has_the_gain_and_phase_of_its_equation(tau, period):
    omega, t = 2.0 * np.pi * 1.2, np.arange(0.0, 12.0, STEP)
    angle, rate, acceleration = motor_signal(
        Sine(0.4, 1.2), t, {"servo_lag": {"tau": tau, "period": period}}, lead_in=0.0
    )
    response = 0.4 / (1.0 + 1j * omega * tau - (omega * period / (2.0 * np.pi)) ** 2)
    late = t > 6.0  # the transient, exp(-t tau omega0^2 / 2), is gone: below e^-13 for the slowest of the three
    for row, factor in ((angle, 1.0), (rate, 1j * omega), (acceleration, -(omega**2))):
        exact = np.imag(factor * response * np.exp(1j * omega * t[late]))
        # Cubics between samples: (omega step)^4 / 384, far below; 1e-6 of the size is what a double filter keeps.
        assert np.allclose(row[late], exact, atol=1e-6 * abs(factor) + 1e-9)


SPRUNG = {"play": 0.05, "delay": 0.3, "sprung": 2.0}


@pytest.mark.parametrize("servo", [{"tau": 0.04, "period": 0.2}, SPRUNG, {"tau": 0.04, **SPRUNG}])
def test_both_models_turn_the_clamp_alike(servo):
    t = np.arange(0.0, 8.0, STEP)
    table = base_table(WAVE, Steps(-0.5 * STEP, STEP, t.size), reduced(**servo))[0, :, 0]
    given = {"backlash": {"play": servo.get("play", 0.0), "delay": servo.get("delay", 0.0)}}
    given["backlash"]["period"] = servo.get("sprung", 0.0)
    given["servo_lag"] = {"tau": servo.get("tau", 0.0), "period": servo.get("period", 0.0)}
    angle = motor_signal(WAVE, t, given, lead_in=0.0)[0]
    # One of them rounds the gear's corners, of up to 3 rad/s, over 6 ms: 3 * .006 / sqrt(2 pi) = 7 mrad where they lie,
    # of which the coupling's low-pass of .1 s leaves a fifth. A play left out would be 25 mrad off.
    assert np.abs(angle - table)[t > 2.0].max() < 1.5e-3


def test_a_gear_stands_behind_the_servo_s_lag():
    """The lagging motor turns the gear's horn: the clamp stands still while the horn crosses the play, which takes
    arccos(1 - play / A') / omega after each end of a swing A' of the motor's.
    """
    tau, play, omega = 0.05, 0.1, 2.0 * np.pi
    steps = Steps(0.0, STEP, round(4.0 / STEP))
    _, rate, _ = base_table(Sine(0.4, 1.0), steps, reduced(play=play, tau=tau))[:, :, 0]
    swing = 0.4 / np.hypot(1.0, omega * tau)
    share = np.mean(np.abs(rate[steps.middles > 2.0]) < 1e-2 * swing * omega)
    # The corners are rounded over 6 ms of the 100 ms or so that it stands still, twice a second.
    assert share == pytest.approx(2.0 * np.arccos(1.0 - play / swing) / omega, abs=0.04)

"""The MuJoCo arm as the emulated rig's plant: a process in step with the board's core through a pipe.

python -m rig.arm_plant FD_IN FD_OUT MODEL.toml [HIDDEN.json]: it reads (to_s, command_rad, armed) and answers with
angle, force, current and 24 midline points, as in firmware/host/plant.hpp. HIDDEN holds effects that the model's
declaration does not mention: {effect: {parameter: value}}.
"""

from __future__ import annotations

import json
import os
import signal
import struct
import sys
from pathlib import Path

import numpy as np

from mujoco_ref.midline import chain_midline_points
from mujoco_ref.simulate import make_stepper, rest_reading
from mujoco_ref.statics import chain_equilibrium
from rig.emulator import ARM_POINTS
from tentacle.io.model_file import read_model
from tentacle.model import Model
from tentacle.signals import Array

PLANT_STEP = 0.002  # s; half of mujoco_ref.simulate.LONGEST_STEP: a step of the command jerks the arm
PLANT_LINKS = 12
SERVO_PACE = 25.0  # 1/s: a critically damped position servo, as the built-in stand-in has it
SERVO_SPEED = 12.0  # rad/s, of a fast waterproof servo
_REQUEST, _ANSWER = struct.Struct("<3d"), struct.Struct(f"<{3 + 2 * ARM_POINTS}d")


class ServoMotion:
    """A critically damped second-order servo with a speed limit: angle, rate, acceleration (3,) over time."""

    def __init__(self) -> None:
        self.state = np.zeros(3)

    def advance(self, command: float, seconds: float) -> Array:
        """Moves on; exact for a constant command, but for the speed limit, which clips the rate."""
        angle, rate, _ = self.state
        error, decay = angle - command, np.exp(-SERVO_PACE * seconds)
        slope = rate + SERVO_PACE * error
        new_error = (error + slope * seconds) * decay
        new_rate = np.clip((rate - SERVO_PACE * slope * seconds) * decay, -SERVO_SPEED, SERVO_SPEED)
        if abs(new_rate) == SERVO_SPEED:
            new_error = error + new_rate * seconds
        acceleration = -2 * SERVO_PACE * new_rate - SERVO_PACE**2 * new_error
        self.state = np.array([command + new_error, new_rate, acceleration])
        return self.state.copy()


class ArmPlant:
    """The arm at rest, then moved by the servo. `advance` goes to a time; the readings are those of the last step."""

    def __init__(self, model: Model, hidden: dict[str, dict[str, float]]) -> None:
        self._stepper = make_stepper(model, hidden, links=PLANT_LINKS)
        self._state = chain_equilibrium(self._stepper, 0.0)
        self._tare = rest_reading(self._stepper, self._state)
        self._servo = ServoMotion()
        self._length = model.specimen.length
        self._first = True
        self.force = 0.0

    def advance(self, to_s: float, command: float, armed: bool) -> None:
        """Steps of STEP up to `to_s` [s]; an unarmed servo stays where it is."""
        while self._state.t + PLANT_STEP <= to_s + 1e-9:
            wanted = command if armed else float(self._servo.state[0])
            motor = np.stack(
                [self._servo.state.copy(), *(self._servo.advance(wanted, PLANT_STEP / 2) for _ in range(2))]
            )
            self._stepper.step(self._state, motor, PLANT_STEP, 4 if self._first else self._stepper.corrections)
            self._first = False
            self.force = float(-self._stepper.reading[3] - self._tare[1])

    @property
    def servo_angle(self) -> float:
        """Where the servo is [rad]."""
        return float(self._servo.state[0])

    def midline(self, s: Array) -> Array:
        """Points (N, 2) [m] of the arm in the base frame at s (N,), 0 at the base and 1 at the tip."""
        angles = self._stepper.chain.tangent_angles(self._state.q[None])
        return chain_midline_points(angles, self._state.q[None, :2], self._length, s)[0]

    def answer(self) -> bytes:
        """angle [rad], force on the load cell along +y less its reading at rest [N], current [mA], midline points
        [m].
        """
        points = self.midline(np.linspace(0, 1, ARM_POINTS))
        current = 30.0 + 20.0 * abs(self._servo.state[2]) / 10.0
        return _ANSWER.pack(self.servo_angle, self.force, current, *points.ravel().tolist())


def main(words: list[str]) -> int:
    """Answers until the pipe closes; on Ctrl-C the emulator closes it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    read_end, write_end = int(words[0]), int(words[1])
    hidden = json.loads(Path(words[3]).read_text()) if len(words) > 3 else {}
    plant = ArmPlant(read_model(Path(words[2])), hidden)
    plant.advance(PLANT_STEP, 0.0, True)  # the kernels compile before the board's clock starts
    while True:
        request = b""
        while len(request) < _REQUEST.size:
            data = os.read(read_end, _REQUEST.size - len(request))
            if not data:
                return 0
            request += data
        to_s, command, armed = _REQUEST.unpack(request)
        plant.advance(to_s, command, armed != 0)
        try:
            os.write(write_end, plant.answer())
        except BrokenPipeError:  # the board ended between its question and the answer
            return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

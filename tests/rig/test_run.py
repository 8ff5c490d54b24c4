"""Runs over a real pty: what the board did is what was asked, and what came back is whole."""

from __future__ import annotations

import time

import numpy as np
import pytest

from benchmarks._rig_scene import NEUTRAL_US, WAVE, gaps, once, played, to_neutral, wrong_samples
from rig import command_bodies
from rig.board import Board
from rig.emulator import Emulator
from rig.fault import Fault
from rig.play import arm_board
from rig.protocol import BoardEvent, EventCode, LoadSample, ServoSample, Type
from rig.safety import SafetyLimits, ServoCalibration


def test_a_run_is_whole_and_on_time(
    board: Board, emulator: Emulator, limits: SafetyLimits, servo: ServoCalibration
) -> None:
    arm_board(board, limits, servo)
    samples, start, end = played(board, 2.0)
    assert end.outcome == "complete"
    assert gaps(samples) == 0  # none lost, none doubled, in order
    servo_samples = [s for s in samples if isinstance(s, ServoSample)]
    t = np.array([1e-6 * (s.board_us - start.start_us) for s in servo_samples])
    command = np.array([1e-6 * s.command_urad for s in servo_samples])
    inside = (t > 0) & (t < 2.0)
    # Linear between points 20 ms apart: error up to (2 pi)^2 0.5 0.02^2 / 8 = 1e-3 rad.
    np.testing.assert_allclose(command[inside], WAVE(t[inside])[0], atol=1.1e-3)
    loads = [s.board_us for s in samples if isinstance(s, LoadSample)]
    assert np.median(np.diff(loads)) == pytest.approx(10700, abs=250)  # the emulator steps 250 us
    fit = board.clock.fit()
    now = time.monotonic()
    assert abs(fit.to_board(now) - emulator.truth().board_time(now)) < 1e-3
    assert to_neutral(emulator) < 0.5  # the host hears of the end before the servo is there
    assert emulator.truth().pulse_us == NEUTRAL_US


@pytest.mark.parametrize("percent", [1.0, 3.0])
def test_a_bad_line_costs_time_but_no_sample_and_no_truth(
    board: Board, emulator: Emulator, limits: SafetyLimits, servo: ServoCalibration, percent: float
) -> None:
    """So many of the bytes damaged, a third each corrupted, dropped, doubled: a run is whole, or it stops safely and
    says so; and what is accepted is what the board measured, however it ends.
    """
    share = 0.01 * percent / 3.0
    emulator.say("line", share, share, share)
    arm_board(board, limits, servo)
    samples, start, end = played(board, 2.0)
    emulator.say("line", 0.0, 0.0, 0.0)
    assert wrong_samples(samples, start, 2.0) == 0
    assert end.outcome == "complete" or end.words
    if end.outcome == "complete":
        assert gaps(samples) == board.counters.samples_lost == 0
        assert board.counters.host_bad_frames > 15 * percent  # 70 samples a second, 20 bytes and more each
        assert board.counters.retries > 0
    assert to_neutral(emulator) < 1.0


def test_unplugged_and_plugged_in_again(
    board: Board, emulator: Emulator, limits: SafetyLimits, servo: ServoCalibration
) -> None:
    arm_board(board, limits, servo)
    gone: list[float] = []

    def unplug() -> None:
        emulator.say("unplug")
        gone.append(to_neutral(emulator))
        emulator.say("replug")

    samples, _, end = played(board, 2.0, once(0.8, unplug))
    assert end.outcome == "watchdog" or "gone" in end.words
    assert gone[0] < 0.5
    assert gaps(samples) == 0  # the board kept what was missed
    assert any(isinstance(s, BoardEvent) and s.code == EventCode.WATCHDOG for s in samples)
    assert board.counters.reconnects == 1


def test_board_reset_in_a_run_is_said(
    board: Board, emulator: Emulator, limits: SafetyLimits, servo: ServoCalibration
) -> None:
    arm_board(board, limits, servo)
    _, _, end = played(board, 2.0, once(0.5, lambda: emulator.say("reset")))
    assert end.outcome == "board_reset"
    assert to_neutral(emulator) < 0.2  # it was armed again: not left limp


def test_jammed_servo_ends_the_run(
    board: Board, emulator: Emulator, limits: SafetyLimits, servo: ServoCalibration
) -> None:
    arm_board(board, limits, servo)
    _, _, end = played(board, 2.0, once(0.5, lambda: emulator.say("jam", 1)))
    assert end.outcome == "overcurrent"
    assert to_neutral(emulator) < 0.5
    emulator.say("jam", 0)
    _, _, again = played(board, 1.0)
    assert again.outcome == "overcurrent"  # latched: nothing moves before a deliberate new start
    assert emulator.truth().pulse_us == 0
    arm_board(board, limits, servo)
    _, _, after = played(board, 1.0)
    assert after.outcome == "complete"


def test_cell_faults_are_events_and_never_readings(
    board: Board, emulator: Emulator, limits: SafetyLimits, servo: ServoCalibration
) -> None:
    arm_board(board, limits, servo)
    samples, _, end = played(board, 3.0, once(0.5, lambda: emulator.say("cell_glitch")))
    assert end.outcome == "complete"
    codes = [s.code for s in samples if isinstance(s, BoardEvent)]
    assert EventCode.CELL_ERROR in codes
    assert EventCode.CELL_GOOD in codes
    assert all(abs(s.counts - 52000) < 20000 for s in samples if isinstance(s, LoadSample))


def test_silent_board_is_no_answer(
    board: Board, emulator: Emulator, limits: SafetyLimits, servo: ServoCalibration
) -> None:
    arm_board(board, limits, servo)
    emulator.say("mute", 20.0)
    with pytest.raises(Fault) as caught:
        board.command(Type.STREAM, command_bodies.stream(True))
    assert caught.value.kind == "no_answer"


def test_points_beyond_the_limits_are_refused_by_the_board_too(
    board: Board, limits: SafetyLimits, servo: ServoCalibration
) -> None:
    arm_board(board, limits, servo)
    board.command(Type.CLEAR)
    with pytest.raises(Fault, match="outside limits"):
        board.command(Type.POINTS, command_bodies.points(0, [0, 900_000]))
    with pytest.raises(Fault, match="bad limits"):
        board.command(Type.LIMITS, command_bodies.limits(-800_000, 800_000, 8_000_000, 900, 2000, 637))

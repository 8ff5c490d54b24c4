"""A run on the board: set points streamed ahead of time, samples passed on at once, and the end of the run."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from rig import command_bodies
from rig.board import Board
from rig.fault import Fault, FaultKind, RunEnd
from rig.interrupts import Interrupts
from rig.protocol import BoardEvent, BoardState, EventCode, Sample, Type
from rig.safety import SERVO_FRAME, SafetyLimits, ServoCalibration, check_limits, check_set_points, limits_message
from rig.upload import QUEUED_AHEAD, Upload
from tentacle.signals import Array

LONGEST_AHEAD = 2.0  # s
RECONNECT_WITHIN = 5.0  # s
OVERDUE = 5.0  # s after which a run without an end message is given up
_ENDS: dict[int, FaultKind] = {
    EventCode.UNDERRUN: "underrun",
    EventCode.WATCHDOG: "watchdog",
    EventCode.OVERCURRENT: "overcurrent",
}


@dataclass(frozen=True)
class PlayStart:
    """The board has taken the run: start_us is the board time [us] of set point 0, a moment ahead."""

    start_us: int


@dataclass(frozen=True)
class PlayEnd:
    """The end of a run: outcome "complete", "interrupted" or a Fault's kind; start_us, board time of set point 0."""

    outcome: RunEnd
    words: str
    start_us: int


def arm_board(board: Board, limits: SafetyLimits, servo: ServoCalibration) -> None:
    """Hands the limits to the board and waits until it is ready at neutral.

    A latch of an earlier fault is cleared, because a person has started the program again.
    """
    assert board.boot is not None
    check_limits(limits, servo, board.boot)
    board.limits = limits_message(limits, servo)
    board.command(Type.CLEAR)
    board.command(Type.LIMITS, board.limits)
    until = time.monotonic() + 3.0
    while board.state != BoardState.READY:
        board.service()
        if time.monotonic() > until:
            raise Fault("no_answer", f"the board did not reach neutral after it was armed (it is {board.state.name})")
    board.command(Type.STREAM, command_bodies.stream(True))


def require_unlatched(board: Board) -> None:
    """Fault("overcurrent") where the board has switched the servo off: a new start of the program arms it again."""
    if board.state == BoardState.LATCHED:
        raise Fault("overcurrent", "the board has switched the servo off: look at the arm, then start again")


def play(
    board: Board,
    points: Array,
    limits: SafetyLimits,
    *,
    period: float = SERVO_FRAME,
    interrupts: Interrupts | None = None,
) -> Iterator[Sequence[Sample] | PlayStart | PlayEnd]:
    """Plays set points (N,) [rad], one every `period` [s], on an armed board.

    Yields a PlayStart, batches of samples in order as they come, and a PlayEnd at last. A fault of the rig raises
    nothing: it is the PlayEnd's outcome, after the remaining samples of the board were yielded. The arm ends at
    neutral.
    """
    check_set_points(points, period, limits)
    urad = np.round(1e6 * points).astype(int).tolist()
    start_us = 0
    try:
        upload, asked_us, start_us = _begin(board, urad, period)
        latest = board.time.now() + len(urad) * period + _ahead(board) + OVERDUE * board.time.rate
        yield PlayStart(start_us)
        stopping = False
        while True:
            board.service()
            if board.time.now() > latest:
                raise Fault("no_answer", "the board has not said that the run has ended")
            batch = board.take()
            if batch:
                yield batch
            end = _end_of(batch, asked_us, start_us, stopping)
            if end is not None:
                break
            if interrupts is not None and interrupts.stop_now and not stopping:
                board.command(Type.NEUTRAL)
                stopping = True
            if not stopping:
                upload.service()
    except Fault as fault:
        end = yield from _after(board, fault, start_us)
    else:
        yield from _rest(board)
    yield end


def _begin(board: Board, urad: list[int], period: float) -> tuple[Upload, int, int]:
    """The upload, and board times [us]: that before which all belongs to an earlier run, and that of set point 0."""
    require_unlatched(board)
    board.command(Type.CLEAR)
    upload = Upload(board, urad)
    while upload.arrived < min(QUEUED_AHEAD, len(urad)):
        upload.service()
        board.service(0.002)
    ahead = _ahead(board)
    while True:
        clock = board.synchronise()
        asked = clock.to_board(board.time.now())
        start_us = round(1e6 * (asked + ahead))
        try:
            board.command(Type.START, command_bodies.start(start_us, round(1e6 * period), len(urad)))
        except Fault as fault:
            late = 1e6 * clock.to_board(board.time.now()) > start_us
            if fault.kind != "refused" or not late or ahead > LONGEST_AHEAD:
                raise
            ahead *= 2  # the command arrived after its start time: a busy computer, or a bad line
            continue
        return upload, round(1e6 * asked) - 50_000, start_us


def _ahead(board: Board) -> float:
    """How long after START the run begins [s]: the command must arrive before it."""
    return 0.3 * max(1.0, board.time.rate)


def _end_of(batch: Sequence[Sample], asked_us: int, start_us: int, stopping: bool) -> PlayEnd | None:
    for sample in batch:
        if not isinstance(sample, BoardEvent) or sample.board_us < asked_us:
            continue
        if sample.code == EventCode.COMPLETE:
            return PlayEnd("complete", "", start_us)
        if sample.code == EventCode.STOPPED and stopping:
            return PlayEnd("interrupted", "stopped by hand", start_us)
        if sample.code in _ENDS:
            words = f"the board ended the run: {EventCode(sample.code).name} ({sample.value})"
            return PlayEnd(_ENDS[sample.code], words, start_us)
    return None


def _after(board: Board, fault: Fault, start_us: int) -> Iterator[Sequence[Sample]]:  # and returns a PlayEnd
    if fault.kind == "link_lost":
        try:
            board.reconnect(RECONNECT_WITHIN)
            yield from _rest(board)
        except Fault as second:
            fault = Fault(second.kind, f"{fault}; then {second}")
    elif fault.kind != "board_reset":
        with suppress(Fault):  # a board that cannot be reached goes to neutral by its watchdog
            board.command(Type.NEUTRAL)
    batch = board.take()
    if batch:
        yield batch
    if fault.kind == "board_reset":
        _rearm(board)
    return PlayEnd(fault.kind, str(fault), start_us)


def _rearm(board: Board) -> None:
    """After a restart the board leaves the servo off. Greet and arm it again, so that it holds neutral."""
    try:
        board.connect()
        board.command(Type.LIMITS, board.limits)
        board.command(Type.STREAM, command_bodies.stream(True))
    except Fault:
        pass  # the servo stays off, which is safe; the run's outcome is still the reset


def _rest(board: Board) -> Iterator[Sequence[Sample]]:
    board.catch_up()
    batch = board.take()
    if batch:
        yield batch

"""The upload of set points to the board: several POINTS at once, each sent again until it is acknowledged."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from rig import command_bodies, protocol
from rig.board import BACK_OFF, LONGEST_WAIT, MOST_TRIES, Board
from rig.fault import Fault
from rig.protocol import Type

QUEUED_AHEAD = 150  # set points kept on the board: 3 s at 50 Hz; it holds 2048
BYTES_UNDER_WAY = 256  # unacknowledged bytes, at most: 22 ms of the line, because samples and pings share it
SHORT = 4  # points a frame on a bad line: of 4 k + 13 bytes, (1 - b)^(4 k + 13) get through; at b = 3 % four are best


@dataclass
class _Chunk:
    """Set points `index` to `index + len(urad)`, sent `tries` times, last at `sent` [s] as command `number`."""

    index: int
    urad: Sequence[int]
    number: int = 0
    tries: int = 0
    sent: float = 0.0

    @property
    def body(self) -> bytes:
        return command_bodies.points(self.index, self.urad)


class Upload:
    """Streams set points [urad] to a board whose queue was just cleared, AHEAD of what is played.

    The board takes points in any order, so a lost frame delays only its own. `service` must be called often.
    """

    def __init__(self, board: Board, urad: Sequence[int]) -> None:
        self._board, self._urad = board, urad
        self._earlier = board.pong  # says what was played before the queue was cleared
        self._next = 0
        self._flying: list[_Chunk] = []

    @property
    def arrived(self) -> int:
        """Number of set points, from the first one, that are acknowledged."""
        return self._flying[0].index if self._flying else self._next

    def service(self) -> None:
        """Sends what is due.

        Fault("refused") with the board's reason; Fault("no_answer") where one chunk was sent MAX_TRIES times.
        """
        self._flying = [chunk for chunk in self._flying if not self._board.accepted(chunk.number, Type.POINTS)]
        now = time.monotonic()
        under_way = sum(len(chunk.body) for chunk in self._flying)
        within = self._board.answer_time(under_way)
        for chunk in self._flying:
            if now - chunk.sent >= min(within * BACK_OFF ** (chunk.tries - 1), max(within, LONGEST_WAIT)):
                self._send(chunk, now)
        size = protocol.MAX_POINTS if self._board.line_is_good else SHORT
        pong = self._board.pong
        played = pong.played if pong is not None and pong is not self._earlier else 0
        until = min(len(self._urad), played + QUEUED_AHEAD)
        while self._next < until and under_way < BYTES_UNDER_WAY:
            chunk = _Chunk(self._next, self._urad[self._next : min(self._next + size, until)])
            self._next += len(chunk.urad)
            self._flying.append(chunk)
            self._send(chunk, now)
            under_way += len(chunk.body)

    def _send(self, chunk: _Chunk, now: float) -> None:
        if chunk.tries == MOST_TRIES:
            raise Fault("no_answer", f"the board did not answer POINTS in {MOST_TRIES} tries")
        chunk.number = self._board.post(Type.POINTS, chunk.body, again=chunk.number if chunk.tries else None)
        chunk.tries += 1
        chunk.sent = now

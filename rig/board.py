"""The board, seen from the host: commands with bounded retries, samples in order, the clock, and recovery after a loss.
One thread does all of it: the host sends pings while `service` is called. If the host hangs it is silent, and the
board's watchdog takes the arm to neutral. This is intended.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

from rig import command_bodies, protocol
from rig.clock import ClockEstimator, ClockFit
from rig.fault import Fault
from rig.host_time import HostTime
from rig.line_counters import LineCounters
from rig.link import BAUD, Link
from rig.protocol import (
    BoardEvent,
    BoardState,
    Boot,
    CommandAnswer,
    Gone,
    LoadSample,
    Pong,
    Reason,
    Sample,
    ServoSample,
    Type,
    WireFrame,
    reason_words,
)
from rig.sequence import SampleSequence

SLOWEST_BOARD = 0.01  # s to answer a command, beside the line's own time
MOST_TRIES = 40
BACK_OFF, LONGEST_WAIT = 1.15, 0.08  # s, longest wait of one try; each try waits longer than the last, 2.5 s in all
PING_EVERY = 0.05  # s; five within the board's watchdog
PING_EVERY_BAD_LINE = 0.02  # s; with 3 % of damaged bytes five pings are all lost once in 350 times, twelve never
CLEAN_LINE = 3  # largest number of damaged frames and retries on a good line
LONGEST_NEGLECT = 2.0  # s; the board holds its samples for 7 s, at an emulator's double rate for half as long
BOOT_WITHIN = 6.0  # s; a Due that is opened resets and starts within 2 s


class Board:
    """A connected board. `service` receives; `take` hands over the samples that have come in order."""

    def __init__(self, link: Link, host_time: HostTime | None = None) -> None:
        self.link = link
        self.time = host_time or HostTime()
        self.clock = ClockEstimator()
        self.boot: Boot | None = None
        self.pong: Pong | None = None
        self.limits = b""  # the body of LIMITS with which it was armed last
        self._counters = LineCounters()
        self._sequence = SampleSequence()
        self._inbox: list[Sample] = []
        self._answers: dict[int, CommandAnswer] = {}  # by the command's number
        self._board_bad_before: int | None = None
        self._command_number = 0
        self._ping_token = 0
        self._pings: dict[int, float] = {}
        self._pinged_at = -1e9
        self._serviced_at = time.monotonic()
        self._reset = False

    # ---- connecting ----

    def connect(self) -> Boot:
        """Opens the link and greets the board; Fault("no_answer") or Fault("wrong_version")."""
        self.link.open()
        self.boot, self._reset = None, False
        self.clock = ClockEstimator()
        until = time.monotonic() + BOOT_WITHIN
        while self.boot is None and time.monotonic() < until:
            number = self._numbered()
            self.link.send(WireFrame(Type.HELLO, number, command_bodies.hello()))
            self._listen_until(lambda number=number: self.boot is not None or number in self._answers, 0.15)
            answer = self._answers.get(number)
            if answer is not None and answer.reason == Reason.BAD_VERSION:
                raise Fault("wrong_version", f"the board does not speak version {protocol.VERSION}: flash rig/firmware")
        if self.boot is None:
            raise Fault("no_answer", f"{self.link.url}: no board answered within {BOOT_WITHIN:g} s")
        if self.boot.version != protocol.VERSION:
            raise Fault("wrong_version", f"the board speaks version {self.boot.version}, not {protocol.VERSION}")
        self._sequence = SampleSequence(self.boot.next_sample)
        self._inbox.clear()
        return self.boot

    def reconnect(self, within: float) -> None:
        """After a lost link: opens it again and asks for what was missed.

        Fault("link_lost") when it stays away for `within` real seconds; Fault("board_reset") when another boot answers.
        """
        until = time.monotonic() + within
        while True:
            try:
                self.link.open()
                self._reset = False
                self._pings.clear()
                self.pong = None
                self._pinged_at = -1e9
                self._listen_until(lambda: self.pong is not None, 0.5)
                if self.pong is not None:
                    break
            except Fault as fault:
                if fault.kind != "link_lost":
                    raise
                time.sleep(0.05)
            if time.monotonic() > until:
                raise Fault("link_lost", f"{self.link.url} did not come back within {within:g} s")
        self._counters = replace(self._counters, reconnects=self._counters.reconnects + 1)

    def close(self) -> None:
        """Sends the arm to neutral if the link still works, and closes it."""
        if self.link.is_open:
            try:
                self.command(Type.NEUTRAL)
                self.command(Type.STREAM, command_bodies.stream(False))
            except Fault:
                pass  # the board's watchdog does it
            self.link.close()

    # ---- talking ----

    def command(self, kind: Type, body: bytes = b"") -> None:
        """Sends a command until it is answered; Fault("refused") with the reason, or Fault("no_answer")."""
        number = self.post(kind, body)
        within = self.answer_time(len(body))
        for attempt in range(MOST_TRIES):
            if attempt:
                self.post(kind, body, again=number)
                within = max(min(within * BACK_OFF, LONGEST_WAIT), self.answer_time(len(body)))
            self._listen_until(lambda: number in self._answers, within)
            if self.accepted(number, kind):
                return
        raise Fault("no_answer", f"the board did not answer {kind.name} in {MOST_TRIES} tries")

    def post(self, kind: Type, body: bytes = b"", *, again: int | None = None) -> int:
        """Sends a command once without waiting for its answer. Returns its number, which is `again` if that
        is given.
        """
        number = self._numbered() if again is None else again
        counted = self._counters
        if again is None:
            self._counters = replace(counted, commands=counted.commands + 1)
        else:
            self._counters = replace(counted, retries=counted.retries + 1)
        self.link.send(WireFrame(kind, number, body))
        return number

    def accepted(self, number: int, kind: Type) -> bool:
        """Whether the command that was posted with this number was carried out; Fault("refused") with the reason."""
        answer = self._answers.get(number)
        if answer is None or answer.type != kind:
            return False
        if answer.reason:
            raise Fault("refused", f"the board refused {kind.name}: {reason_words(answer.reason)}")
        return True

    def answer_time(self, size: int) -> float:
        """Real seconds within which a command with so many bytes under way is answered on a good line."""
        return SLOWEST_BOARD + 2 * (size + 20) * 10 / BAUD + 4 * self.clock.quickest

    @property
    def neglected(self) -> bool:
        """Whether it was not served for so long that its messages are lost: it must be greeted again."""
        return time.monotonic() - self._serviced_at > LONGEST_NEGLECT

    @property
    def line_is_good(self) -> bool:
        """Whether there were enough messages over the line, with hardly any repetition."""
        counters = self.counters
        bad = counters.host_bad_frames + counters.board_bad_frames + counters.retries
        return counters.commands > 20 and bad <= CLEAN_LINE

    def service(self, wait: float = 0.005) -> None:
        """Receives for at most `wait` real seconds, pings when due, asks for missing samples.

        Fault("board_reset") once after the board has started anew; Fault("link_lost") when the port is gone.
        """
        self._serviced_at = time.monotonic()
        now = self.time.now()
        if now - self._pinged_at >= (
            PING_EVERY if self.link.bad_frames + self._board_bad_frames <= CLEAN_LINE else PING_EVERY_BAD_LINE
        ):
            self._ping(now)
        for frame in self.link.receive(wait):
            self._dispatch(frame)
        if self._reset:
            self._reset = False
            raise Fault("board_reset", "the board started anew (power or reset button?)")
        now = self.time.now()
        for request in self._sequence.requests(now):
            self.link.send(WireFrame(Type.RESEND, 0, command_bodies.resend(*request)))
        self._inbox += self._sequence.give_up()

    def take(self) -> list[Sample]:
        """The samples received since the last call, in order, each once."""
        samples, self._inbox = self._inbox, []
        return samples

    def synchronise(self, trips: int = 10) -> ClockFit:
        """The clock after at least so many round trips; Fault("no_answer") where they do not come."""
        until = time.monotonic() + 5.0
        while len(self.clock) < trips and time.monotonic() < until:
            if self.time.now() - self._pinged_at >= 0.01 * self.time.rate:
                self._ping(self.time.now())
            self.service(0.005)
        if len(self.clock) < trips:
            raise Fault("no_answer", f"only {len(self.clock)} of {trips} pings were answered")
        return self.clock.fit()

    def catch_up(self, within: float = 1.0) -> None:
        """Waits until every sample of the board has arrived or is given up; at most `within` real seconds."""
        until = time.monotonic() + within
        before = self.pong
        self._pinged_at = -1e9
        while time.monotonic() < until and (self.pong is before or self._sequence.missing):
            self.service(0.005)

    @property
    def state(self) -> BoardState:
        """The board's state at the last pong."""
        if self.pong is None:
            return BoardState.UNARMED
        return BoardState(self.pong.state) if self.pong.state in set(BoardState) else BoardState.UNKNOWN

    @property
    def counters(self) -> LineCounters:
        """The line's cost so far."""
        sequence = self._sequence
        return replace(
            self._counters,
            host_bad_frames=self.link.bad_frames,
            board_bad_frames=self._board_bad_frames,
            samples_doubled=sequence.doubled,
            samples_asked_again=sequence.asked,
            samples_lost=sequence.lost,
        )

    # ---- inside ----

    @property
    def _board_bad_frames(self) -> int:
        """Number of damaged frames at the board since the first contact; the board counts from its start."""
        if self.pong is None or self._board_bad_before is None:
            return 0
        return self.pong.bad_frames - self._board_bad_before

    def _numbered(self) -> int:
        """The number of a new command; 255 later ones keep theirs apart."""
        self._command_number = (self._command_number + 1) & 0xFF
        self._answers.pop(self._command_number, None)
        return self._command_number

    def _listen_until(self, done: Callable[[], bool], seconds: float) -> None:
        until = time.monotonic() + seconds
        while not done() and time.monotonic() < until:
            self.service(0.002)

    def _ping(self, now: float) -> None:
        self._ping_token = (self._ping_token + 1) & 0xFFFFFFFF
        self._pinged_at = now
        self._pings[self._ping_token] = now
        while len(self._pings) > 100:
            del self._pings[min(self._pings)]
        self.link.send(WireFrame(Type.PING, 0, command_bodies.ping(self._ping_token)))

    def _dispatch(self, frame: WireFrame) -> None:
        message = protocol.decode(frame)
        match message:
            case CommandAnswer():
                self._answers[message.sequence] = message
            case Pong():
                self._heard_pong(message)
            case LoadSample() | ServoSample() | BoardEvent():
                if self.boot is not None:
                    self._inbox += self._sequence.add(message, self.time.now())
            case Boot():
                if self.boot is not None and message.boot_id != self.boot.boot_id:
                    self._reset = True
                self.boot = message
            case Gone():
                self._inbox += self._sequence.give_up((message.first, message.count))
            case None:
                pass

    def _heard_pong(self, pong: Pong) -> None:
        sent = self._pings.pop(pong.token, None)
        if sent is None or self.boot is None:
            return
        if pong.boot_id != self.boot.boot_id:
            self._reset = True
            return
        self.clock.add(sent, self.time.now(), 1e-6 * pong.board_us)
        self.pong = pong
        if self._board_bad_before is None:
            self._board_bad_before = pong.bad_frames
        self._sequence.expect(pong.next_sample, self.time.now())

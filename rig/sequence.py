"""Puts the board's numbered samples in order: removes duplicates, requests missing ones again, counts lost ones."""

from __future__ import annotations

from dataclasses import dataclass, field

from rig.protocol import Sample

ASK_AFTER = 0.02  # s; frames keep their order on the line, so a number without its predecessor shows a loss
ASK_AGAIN = 0.04  # s
MOST_RESENDS = 60  # 2.4 s of asking; the board holds its samples for 7 s
MAX_ASKED = 16  # samples in one request
MAX_REQUESTS = 6  # at once
FARTHEST_NUMBER = 4096  # largest plausible jump of the number; the board holds 1024


@dataclass
class SampleSequence:
    """next_number: the number that the next delivered sample must have. Counters: doubled, asked, lost.

    lost_numbers: what was given up, as half-open ranges.
    """

    next_number: int = 0
    doubled: int = 0
    asked: int = 0
    lost: int = 0
    lost_numbers: list[tuple[int, int]] = field(default_factory=list)
    _waiting: dict[int, Sample] = field(default_factory=dict)
    _missing: dict[int, tuple[int, float]] = field(default_factory=dict)  # number: tries, when it was last asked for
    _known_end: int | None = None

    def add(self, sample: Sample, now: float) -> list[Sample]:
        """The samples that are now in order, oldest first; `now` is host time [s]."""
        if sample.number < self.next_number or sample.number in self._waiting:
            self.doubled += 1
            return []
        if sample.number > self.next_number + FARTHEST_NUMBER:
            return []
        self.expect(sample.number + 1, now)
        self._missing.pop(sample.number, None)
        self._waiting[sample.number] = sample
        return self._in_order()

    def expect(self, end: int, now: float) -> None:
        """The board has sent all numbers below `end` (stated by a pong): those not here yet are missing."""
        known = self.next_number if self._known_end is None else self._known_end
        if known < end <= self.next_number + FARTHEST_NUMBER:
            for number in range(known, end):
                self._missing[number] = (0, now + ASK_AFTER - ASK_AGAIN)
            self._known_end = end

    @property
    def missing(self) -> int:
        """How many numbers below the highest known have not come."""
        return len(self._missing)

    def requests(self, now: float) -> list[tuple[int, int]]:
        """(first, count) of samples to ask for at host time `now` [s]; neighbours are asked for together."""
        found: list[list[int]] = []
        for number in sorted(n for n, (tries, asked) in self._missing.items() if now - asked >= ASK_AGAIN):
            if found and sum(found[-1]) == number and found[-1][1] < MAX_ASKED:
                found[-1][1] += 1
            elif len(found) < MAX_REQUESTS:
                found.append([number, 1])
            else:
                break
        for first, count in found:
            for number in range(first, first + count):
                self._missing[number] = (self._missing[number][0] + 1, now)
            self.asked += count
        return [(first, count) for first, count in found]

    def give_up(self, gone: tuple[int, int] = (0, 0)) -> list[Sample]:
        """Counts as lost: samples requested too often, and samples that the board no longer has (first, count). Returns
        the samples that are then in order.
        """
        hopeless = [n for n, (tries, _) in self._missing.items() if tries >= MOST_RESENDS]
        hopeless += [n for n in range(gone[0], gone[0] + gone[1]) if n in self._missing]
        for number in sorted(set(hopeless)):
            del self._missing[number]
            self.lost += 1
            if self.lost_numbers and self.lost_numbers[-1][1] == number:
                self.lost_numbers[-1] = (self.lost_numbers[-1][0], number + 1)
            else:
                self.lost_numbers.append((number, number + 1))
        return self._in_order() if hopeless else []

    def _in_order(self) -> list[Sample]:
        delivered = []
        end = self.next_number if self._known_end is None else self._known_end
        while self.next_number < end and self.next_number not in self._missing:
            sample = self._waiting.pop(self.next_number, None)  # None: it was lost
            if sample is not None:
                delivered.append(sample)
            self.next_number += 1
        return delivered

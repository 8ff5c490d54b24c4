"""Samples come in order, each once, whatever the line does to them."""

from __future__ import annotations

import random

from rig.protocol import LoadSample
from rig.sequence import ASK_AFTER, ASK_AGAIN, MOST_RESENDS, SampleSequence


def sample(number: int) -> LoadSample:
    return LoadSample(number, 1000 * number, number)


def test_a_line_that_loses_doubles_and_is_asked_again_gives_every_sample_once() -> None:
    source = random.Random(1)
    sequence, got, now = SampleSequence(10), [], 0.0
    for number in range(10, 1010):
        now += 0.007
        arriving = [number] * source.choice([0, 1, 1, 1, 2])
        for first, count in sequence.requests(now):
            arriving += [n for n in range(first, first + count) if source.random() < 0.5]
        for n in arriving:
            got += sequence.add(sample(n), now)
    sequence.expect(1010, now)
    while sequence.missing:
        now += ASK_AGAIN + 1e-6
        for first, count in sequence.requests(now):
            for n in range(first, first + count):
                got += sequence.add(sample(n), now) if source.random() < 0.5 else []
    assert [s.number for s in got] == list(range(10, 1010))
    assert sequence.lost == 0
    assert sequence.doubled > 0


def test_what_never_comes_is_counted_and_does_not_hold_up_the_rest() -> None:
    sequence = SampleSequence(0)
    assert [s.number for s in sequence.add(sample(0), 0.0)] == [0]
    assert sequence.add(sample(3), 0.0) == []
    now = ASK_AFTER + 1e-6
    for _ in range(MOST_RESENDS):
        assert sequence.requests(now) == [(1, 2)]
        assert sequence.requests(now + 0.5 * ASK_AGAIN) == []
        now += ASK_AGAIN + 1e-6
    assert [s.number for s in sequence.give_up()] == [3]
    assert (sequence.lost, sequence.lost_numbers) == (2, [(1, 3)])


def test_what_the_board_no_longer_holds_is_lost_at_once() -> None:
    sequence = SampleSequence(0)
    sequence.add(sample(5), 0.0)
    assert [s.number for s in sequence.give_up(gone=(0, 5))] == [5]
    assert sequence.lost == 5

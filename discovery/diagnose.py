"""Closing the loop, from recordings to a diagnosis (docs/loop.md)."""

from __future__ import annotations

from collections.abc import Sequence

from threadpoolctl import threadpool_limits

from discovery.answer import cannot_tell
from discovery.given import Deciding, Given
from discovery.loop import close_loop
from inference.one_arm import same_arm
from inference.prepare import CannotTellError
from tentacle.diagnosis import Diagnosis
from tentacle.errors import InputError
from tentacle.progress import Stage, silent
from tentacle.recording import Recording

AS_USUAL = Deciding()


def diagnose(
    recordings: Sequence[Recording],
    baseline: Sequence[Recording] = (),
    held_out: Sequence[Recording] = (),
    *,
    seed: int = 0,
    deciding: Deciding = AS_USUAL,
    progress: Stage = silent,
) -> Diagnosis:
    """Find what the declared model lacks, and the error before and after it is added.

    baseline: recordings with a complete declaration. No absent effect acts in them, and they share the arm's parameters
    with the others. held_out: recordings that only judge. Without any, a third of each recording judges.
    Raises InputError on unusable input. Linear algebra runs on one thread: its matrices are small, and the last digits
    of its sums would depend on the number of threads.
    """
    if not recordings:
        raise InputError("no recording", expected="at least one")
    given = Given(recordings, baseline, held_out)
    same_arm(given.all)
    try:
        with threadpool_limits(1, user_api="blas"):
            return close_loop(given, seed, deciding, progress)
    except CannotTellError as reason:
        return cannot_tell(recordings[0], str(reason), seed)

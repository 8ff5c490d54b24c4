"""Progress of a verb on standard error: the stage that runs, the share done, the time taken.

A terminal gets a bar. With TENTACLE_PROGRESS=lines each step is a line "share, tab, stage" for a program that started
the verb (`tentacle app`). Otherwise nothing is printed.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from tentacle.cli._output import remark
from tentacle.errors import printable
from tentacle.progress import Stage

LINES = "TENTACLE_PROGRESS"  # environment variable
# A stage's first words, and how long it takes beside the others on a usual computer: for the bar, nothing else.
DIAGNOSING = (
    ("reading shapes", 1.0),
    ("compiling", 10.0),
    ("fitting the baseline", 4.0),
    ("fitting the declared model", 6.0),
    ("running the reference", 4.0),
    ("searching", 20.0),
    ("comparing", 2.0),
    ("writing", 3.0),
)
IDENTIFYING = (("compiling", 10.0), ("fitting", 10.0), ("writing", 2.0))
READING, TRACKING = 1.0, 15.0
Plan = Sequence[tuple[str, float]]


def reading_plan(paths: Sequence[object]) -> list[tuple[str, float]]:
    """The stages of reading and tracking each recording."""
    kinds = (("reading", READING), ("tracking", TRACKING))
    return [(f"{kind} {path}", weight) for path in paths for kind, weight in kinds]


def share_done(plan: Plan, words: str, done: float) -> float | None:
    """The share of all stages that is done, 0 to 1; None for words that the plan does not have."""
    before = 0.0
    for beginning, weight in plan:
        if words.startswith(beginning):
            return (before + weight * min(max(done, 0.0), 1.0)) / sum(weight for _, weight in plan)
        before += weight
    return None


@contextmanager
def stages(plan: Plan = ()) -> Iterator[Stage]:
    """A function that names the stage that begins. With a plan, a bar shows the share done; it never goes back."""
    if os.environ.get(LINES) == "lines":
        yield _told(plan, lambda share, words: remark(words, f"{share:.3f}\t"))
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    bar = (BarColumn(bar_width=24),) if plan else ()
    columns = (SpinnerColumn(), *bar, TimeElapsedColumn(), TextColumn("{task.description}", markup=False))
    with Progress(*columns, console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task("starting", total=1.0 if plan else None)
        yield _told(plan, lambda share, words: progress.update(task, completed=share, description=printable(words)))


def _told(plan: Plan, tell: Callable[[float, str], None]) -> Stage:
    furthest = 0.0

    def stage(words: str, done: float = 0.0) -> None:
        nonlocal furthest
        share = share_done(plan, words, done)
        furthest = furthest if share is None else max(furthest, share)
        tell(furthest, words)

    return stage

"""The output of a running rig: lines, a bar on standard error, and on request a Rerun viewer."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tentacle.cli._output import remark

if TYPE_CHECKING:
    from viz.blueprints.rig import LivePaths

VIEWER_PORT = 9876


def tell(words: str) -> None:
    """A line on standard error."""
    remark(words, "\n")


@contextmanager
def rig_progress_bar() -> Iterator[Callable[[str, float], None]]:
    """A bar that is told the phase and the share done."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    console, words = Console(stderr=True), TextColumn("{task.description}", markup=False)
    columns = (words, BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("connecting", total=1.0)
        yield lambda phase, share: bar.update(task, description=phase, completed=share)


@dataclass
class LiveView:
    """address: of the viewer, None where there is none; kept: whether it stays when the command ends."""

    address: str | None = None
    kept: bool = False


@contextmanager
def viewer(wanted: bool, *, camera: bool) -> Iterator[LiveView]:
    """A Rerun viewer on this machine only, for the duration of the run.

    A viewer that was started here ends here, unless `kept` is set, so that nothing listens after a signal or a fault.
    """
    if not wanted:
        yield LiveView()
        return
    from rig import live_feed
    from tentacle.cli._live_viewer import start_viewer
    from viz.blueprints.rig import send_live_layout
    from viz.viewer import end_group

    process = start_viewer(VIEWER_PORT)
    address = f"rerun+http://127.0.0.1:{VIEWER_PORT}/proxy"
    shown = LiveView(address)
    try:
        send_live_layout(address, live_feed.RIG_APPLICATION, live_paths(camera=camera))
        yield shown
    finally:
        if process is not None and not shown.kept:
            end_group(process)


def live_paths(*, camera: bool) -> LivePaths:
    """The entity paths of the live feed."""
    from rig import live_feed, run_layout
    from viz.blueprints.rig import LivePaths

    return LivePaths(
        run_layout.COMMAND,
        run_layout.ANGLE,
        run_layout.CURRENT,
        run_layout.THRUST,
        run_layout.EVENTS,
        live_feed.BOARD_TIME,
        live_feed.PREVIEW if camera else None,
    )

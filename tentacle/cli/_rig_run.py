"""Bodies of `tentacle rig`: record, optimise, campaign."""

from __future__ import annotations

import argparse
import contextlib
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from tentacle.errors import InputError

if TYPE_CHECKING:
    from viz.blueprints.rig import LivePaths

VIEWER_PORT = 9876


def record(arguments: argparse.Namespace) -> int:
    """One run; exit code 3 where it did not complete, 130 where it was stopped by hand."""
    from rig import record as rig_record
    from rig.connection import connected, opened_camera
    from rig.interrupts import Interrupts
    from rig.motion import described, motion_of
    from rig.setup_file import read_setup
    from tentacle.io.waveform_file import read_waveform

    setup = read_setup(arguments.rig)
    waveform = read_waveform(arguments.waveform)
    motion = motion_of(waveform, arguments.seconds, setup.limits, described(waveform))
    if arguments.out.suffix != ".rrd":
        raise InputError("not an .rrd name", file=arguments.out, field="--out", expected="FILE.rrd")
    with (
        _viewer(arguments.view, camera=setup.camera is not None) as viewer,
        connected(setup) as board,
        opened_camera(setup, board.time) as camera,
        _progress() as progress,
        Interrupts(_say) as interrupts,
    ):
        result = rig_record.record(
            setup, board, camera, motion, arguments.out,
            name=arguments.out.stem, interrupts=interrupts, viewer=viewer, progress=progress,
        )  # fmt: skip
    print(f"{result.outcome}: {result.samples} samples, {result.lost} lost, wrote {result.path}")
    if result.words:
        print(result.words)
    return {"complete": 0, "interrupted": 130}.get(result.outcome, 3)


def campaign(arguments: argparse.Namespace) -> int:
    """All runs that are not complete yet."""
    from rig.campaign import read_campaign, run_campaign
    from rig.connection import connected, opened_camera
    from rig.interrupts import Interrupts
    from rig.setup_file import read_setup

    setup = read_setup(arguments.rig)
    runs = read_campaign(arguments.campaign, setup)
    with (
        connected(setup) as board,
        opened_camera(setup, board.time) as camera,
        _progress() as progress,
        Interrupts(_say) as interrupts,
    ):
        for result in run_campaign(setup, board, camera, runs, arguments.out, interrupts=interrupts, progress=progress):
            print(f"{result.path.name}: {result.outcome}, {result.samples} samples, {result.lost} lost")
        paused = interrupts.pause
    print(
        f"paused; the same command goes on: {arguments.out}" if paused else f"{len(runs.runs)} runs in {arguments.out}"
    )
    return 130 if paused else 0


def optimise(arguments: argparse.Namespace) -> int:
    """Trials until there are enough; the best gait as a waveform file beside them."""
    from rig.connection import connected, opened_camera
    from rig.gait_space import GaitSpace, TrialPlan
    from rig.interrupts import Interrupts
    from rig.model_gaits import best_gaits
    from rig.optimise import StudyPlan, best
    from rig.optimise import optimise as trials_of
    from rig.record import trial_runner
    from rig.reidentify import proposer
    from rig.setup_file import read_setup
    from tentacle.io.model_file import read_model
    from tentacle.io.waveform_file import write_waveform

    setup = read_setup(arguments.rig)
    space = GaitSpace(setup.limits, tuple(arguments.frequency), arguments.harmonics)
    plan = StudyPlan(space, arguments.trials, TrialPlan(), arguments.reidentify, arguments.seed)
    if arguments.reidentify and setup.camera is None:
        raise InputError("needs a camera", field="--reidentify", expected="[camera] in rig.toml")
    first: list[dict[str, float]] = []
    model = None if arguments.model is None else read_model(arguments.model)
    if model is not None:
        print("asking the model for its best gaits", flush=True)
        first = best_gaits(model, space, plan.plan, arguments.first, arguments.seed)
    trials = []
    with (
        connected(setup) as board,
        opened_camera(setup, board.time) as camera,
        _progress() as progress,
        Interrupts(_say) as interrupts,
    ):
        runner = trial_runner(setup, board, camera, interrupts, progress)

        def diagnosing(step: str) -> None:
            if interrupts.pause:  # a diagnosis takes minutes, and the arm stands at neutral: it can be left at once
                raise KeyboardInterrupt
            progress(f"diagnosis: {step}", 0.0)

        propose = None
        if arguments.reidentify:
            propose = proposer(
                space, plan.plan, believed=model, seed=arguments.seed, progress=diagnosing,
                told=lambda words: print(words, flush=True),
            )  # fmt: skip
        for trial in trials_of(arguments.out, plan, runner, first, propose=propose, interrupts=interrupts, told=_say):
            trials.append(trial)
            top = best(trials)
            print(
                f"{len(trials):3d}/{plan.trials}  {1e3 * trial.propulsion:8.2f} mN  ({trial.source})  "
                f"best {1e3 * top.propulsion:.2f} mN, trial {top.number}",
                flush=True,
            )
        paused = interrupts.pause
    if trials:
        top = best(trials)
        write_waveform(space.gait(top.point), arguments.out / "best.toml")
        print(f"best: {1e3 * top.propulsion:.2f} mN, {top.recording.name}; its gait is {arguments.out / 'best.toml'}")
    return 130 if paused and len(trials) < plan.trials else 0


def _say(words: str) -> None:
    print(f"\n{words}", file=sys.stderr, flush=True)


@contextmanager
def _progress() -> Iterator[Callable[[str, float], None]]:
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("connecting", total=1.0)
        yield lambda phase, share: bar.update(task, description=phase, completed=share)


@contextmanager
def _viewer(wanted: bool, *, camera: bool) -> Iterator[str | None]:
    """A Rerun viewer on this machine alone, fed while the run lasts."""
    if not wanted:
        yield None
        return
    from rig import live_feed
    from tentacle.cli._live_viewer import start_viewer
    from viz.blueprints.rig import send_live_layout

    start_viewer(VIEWER_PORT)
    address = f"rerun+http://127.0.0.1:{VIEWER_PORT}/proxy"
    send_live_layout(address, live_feed.APPLICATION, live_paths(camera=camera))
    with contextlib.suppress(KeyboardInterrupt):
        yield address


def live_paths(*, camera: bool) -> LivePaths:
    """Where the live feed keeps what a live view shows."""
    from rig import live_feed, recorder
    from viz.blueprints.rig import LivePaths

    return LivePaths(
        recorder.COMMAND,
        recorder.ANGLE,
        recorder.CURRENT,
        recorder.THRUST,
        recorder.EVENTS,
        live_feed.BOARD_TIME,
        live_feed.PREVIEW if camera else None,
    )

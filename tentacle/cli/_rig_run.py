"""Bodies of `tentacle rig`: record, optimise, campaign."""

from __future__ import annotations

import argparse
import contextlib
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.errors import InputError

if TYPE_CHECKING:
    from viz.blueprints.rig import LivePaths

VIEWER_PORT = 9876


def record(arguments: argparse.Namespace) -> int:
    """One run; exit code 3 where it did not complete."""
    from rig import record as rig_record
    from rig.campaign import described
    from rig.interrupts import Interrupts
    from rig.setup_file import read_setup
    from tentacle.waveform_file import read_waveform

    setup = read_setup(arguments.rig)
    waveform = read_waveform(arguments.waveform)
    motion = rig_record.motion_of(waveform, arguments.seconds, setup, described(waveform))
    if arguments.out.suffix != ".rrd":
        raise InputError("not an .rrd name", file=arguments.out, field="--out", expected="FILE.rrd")
    with (
        _viewer(arguments.view) as viewer,
        rig_record.connected(setup) as board,
        rig_record.opened_camera(setup, board.time) as camera,
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
    return 0 if result.outcome == "complete" else 3


def campaign(arguments: argparse.Namespace) -> int:
    """All runs that are not complete yet."""
    from rig import record as rig_record
    from rig.campaign import read_campaign, run_campaign
    from rig.interrupts import Interrupts
    from rig.setup_file import read_setup

    setup = read_setup(arguments.rig)
    runs = read_campaign(arguments.campaign, setup)
    with (
        rig_record.connected(setup) as board,
        rig_record.opened_camera(setup, board.time) as camera,
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
    from rig import record as rig_record
    from rig.gait_space import GaitSpace, TrialPlan
    from rig.interrupts import Interrupts
    from rig.model_gaits import best_gaits
    from rig.optimise import StudyPlan, best
    from rig.optimise import optimise as trials_of
    from rig.reidentify import proposer
    from rig.setup_file import read_setup
    from tentacle.model_file import read_model
    from tentacle.waveform_file import write_waveform

    setup = read_setup(arguments.rig)
    space = GaitSpace(setup.limits, tuple(arguments.frequency), arguments.harmonics)
    plan = StudyPlan(space, arguments.trials, TrialPlan(), arguments.reidentify, arguments.seed)
    if arguments.reidentify and setup.camera is None:
        raise InputError("needs a camera", field="--reidentify", expected="[camera] in rig.toml")
    first: list[dict[str, float]] = []
    if arguments.model is not None:
        print("asking the model for its best gaits", flush=True)
        first = best_gaits(read_model(arguments.model), space, plan.plan, arguments.first, arguments.seed)
    propose = None
    if arguments.reidentify:
        propose = proposer(space, plan.plan, seed=arguments.seed, told=lambda found: print(found.headline, flush=True))
    trials = []
    with (
        rig_record.connected(setup) as board,
        rig_record.opened_camera(setup, board.time) as camera,
        _progress() as progress,
        Interrupts(_say) as interrupts,
    ):
        runner = rig_record.trial_runner(setup, board, camera, interrupts, progress)
        for trial in trials_of(arguments.out, plan, runner, first, propose=propose, interrupts=interrupts):
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
def _viewer(wanted: bool) -> Iterator[str | None]:
    """A Rerun viewer on this machine alone, fed while the run lasts."""
    if not wanted:
        yield None
        return
    from rig import recorder
    from viz.blueprints.rig import send_live_layout

    command = [str(Path(sys.executable).with_name("rerun")), "--bind", "127.0.0.1", "--port", str(VIEWER_PORT)]
    try:
        subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    except FileNotFoundError:
        raise InputError("no viewer here", field="--view", expected="the rerun command beside this Python") from None
    address = f"rerun+http://127.0.0.1:{VIEWER_PORT}/proxy"
    send_live_layout(address, recorder.APPLICATION, live_paths())
    with contextlib.suppress(KeyboardInterrupt):
        yield address


def live_paths() -> LivePaths:
    """Where the recorder keeps what a live view shows."""
    from rig import recorder
    from viz.blueprints.rig import LivePaths

    return LivePaths(
        recorder.COMMAND, recorder.ANGLE, recorder.CURRENT, recorder.THRUST, recorder.EVENTS, recorder.BOARD_TIME
    )

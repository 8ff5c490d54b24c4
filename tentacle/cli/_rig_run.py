"""Bodies of `tentacle rig`: record and campaign."""

from __future__ import annotations

import argparse

from tentacle.cli._output import say
from tentacle.errors import InputError


def record(arguments: argparse.Namespace) -> int:
    """One run; exit code 3 where it did not complete, 128 and the signal's number where it was stopped by hand."""
    from rig import record as rig_record
    from rig.connection import connected, opened_camera
    from rig.interrupts import Interrupts
    from rig.motion import described, rig_motion
    from rig.setup_file import read_setup
    from tentacle.cli._rig_terminal import rig_progress_bar, tell, viewer
    from tentacle.io.waveform_file import read_waveform

    setup = read_setup(arguments.rig)
    waveform = read_waveform(arguments.waveform)
    motion = rig_motion(waveform, arguments.seconds, setup.limits, described(waveform))
    if arguments.out.suffix != ".rrd":
        raise InputError("not an .rrd name", file=arguments.out, field="--out", expected="FILE.rrd")
    with (
        viewer(arguments.view, camera=setup.camera is not None) as live,
        connected(setup) as board,
        opened_camera(setup, board.time) as camera,
        rig_progress_bar() as progress,
        Interrupts(tell) as interrupts,
    ):
        result = rig_record.record_run(
            setup,
            board,
            camera,
            motion,
            arguments.out,
            rig_record.Attendance(arguments.out.stem, interrupts, viewer=live.address, progress=progress),
        )
        live.kept = result.outcome == "complete"
    say(f"{result.outcome}: {result.samples} samples, {result.lost} lost, wrote {result.path}")
    if result.words:
        say(result.words)
    return {"complete": 0, "interrupted": interrupts.exit_code}.get(result.outcome, 3)


def campaign(arguments: argparse.Namespace) -> int:
    """All runs that are not complete yet."""
    from rig.campaign import read_campaign, run_campaign
    from rig.connection import connected, opened_camera
    from rig.interrupts import Interrupts
    from rig.record import Attendance
    from rig.setup_file import read_setup
    from tentacle.cli._rig_terminal import rig_progress_bar, tell

    setup = read_setup(arguments.rig)
    runs = read_campaign(arguments.campaign, setup)
    with (
        connected(setup) as board,
        opened_camera(setup, board.time) as camera,
        rig_progress_bar() as progress,
        Interrupts(tell) as interrupts,
    ):
        for result in run_campaign(
            setup, board, camera, runs, arguments.out, attendance=Attendance(interrupts=interrupts, progress=progress)
        ):
            words = f"; {result.words}" if result.words else ""
            say(f"{result.path.name}: {result.outcome}, {result.samples} samples, {result.lost} lost{words}")
        paused = interrupts.pause
    say(f"paused; the same command goes on: {arguments.out}" if paused else f"{len(runs.runs)} runs in {arguments.out}")
    return interrupts.exit_code if paused else 0

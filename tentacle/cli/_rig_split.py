"""Body of `tentacle rig campaign --until-split`."""

from __future__ import annotations

import argparse

from tentacle.cli._output import say
from tentacle.errors import InputError


def until_split(arguments: argparse.Namespace) -> int:
    """Runs and joint diagnoses until an ending: 0 where it is split, 1 where it is not, 128 + signal where paused."""
    from rig.campaign import read_campaign
    from rig.connection import connected, opened_camera
    from rig.interrupts import Interrupts
    from rig.record import motion_runner
    from rig.run_file import read_run
    from rig.sentinel import drift
    from rig.setup_file import read_setup
    from rig.split_decision import joint_judge
    from rig.until_split import Bench, SplitPlan, run_until_split
    from tentacle.cli._rig_terminal import rig_progress_bar, tell

    setup = read_setup(arguments.rig)
    if setup.camera is None:
        raise InputError("needs a camera", field="--until-split", expected="[camera] in rig.toml")
    first = read_campaign(arguments.campaign, setup)
    plan = SplitPlan(first, setup.limits, arguments.most, reference_every=arguments.reference_every)
    with (
        connected(setup) as board,
        opened_camera(setup, board.time) as camera,
        rig_progress_bar() as progress,
        Interrupts(tell) as interrupts,
    ):

        def diagnosing(words: str, done: float = 0.0) -> None:
            if interrupts.pause:  # the arm stands at neutral: a diagnosis can be left at once
                raise KeyboardInterrupt
            progress(f"diagnosis: {words}", done)

        bench = Bench(
            motion_runner(setup, board, camera, interrupts, progress),
            joint_judge(setup.limits, arguments.seed, diagnosing),
            lambda runs: [change.words for change in drift([read_run(path) for path in runs], plan.reference)],
        )
        found = run_until_split(arguments.out, plan, bench, interrupts=interrupts, told=say)
    for line in found.drift:
        say(f"drift: {line}")
    say(f"{found.ending}: {len(found.experiments)} recordings in {arguments.out}")
    if found.ending == "paused":
        say("the same command goes on")
        return interrupts.exit_code
    return 0 if found.ending == "split" else 1

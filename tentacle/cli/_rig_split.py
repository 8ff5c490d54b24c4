"""Body of `tentacle rig campaign --until-split`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._output import remark, say
from tentacle.errors import InputError

if TYPE_CHECKING:
    from rig.until_split import Conclusion
    from tentacle.diagnosis import Diagnosis
    from tentacle.recording import Recording

ANSWER = "answer"  # folder of the latest joint diagnosis, in the campaign's


def until_split(arguments: argparse.Namespace) -> int:
    """Runs and joint diagnoses until an ending: 0 where it is split, 1 where it is not, 128 + signal where paused."""
    from rig.campaign import read_campaign
    from rig.connection import connected, opened_camera
    from rig.fault import Fault
    from rig.interrupts import Interrupts
    from rig.record import motion_runner
    from rig.sentinel import sentinel
    from rig.setup_file import read_setup
    from rig.soundness import is_filmed_run
    from rig.split_decision import joint_judge
    from rig.until_split import Bench, SplitPlan, run_until_split
    from tentacle.cli._rig_terminal import rig_progress_bar, tell

    setup = read_setup(arguments.rig)
    if setup.camera is None:
        raise InputError("needs a camera", field="--until-split", expected="[camera] in rig.toml")
    first = read_campaign(arguments.campaign, setup)
    plan = SplitPlan(
        first, setup.limits, arguments.most, reference_every=arguments.reference_every, repeats=arguments.repeats
    )
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
            joint_judge(setup.limits, arguments.seed, diagnosing, answer_writer(arguments.out / ANSWER)),
            sentinel(plan.reference, plan.repeats, plan.comparisons, say),
            is_filmed_run,
        )
        try:
            found = run_until_split(arguments.out, plan, bench, interrupts=interrupts, told=say)
        except Fault:
            remark(f"the same command goes on; {arguments.out / 'until_split.jsonl'} holds what failed", "")
            raise
    tell_ending(found, arguments.out)
    if found.ending == "paused":
        return interrupts.exit_code
    return 0 if found.ending == "split" else 1


def answer_writer(folder: Path) -> Callable[[Diagnosis, Sequence[Recording], Sequence[Path]], None]:
    """A function that writes each joint diagnosis as `tentacle diagnose` does, in the place of the last one."""

    def keep(found: Diagnosis, recordings: Sequence[Recording], runs: Sequence[Path]) -> None:
        from tentacle.cli.pages.diagnosis import write_answer
        from tentacle.io.result_folder import written

        with written(folder) as answer:
            write_answer(found, list(recordings), answer, " ".join(["tentacle", *sys.argv[1:]]), list(runs))
        if found.next_experiment is None:
            (folder / "next_experiment.toml").unlink(missing_ok=True)  # of the diagnosis before

    return keep


def tell_ending(found: Conclusion, folder: Path) -> None:
    """What the campaign found, where the answer lies, and how to go on."""
    for line in found.drift:
        say(f"drift: {line}")
    if found.decision is not None and found.ending != "paused":
        say(found.decision.headline)
    say(f"{found.ending}: {len(found.experiments)} recordings in {folder}")
    report = folder / ANSWER / "report.html"
    if report.is_file():
        say(f"report: {report}   replay: tentacle view {folder / ANSWER / 'session.rrd'}")
    if found.ending == "paused":
        say("the same command goes on")

"""Body of `tentacle rig optimise`: trials on the rig until there are enough."""

from __future__ import annotations

import argparse

from rig.optimise import Suggestions
from tentacle.cli._output import say
from tentacle.errors import InputError


def optimise(arguments: argparse.Namespace) -> int:
    """Trials until there are enough; the best gait as a waveform file beside them."""
    from rig.connection import connected, opened_camera
    from rig.gait_space import GaitSpace, TrialPlan
    from rig.interrupts import Interrupts
    from rig.model_gaits import best_gaits
    from rig.optimise import StudyPlan, best
    from rig.optimise import optimise_on_rig as trials_of
    from rig.record import trial_runner
    from rig.reidentify import proposer
    from rig.setup_file import read_setup
    from tentacle.cli._rig_terminal import rig_progress_bar, tell
    from tentacle.io.model_file import read_model
    from tentacle.io.waveform_file import write_waveform
    from tentacle.units import in_mn

    setup = read_setup(arguments.rig)
    space = GaitSpace(setup.limits, tuple(arguments.frequency), arguments.harmonics)
    plan = StudyPlan(space, arguments.trials, TrialPlan(), arguments.reidentify, arguments.seed)
    if arguments.reidentify and setup.camera is None:
        raise InputError("needs a camera", field="--reidentify", expected="[camera] in rig.toml")
    first: list[dict[str, float]] = []
    model = None if arguments.model is None else read_model(arguments.model)
    if model is not None:
        say("asking the model for its best gaits")
        first = best_gaits(model, space, plan.plan, arguments.first, arguments.seed)
    trials = []
    with (
        connected(setup) as board,
        opened_camera(setup, board.time) as camera,
        rig_progress_bar() as progress,
        Interrupts(tell) as interrupts,
    ):
        runner = trial_runner(setup, board, camera, interrupts, progress)

        def diagnosing(words: str, done: float = 0.0) -> None:
            if interrupts.pause:  # a diagnosis takes minutes, and the arm stands at neutral: it can be left at once
                raise KeyboardInterrupt
            progress(f"diagnosis: {words}", done)

        propose = None
        if arguments.reidentify:
            propose = proposer(
                space, plan.plan, believed=model, seed=arguments.seed, progress=diagnosing,
                told=say,
            )  # fmt: skip
        for trial in trials_of(
            arguments.out, plan, runner, Suggestions(first, propose=propose), interrupts=interrupts, told=tell
        ):
            trials.append(trial)
            top = best(trials)
            say(
                f"{len(trials):3d}/{plan.trials}  {in_mn(trial.propulsion):8.2f} mN  ({trial.source})  "
                f"best {in_mn(top.propulsion):.2f} mN, trial {top.number}",
            )
        paused = interrupts.pause
    if trials:
        top = best(trials)
        write_waveform(space.gait(top.point), arguments.out / "best.toml")
        say(f"best: {in_mn(top.propulsion):.2f} mN, {top.recording.name}; its gait is {arguments.out / 'best.toml'}")
    return interrupts.exit_code if paused and len(trials) < plan.trials else 0

"""`tentacle diagnose`: find what the declared model lacks, add it, and report the error before and after."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._device import add_device
from tentacle.cli._effects import add_effects
from tentacle.cli._inputs import require_once, tell_advice
from tentacle.cli._output import remark, say, say_text

HELP = "find the effect that the model lacks from the residual of recordings; report the error before and after"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments: the contract of docs/contracts.md."""
    parser.add_argument(
        "recordings", nargs="+", metavar="RECORDING", type=Path, help="an import folder or an .rrd file"
    )
    parser.add_argument(
        "--baseline", nargs="+", default=[], type=Path, metavar="RECORDING",
        help="recordings with a complete declaration: no missing effect acts in them",
    )  # fmt: skip
    parser.add_argument(
        "--held-out", nargs="+", default=[], type=Path, metavar="RECORDING",
        help="held-out recordings: they judge and are not fitted (default: a third of each RECORDING)",
    )  # fmt: skip
    parser.add_argument(
        "--calibration", type=Path, metavar="FILE.toml",
        help="take the confidence from your own blind trials: the file of tentacle blind-trial --like RECORDING",
    )  # fmt: skip
    add_effects(parser)
    add_device(parser)
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of all random choices (default 0)")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for verdict.json, report.html, ..."
    )
    parser.add_argument("--json", action="store_true", help="print verdict.json on standard output")


def run(arguments: argparse.Namespace) -> int:
    """Diagnose and write; 0 with any verdict."""
    import json
    import sys

    from affine_model.device import cuda_device
    from tentacle.cli._kernels import kernels_ahead
    from tentacle.cli._progress import DIAGNOSING, reading_plan, stages
    from tentacle.cli.pages.diagnosis import answer_lines, write_answer
    from tentacle.io.result_folder import told_before, written
    from vision.tracked_recording import read_tracked

    calibration, device = None, cuda_device(arguments.device)
    if arguments.calibration is not None:
        from discovery.calibration import read_calibration

        calibration = read_calibration(arguments.calibration)
    groups = [arguments.recordings, arguments.baseline, arguments.held_out]
    require_once(dict(zip(("RECORDING", "--baseline", "--held-out"), groups, strict=True)))
    if words := told_before(arguments.out):
        remark(words, "")
    plan = [*reading_plan([path for group in groups for path in group]), *DIAGNOSING]
    with stages(plan) as stage, kernels_ahead(stage) as wait_for_kernels:
        recordings, baseline, held_out = ([read_tracked(path, stage) for path in group] for group in groups)
        tell_advice([*recordings, *baseline, *held_out])
        from discovery.diagnose import diagnose
        from discovery.given import Deciding

        wait_for_kernels()
        diagnosis = diagnose(
            recordings,
            baseline,
            held_out,
            seed=arguments.seed,
            deciding=Deciding(calibration, device=device),
            progress=stage,
        )
        stage("writing the report")
        command = " ".join(["tentacle", *sys.argv[1:]])
        with written(arguments.out) as folder:
            inputs = [path for group in groups for path in group]
            inputs += [*arguments.effects, *([] if arguments.calibration is None else [arguments.calibration])]
            write_answer(diagnosis, [*recordings, *held_out], folder, command, inputs)
    if arguments.json:
        say_text(json.dumps(diagnosis.verdict_json(), indent=1))
    else:
        say(*answer_lines(diagnosis))
        say(f"report: {arguments.out / 'report.html'}   replay: tentacle view {arguments.out / 'session.rrd'}")
    return 0

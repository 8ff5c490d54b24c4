"""`tentacle identify`: the declared model's parameters from recordings, with intervals and the paper's regression."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._device import add_device
from tentacle.cli._inputs import require_once, tell_advice
from tentacle.cli._output import remark, say, say_text

HELP = (
    "fit the declared model's parameters to recordings, with 95 %% intervals and the paper's regression for comparison"
)


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "recordings", nargs="+", metavar="RECORDING", type=Path, help="an import folder or an .rrd file"
    )
    parser.add_argument(
        "--check", nargs="+", default=[], type=Path, metavar="RECORDING",
        help="held-out recordings: they judge and are not fitted (the paper fits a chirp and checks a sine)",
    )  # fmt: skip
    parser.add_argument(
        "--order", type=int, choices=range(2, 7), help="curvature coordinates (default: what the data need)"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for model.toml, report.html, ..."
    )
    parser.add_argument(
        "--bootstrap", type=int, default=0, metavar="N", help="also give intervals by N refits to resampled residuals"
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the bootstrap (default 0)")
    add_device(parser)
    parser.add_argument("--json", action="store_true", help="print the result as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Identify and write."""
    import json
    import sys

    from affine_model.device import cuda_device
    from tentacle.cli._kernels import kernels_ahead
    from tentacle.cli._progress import IDENTIFYING, reading_plan, stages
    from tentacle.cli.pages.identification import identification_lines, identification_table, write_identification
    from tentacle.errors import InputError
    from tentacle.io.provenance import input_hashes, versions
    from tentacle.io.result_folder import told_before, written
    from vision.tracked_recording import read_tracked
    from viz.report import Origin

    if arguments.bootstrap != 0 and arguments.bootstrap < 20:
        raise InputError(f"{arguments.bootstrap} is too few", field="--bootstrap", expected="0, or at least 20")
    device = cuda_device(arguments.device)
    if words := told_before(arguments.out):
        remark(words, "")
    require_once({"RECORDING": arguments.recordings, "--check": arguments.check})
    plan = [*reading_plan([*arguments.recordings, *arguments.check]), *IDENTIFYING]
    with stages(plan) as stage, kernels_ahead(stage) as wait_for_kernels:
        recordings = [read_tracked(path, stage) for path in arguments.recordings]
        check = [read_tracked(path, stage) for path in arguments.check]
        tell_advice([*recordings, *check])
        wait_for_kernels()
        stage("fitting")
        from inference.identify import identify

        found = identify(
            recordings,
            check,
            order=arguments.order,
            replicates=arguments.bootstrap,
            seed=arguments.seed,
            device=device,
        )
        command = " ".join(["tentacle", *sys.argv[1:]])
        origin = Origin(command, None, versions(), input_hashes([*arguments.recordings, *arguments.check]))
        stage("writing the report")
        with written(arguments.out) as folder:
            write_identification(found, check or recordings, origin, folder)
    if arguments.json:
        say_text(json.dumps(identification_table(found), indent=1))
    else:
        say(*identification_lines(found), f"written to {arguments.out}", *_next(found.adequate, arguments))
    return 0


def _next(adequate: bool, arguments: argparse.Namespace) -> list[str]:
    """Whether the model is adequate, and which command is next."""
    if adequate:
        words = "The model is adequate: its residual on these recordings is not distinguishable from noise."
        return [words, f"next: tentacle optimise {arguments.out / 'model.toml'} --out gait"]
    recordings = " ".join(map(str, arguments.recordings))
    words = "The model is not adequate: its residual on these recordings is larger than noise."
    return [words, f"next: tentacle diagnose {recordings} --out {arguments.out}_diagnosed"]

"""tentacle optimise: the gait of eq. 20 that swims best with this arm and this servo."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._effects import add_effects
from tentacle.cli._output import say
from tentacle.cli._swim_inputs import DRIVE, HULL, SERVO, read_arm, read_hull, read_limits

HELP = "find the base motion that swims best, within the servo's limits"

# Named here, not imported, so that --help stays quick; a test holds them to the package's own.
OBJECTIVES = ("thrust", "speed", "transport", "free")
METHODS = ("cmaes", "ga", "ga-individual", "random")
SILICONES = ("dragon-skin-10", "dragon-skin-20", "ecoflex-00-30")


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the verb."""
    parser.add_argument(
        "arm", type=Path, help="model.toml of identify or diagnose, a recording.toml, or an import folder"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder for result.toml, session.rrd, report.html")
    parser.add_argument("--objective", choices=OBJECTIVES, default="thrust", help="default: thrust (eq. 21)")
    parser.add_argument("--method", choices=METHODS, default="cmaes", help="ga is the paper's; default: cmaes")
    parser.add_argument("--evaluations", type=int, default=5000, help="gaits tried; default: the paper's 50 x 100")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--limits", type=Path, help=f"TOML with a [limits] table of {', '.join(SERVO + DRIVE)}")
    parser.add_argument("--hull", type=Path, help=f"of --objective free: TOML with a [hull] table of {', '.join(HULL)}")
    parser.add_argument(
        "--silicone", choices=SILICONES, default=SILICONES[0], help="silicone of an arm without a fitted model"
    )
    parser.add_argument(
        "--robust", type=int, default=0, metavar="N", help="judge a gait over N samples of the model's posterior"
    )
    parser.add_argument("--restarts", type=int, default=1, metavar="N", help="run searches from N seeds in parallel")
    parser.add_argument("--cluster", metavar="ADDRESS", help="Dask scheduler for the searches (default: processes)")
    add_effects(parser)
    parser.add_argument("--device", default="auto", help="cpu, cuda, cuda:1; auto (default): CUDA where there is one")
    parser.add_argument(
        "--polish", action="store_true", help="climb from the best gait once more, with the exact gradient (PyTorch)"
    )
    parser.add_argument("--front", action="store_true", help="also compute the Pareto front of speed against power")
    parser.add_argument("--no-reference", action="store_true", help="leave out the check on the MuJoCo reference")


def run(arguments: argparse.Namespace) -> int:
    """Search, check, write; the same command continues an interrupted search."""
    from dataclasses import replace

    from affine_model.device import chosen_device, needs_torch
    from affine_model.swim import robust_trial, trial_of
    from affine_model.swim.pareto import front_around
    from tentacle.cli._swim_answer import answer_summary, write_swim_answer
    from tentacle.cli._swim_search import searched
    from tentacle.cli._swim_tables import posterior_table, result_tables
    from tentacle.errors import InputError
    from tentacle.io.result_folder import written
    from tentacle.io.waveform_file import waveform_table
    from validation.reference_swim import reference_gains

    if arguments.evaluations < 50:
        raise InputError(f"{arguments.evaluations} is too few", field="--evaluations", expected="50 or more")
    if arguments.robust < 0 or arguments.robust == 1:
        raise InputError(f"{arguments.robust} is not usable", field="--robust", expected="2 or more samples")
    if arguments.restarts < 1:
        raise InputError(f"{arguments.restarts} is not usable", field="--restarts", expected="1 or more")
    free = arguments.objective == "free"
    if arguments.hull is not None and not free:
        raise InputError("only a free hull needs it", field="--hull", expected="--objective free")
    if arguments.polish:
        needs_torch("--polish")
    model, limits = read_arm(arguments.arm, arguments.silicone), read_limits(arguments.limits)
    device, hull = chosen_device(arguments.device, processor_only=free), read_hull(arguments.hull)
    at_estimates = replace(trial_of(model, limits), device=device, hull=hull)
    trial = robust_trial(at_estimates, model, arguments.robust, seed=0) if arguments.robust else at_estimates
    found = searched(arguments, trial, model)
    tables = result_tables(found, waveform_table)
    if arguments.robust:
        tables["posterior"] = posterior_table(at_estimates, model, found)
    if not arguments.no_reference:
        try:
            tables["reference"] = reference_gains(model, found.gait, found.sine, hull if free else None)
        except InputError as error:  # an effect of the reduced model that the reference lacks
            tables["left_out"] = {"reference": str(error)}
    front = front_around(at_estimates, found.gait, found.sine, found.seed) if arguments.front else None
    with written(arguments.out) as folder:
        write_swim_answer(arguments, at_estimates, found, tables, front, folder)
    for line in answer_summary(tables):
        say(line)
    say(f"report: {arguments.out / 'report.html'}   replay: tentacle view {arguments.out / 'session.rrd'}")
    return 0

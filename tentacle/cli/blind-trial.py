"""`tentacle blind-trial`: hide effects in recordings, diagnose them without the answer, and score."""

from __future__ import annotations

import argparse

from tentacle.cli._blind_arguments import PLANTS, VIDEO_SHARE, comma_separated
from tentacle.cli._blind_arguments import configure as configure
from tentacle.cli._output import say

HELP = "make recordings with hidden effects, diagnose them without the answer, and score the loop"


def run(arguments: argparse.Namespace) -> int:
    """Run the missing trials, score all, write; the same command continues an interrupted series."""
    import json

    from affine_model.device import cuda_device
    from tentacle.cli._blind_like import like_recording
    from tentacle.cli.pages.blind_trials import blind_trials_page
    from tentacle.errors import InputError
    from tentacle.io.provenance import input_hashes, versions
    from tentacle.io.result_folder import written
    from tentacle.runner import Runner
    from validation.trials.figures import figures, results
    from validation.trials.plant_design import plant_designs
    from validation.trials.reliability import fit_calibration
    from validation.trials.remake import remake
    from validation.trials.series import run_series
    from viz.report import Origin, write_report

    if arguments.count < 1:
        raise InputError(f"{arguments.count} is too few", field="N", expected="1 or more")
    if arguments.workers is not None and arguments.workers < 1:
        raise InputError(f"{arguments.workers} is too few", field="--workers", expected="1 or more")
    device, kinds = cuda_device(arguments.device), comma_separated(arguments.kinds)
    share = VIDEO_SHARE if arguments.video_share is None else arguments.video_share
    sections, inputs = [], []
    real = (arguments.own_errors, arguments.baseline)
    if arguments.like is None:
        for field, given in (("--own-errors", arguments.own_errors), ("--baseline", arguments.baseline)):
            if given:
                raise InputError("a simulated arm has none", field=field, expected="--like RECORDING beside it")
        plants = comma_separated(arguments.plant or PLANTS)
        found = plant_designs(
            arguments.count, arguments.seed, plants=plants, kinds=kinds, video_share=share, repeats=arguments.repeats
        )
        options = f"--plant {','.join(plants)} --video-share {share:g}{' --repeats' if arguments.repeats else ''}"
    else:
        for field, given, expected in (
            ("--video-share", arguments.video_share, "the recording says how"),
            ("--plant", arguments.plant, "the reference makes them"),
            ("--repeats", arguments.repeats or None, "--baseline gives real ones"),
        ):
            if given is not None:
                raise InputError("not together with --like", field=field, expected=expected)
        found, sections = like_recording(arguments.like, arguments.count, arguments.seed, kinds, real)
        inputs = [arguments.like, *arguments.baseline]
        own = ["--own-errors"] if arguments.own_errors else []
        beside = ["--baseline", *map(str, arguments.baseline)] if arguments.baseline else []
        options = " ".join(["--like", str(arguments.like), *own, *beside])
    if arguments.only:
        for path in remake(found, arguments.only, arguments.out):
            say(path)
        return 0
    options += "" if device is None else f" --device {device}"
    runner = Runner(arguments.out / "trials", workers=arguments.workers, scheduler=arguments.cluster)
    hashes = input_hashes(inputs)
    outcomes, refused = run_series(found, runner, "".join(hashes.values()), device)
    command = f"tentacle blind-trial {arguments.count} --seed {arguments.seed} --kinds {','.join(kinds)} {options}"
    calibration = fit_calibration(outcomes, f"Isotonic fit to {len(outcomes)} blind trials: {command}")
    origin = Origin(command, arguments.seed, versions(), hashes)
    with written(arguments.out) as folder:
        (folder / "results.json").write_text(json.dumps(results(outcomes, refused), indent=1) + "\n")
        (folder / "calibration.toml").write_text(calibration.toml())
        write_report(blind_trials_page(outcomes, refused, origin, sections), folder / "report.html")
    for name, value in figures(outcomes).items():
        say(f"{name:30s} {'no trials' if value is None else format(value, '.3f')}")
    say(f"report: {arguments.out / 'report.html'}")
    return 0

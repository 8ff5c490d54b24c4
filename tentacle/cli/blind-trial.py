"""`tentacle blind-trial`: hide effects in recordings, diagnose them without the answer, and score."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say

HELP = "make recordings with hidden effects, diagnose them without the answer, and score the loop"
KINDS = "single,pair,null,unknown"
VIDEO_SHARE = 0.25
PLANTS = "stranger,chain"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "count", type=int, metavar="N", help="number of trials; a longer series begins with the trials of a shorter one"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for report.html, results.json, ..."
    )
    parser.add_argument("--seed", type=int, default=0, help="the same seed gives the same trials (default 0)")
    place = parser.add_mutually_exclusive_group()
    place.add_argument("--workers", type=int, metavar="W", help="number of processes (default: one per core)")
    place.add_argument("--cluster", metavar="ADDRESS", help="run on this Dask scheduler instead, tcp://HOST:PORT")
    parser.add_argument(
        "--like",
        type=Path,
        metavar="RECORDING",
        help="make trials with the arm, base motion, length and noise of this recording",
    )
    parser.add_argument(
        "--video-share",
        type=float,
        metavar="SHARE",
        help=f"share of trials that are rendered as video and tracked (default {VIDEO_SHARE})",
    )
    parser.add_argument(
        "--plant",
        metavar="LIST",
        help=f"simulators that hide the effects, drawn at random for each trial (default {PLANTS})",
    )
    parser.add_argument("--kinds", default=KINDS, metavar="LIST", help=f"kinds of trials (default {KINDS})")
    parser.add_argument(
        "--only",
        type=int,
        nargs="+",
        metavar="K",
        help="only write the recordings of these trials again, as .rrd files",
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the missing trials, score all, write; the same command continues an interrupted series."""
    import json

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
    kinds = _listed(arguments.kinds)
    share = VIDEO_SHARE if arguments.video_share is None else arguments.video_share
    sections, inputs = [], []
    if arguments.like is None:
        plants = _listed(arguments.plant or PLANTS)
        found = plant_designs(arguments.count, arguments.seed, plants=plants, kinds=kinds, video_share=share)
        options = f"--plant {','.join(plants)} --video-share {share:g}"
    else:
        for field, given, expected in (
            ("--video-share", arguments.video_share, "the recording says how"),
            ("--plant", arguments.plant, "the reference makes them"),
        ):
            if given is not None:
                raise InputError("not together with --like", field=field, expected=expected)
        found, sections = like_recording(arguments.like, arguments.count, arguments.seed, kinds)
        inputs = [arguments.like]
        options = f"--like {arguments.like}"
    if arguments.only:
        for path in remake(found, arguments.only, arguments.out):
            say(path)
        return 0
    runner = Runner(arguments.out / "trials", workers=arguments.workers, scheduler=arguments.cluster)
    outcomes, refused = run_series(found, runner)
    command = f"tentacle blind-trial {arguments.count} --seed {arguments.seed} --kinds {','.join(kinds)} {options}"
    calibration = fit_calibration(outcomes, f"Isotonic fit to {len(outcomes)} blind trials: {command}")
    origin = Origin(command, arguments.seed, versions(), input_hashes(inputs))
    with written(arguments.out) as folder:
        (folder / "results.json").write_text(json.dumps(results(outcomes, refused), indent=1) + "\n")
        (folder / "calibration.toml").write_text(calibration.toml())
        write_report(blind_trials_page(outcomes, refused, origin, sections), folder / "report.html")
    for name, value in figures(outcomes).items():
        say(f"{name:30s} {'no trials' if value is None else format(value, '.3f')}")
    say(f"report: {arguments.out / 'report.html'}")
    return 0


def _listed(text: str) -> list[str]:
    """The words of a list with commas."""
    return [word.strip() for word in text.split(",") if word.strip()]

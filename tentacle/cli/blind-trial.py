"""`tentacle blind-trial`: hide effects in recordings, diagnose them without the answer, and score."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "make recordings with hidden effects, diagnose them without the answer, and score the loop"
KINDS = "single,pair,null,unknown"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "count", type=int, metavar="N", help="how many trials; a longer series begins with the shorter one's"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for report.html, results.json, ..."
    )
    parser.add_argument("--seed", type=int, default=0, help="the same seed gives the same trials (default 0)")
    place = parser.add_mutually_exclusive_group()
    place.add_argument("--workers", type=int, metavar="W", help="processes (default: one a core)")
    place.add_argument("--cluster", metavar="ADDRESS", help="a Dask scheduler instead, as tcp://127.0.0.1:8786")
    parser.add_argument(
        "--video-share", type=float, default=0.25, metavar="SHARE", help="rendered and tracked (default .25)"
    )
    parser.add_argument("--kinds", default=KINDS, metavar="LIST", help=f"of the trials (default {KINDS})")
    parser.add_argument(
        "--only",
        type=int,
        nargs="+",
        metavar="K",
        help="make these trials' recordings again, as .rrd files, and nothing else",
    )


def run(arguments: argparse.Namespace) -> int:
    """Run what has not been run, score all, write; an interrupted series goes on where it stopped."""
    import json

    from tentacle.cli._blind_report import figures, page, results
    from tentacle.cli._blind_trial import run_series, series
    from tentacle.cli._outcome import written
    from tentacle.cli._provenance import versions
    from tentacle.errors import InputError
    from tentacle.runner import Runner
    from viz.report import Origin, write_report

    if arguments.count < 1:
        raise InputError(f"{arguments.count} is too few", field="N", expected="1 or more")
    if arguments.workers is not None and arguments.workers < 1:
        raise InputError(f"{arguments.workers} is too few", field="--workers", expected="1 or more")
    kinds = [kind.strip() for kind in arguments.kinds.split(",") if kind.strip()]
    found = series(arguments.count, arguments.seed, kinds, arguments.video_share)
    if arguments.only:
        return remake(found, arguments.only, arguments.out)
    runner = Runner(arguments.out / "trials", workers=arguments.workers, scheduler=arguments.cluster)
    outcomes, refused = run_series(found, runner)
    options = f"--seed {arguments.seed} --kinds {','.join(kinds)} --video-share {arguments.video_share:g}"
    command = f"tentacle blind-trial {arguments.count} {options}"
    with written(arguments.out) as folder:
        (folder / "results.json").write_text(json.dumps(results(outcomes, refused), indent=1) + "\n")
        (folder / "calibration.toml").write_text(calibration_text(outcomes, command))
        write_report(page(outcomes, refused, Origin(command, arguments.seed, versions())), folder / "report.html")
    for name, value in figures(outcomes).items():
        print(f"{name:30s} {'no trial tells' if value is None else format(value, '.3f')}")
    print(f"report: {arguments.out / 'report.html'}")
    return 0


def calibration_text(outcomes: list, command: str) -> str:
    """The text of calibration.toml from these trials."""
    from discovery.trials.reliability import fit_calibration

    return fit_calibration(outcomes).toml(f"Isotonic fit to {len(outcomes)} blind trials: {command}")


def remake(found: list, chosen: list[int], out: Path) -> int:
    """Make the chosen trials' recordings again, for `tentacle diagnose`, with the truth beside each."""
    import json

    from tentacle.cli._blind_recording import trial_recording
    from tentacle.cli._outcome import written
    from tentacle.errors import InputError
    from tentacle.recording_rrd import write_rrd

    for index in chosen:
        if not 0 <= index < len(found):
            raise InputError(f"{index} is no trial of this series", field="--only", expected=f"0 to {len(found) - 1}")
        recording, truth = trial_recording(found[index])
        with written(out) as folder:
            write_rrd(recording, folder / f"{recording.name}.rrd")
            (folder / f"{recording.name}.truth.json").write_text(json.dumps(truth, indent=1) + "\n")
        print(f"{out / recording.name}.rrd")
    return 0

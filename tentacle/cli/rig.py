"""tentacle rig: the bench, from plugging in the board to optimising gaits on it. RIG.toml describes the rig."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import remark
from tentacle.cli._rig_arguments import configure_calibrate, configure_emulate, configure_split

HELP = "use the bench: find, check, calibrate, emulate, record, import, optimise, run a campaign"


def configure(parser: argparse.ArgumentParser) -> None:
    """Subcommands, each with its arguments."""
    verbs = parser.add_subparsers(dest="verb", metavar="COMMAND", required=True)

    def add(name: str, words: str, *, rig: bool = True) -> argparse.ArgumentParser:
        command = verbs.add_parser(name, help=words, description=words, allow_abbrev=False)
        if rig:
            command.add_argument("rig", type=Path, metavar="RIG.toml", help="port, limits, calibration, declaration")
        return command

    add("ports", "list the serial ports, and which one looks like an Arduino Due", rig=False)
    check = add("check", "check round trip, clock, limits, load cell, servo and camera; the arm does not move")
    check.add_argument("--json", action="store_true", help="print the findings as JSON")
    configure_calibrate(verbs.add_parser("calibrate", help=(words := "calibrate a part of the rig"), description=words))
    configure_emulate(
        add("emulate", "emulate the board and an arm behind a pseudo terminal; Ctrl-C ends it", rig=False)
    )

    record = add("record", "wait until the water is at rest, play a waveform, and record all signals")
    record.add_argument("waveform", type=Path, metavar="WAVEFORM.toml", help="a [waveform] table")
    record.add_argument("--seconds", type=float, required=True, help="how long the waveform is played")
    record.add_argument("--out", type=Path, required=True, metavar="FILE.rrd")
    record.add_argument("--view", action="store_true", help="show it in the Rerun viewer as it runs")

    convert = add("import", "convert the log of another rig (CSV), or a run (.rrd), to an import folder", rig=False)
    convert.add_argument("log", type=Path, metavar="LOG.csv|RUN.rrd")
    convert.add_argument("--declare", type=Path, metavar="recording.toml", help="the specimen of a CSV log")
    convert.add_argument("--columns", nargs="+", metavar="NAME", help="time, counts, grams (default: as thrust_bench)")
    convert.add_argument(
        "--calibration",
        nargs=2,
        type=float,
        metavar=("OFFSET", "COUNTS_PER_N"),
        help="calibration of the counts, instead of grams",
    )
    convert.add_argument("--out", type=Path, required=True, metavar="FOLDER")

    optimise = add(
        "optimise",
        "search for the best gait on the rig, starting from a model's best gaits; can be interrupted and continued",
    )
    optimise.add_argument("--model", type=Path, metavar="model.toml", help="the model whose best gaits are tried first")
    optimise.add_argument("--out", type=Path, required=True, metavar="FOLDER", help="journal and recordings")
    optimise.add_argument("--trials", type=int, default=30)
    optimise.add_argument(
        "--first", type=int, default=5, help="how many of the model's gaits are tried first (default: 5)"
    )
    optimise.add_argument("--frequency", nargs=2, type=float, default=(0.3, 3.0), metavar=("LOW", "HIGH"), help="[Hz]")
    optimise.add_argument("--harmonics", type=int, default=1, help="odd harmonics beyond the first (default: 1)")
    optimise.add_argument(
        "--reidentify",
        type=int,
        default=0,
        metavar="K",
        help="after every K trials diagnose the recordings and propose new gaits from the result",
    )
    optimise.add_argument("--seed", type=int, default=0)

    campaign = add("campaign", "make a list of runs; the same command continues an interrupted list")
    campaign.add_argument("campaign", type=Path, metavar="CAMPAIGN.toml")
    campaign.add_argument("--out", type=Path, required=True, metavar="FOLDER")
    configure_split(campaign)


def run(arguments: argparse.Namespace) -> int:
    """Runs the subcommand; a fault of the rig is one line and exit code 3."""
    from rig.fault import Fault
    from tentacle.cli import _rig_bench, _rig_calibrate, _rig_optimise, _rig_run, _rig_split

    commands = {
        "ports": _rig_bench.ports,
        "check": _rig_bench.check,
        "calibrate": _rig_calibrate.calibrate,
        "emulate": _rig_bench.emulate,
        "import": _rig_bench.convert,
        "record": _rig_run.record,
        "optimise": _rig_optimise.optimise,
        "campaign": _rig_split.until_split if getattr(arguments, "until_split", False) else _rig_run.campaign,
    }
    try:
        return commands[arguments.verb](arguments)
    except Fault as fault:
        remark(f"{fault.kind}: {fault}")
        return 3

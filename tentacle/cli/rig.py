"""tentacle rig: the bench, from plugging in the board to optimising gaits on it. RIG.toml says what the rig is."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

HELP = "the bench: find, check, calibrate, emulate, record, import, optimise, run a campaign"


def configure(parser: argparse.ArgumentParser) -> None:
    """Subcommands, each with its arguments."""
    verbs = parser.add_subparsers(dest="verb", metavar="COMMAND", required=True)

    def add(name: str, words: str, *, rig: bool = True) -> argparse.ArgumentParser:
        command = verbs.add_parser(name, help=words, description=words, allow_abbrev=False)
        if rig:
            command.add_argument("rig", type=Path, metavar="RIG.toml", help="port, limits, calibration, declaration")
        return command

    add("ports", "list the serial ports, and which one looks like an Arduino Due", rig=False)
    check = add("check", "round trip, clock, limits, load cell, servo and camera; the arm does not move")
    check.add_argument("--json", action="store_true", help="print the findings as JSON")
    _configure_calibrate(
        verbs.add_parser("calibrate", help=(words := "calibrate a part of the rig"), description=words)
    )
    _configure_emulate(add("emulate", "run the board's core behind a pty, with a plant; Ctrl-C ends it", rig=False))

    record = add("record", "settle, play a waveform, record it all as it happens")
    record.add_argument("waveform", type=Path, metavar="WAVEFORM.toml", help="a [waveform] table")
    record.add_argument("--seconds", type=float, required=True, help="how long the waveform is played")
    record.add_argument("--out", type=Path, required=True, metavar="FILE.rrd")
    record.add_argument("--view", action="store_true", help="show it in the Rerun viewer as it runs")

    convert = add("import", "a log of another rig (CSV), or a rig's own .rrd, to an import folder", rig=False)
    convert.add_argument("log", type=Path, metavar="LOG.csv|RUN.rrd")
    convert.add_argument("--declare", type=Path, metavar="recording.toml", help="the specimen of a CSV log")
    convert.add_argument("--columns", nargs="+", metavar="NAME", help="time, counts, grams (default: as thrust_bench)")
    convert.add_argument(
        "--calibration", nargs=2, type=float, metavar=("OFFSET", "COUNTS_PER_N"), help="instead of grams"
    )
    convert.add_argument("--out", type=Path, required=True, metavar="FOLDER")

    optimise = add("optimise", "search the best gait on the rig, started from a model's best; resumable")
    optimise.add_argument("--model", type=Path, metavar="model.toml", help="its best gaits are tried first")
    optimise.add_argument("--out", type=Path, required=True, metavar="FOLDER", help="journal and recordings")
    optimise.add_argument("--trials", type=int, default=30)
    optimise.add_argument("--first", type=int, default=5, help="how many of the model's gaits (default: 5)")
    optimise.add_argument("--frequency", nargs=2, type=float, default=(0.3, 3.0), metavar=("LOW", "HIGH"), help="[Hz]")
    optimise.add_argument("--harmonics", type=int, default=1, help="odd harmonics beyond the first (default: 1)")
    optimise.add_argument(
        "--reidentify", type=int, default=0, metavar="K", help="diagnose and propose anew every K trials"
    )
    optimise.add_argument("--seed", type=int, default=0)

    campaign = add("campaign", "a list of runs, resumed where it stopped")
    campaign.add_argument("campaign", type=Path, metavar="CAMPAIGN.toml")
    campaign.add_argument("--out", type=Path, required=True, metavar="FOLDER")


def _configure_calibrate(parser: argparse.ArgumentParser) -> None:
    parts = parser.add_subparsers(dest="part", metavar="PART", required=True)
    for name, words in (
        ("load-cell", "offset and counts per newton, from known masses"),
        ("servo", "pulses to angles, from angles measured at set points"),
        ("camera-scale", "m/px, from two points a known distance apart"),
        ("camera-offset", "the camera's delay, from flashes of the LED, or from servo taps"),
    ):
        part = parts.add_parser(name, help=words, description=words)
        part.add_argument("rig", type=Path, metavar="RIG.toml")
        if name == "load-cell":
            part.add_argument("--masses", nargs="+", type=float, required=True, metavar="KG", help="0 among them")
            part.add_argument(
                "--pulls-back", action="store_true", help="the masses pull along -y (against +y of the base)"
            )
            part.add_argument("--seconds", type=float, default=3.0, help="of reading a mass")
        elif name == "servo":
            part.add_argument(
                "--angles", nargs="+", type=float, required=True, metavar="RAD", help="set points to go to"
            )
            part.add_argument("--seconds", type=float, default=6.0, help="at each, to measure it (default: 6)")
        elif name == "camera-scale":
            part.add_argument("--points", nargs=4, type=float, required=True, metavar=("U1", "V1", "U2", "V2"))
            part.add_argument("--metres", type=float, required=True)
        else:
            part.add_argument("--flashes", type=int, default=24)
            part.add_argument("--tap", action="store_true", help="move the servo instead, where no LED is in sight")


def _configure_emulate(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="its port, and a rig.toml that fits it")
    parser.add_argument("--model", type=Path, metavar="model.toml", help="a MuJoCo arm; without it two stiff links")
    parser.add_argument(
        "--hidden", type=Path, metavar="HIDDEN.json", help="effects of the arm that no declaration mentions"
    )
    parser.add_argument("--rate", type=float, default=1.0, help="emulated seconds per second")
    parser.add_argument("--line", nargs=3, type=float, metavar=("CORRUPT", "DROP", "DOUBLE"), help="shares of bytes")
    parser.add_argument("--no-camera", action="store_true")
    parser.add_argument("--seed", type=int, default=1)


def run(arguments: argparse.Namespace) -> int:
    """Runs the subcommand; a fault of the rig is one line and exit code 3."""
    from rig.fault import Fault
    from tentacle.cli import _rig_bench, _rig_run

    commands = {
        "ports": _rig_bench.ports,
        "check": _rig_bench.check,
        "calibrate": _rig_bench.calibrate,
        "emulate": _rig_bench.emulate,
        "import": _rig_bench.convert,
        "record": _rig_run.record,
        "optimise": _rig_run.optimise,
        "campaign": _rig_run.campaign,
    }
    try:
        return commands[arguments.verb](arguments)
    except Fault as fault:
        print(f"tentacle: {fault.kind}: {fault}", file=sys.stderr)
        return 3

"""tentacle replay: from a log alone, run tracking, identification and diagnosis again, or drive an emulated rig with
it.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._device import add_device
from tentacle.cli._effects import add_effects
from tentacle.cli._output import remark, say
from tentacle.errors import InputError

HELP = "track and diagnose a recorded run (.rrd) again, or play its commands on a rig"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("recording", type=Path, metavar="FILE.rrd")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for verdict.json, report.html, ..."
    )
    parser.add_argument(
        "--baseline", nargs="+", default=[], type=Path, metavar="RECORDING", help="as in tentacle diagnose"
    )
    parser.add_argument("--calibration", type=Path, metavar="FILE.toml", help="as in tentacle diagnose")
    add_effects(parser)
    add_device(parser)
    parser.add_argument("--seed", type=int, help="as in tentacle diagnose (default: 0)")
    parser.add_argument(
        "--drive", type=Path, metavar="RIG.toml", help="play its commands on this (emulated) rig instead"
    )


def run(arguments: argparse.Namespace) -> int:
    """Diagnose again, or drive; 3 where the rig did not complete the run."""
    if arguments.drive is not None:
        diagnosing = (arguments.baseline, arguments.calibration is not None, arguments.device != "auto")
        if any(diagnosing) or arguments.seed is not None:
            field = "--baseline, --calibration, --device, --seed"
            raise InputError("has no part in driving a rig", field=field, expected="--drive alone")
        return _drive(arguments)
    from tentacle.cli import diagnose

    plan = argparse.Namespace(
        recordings=[arguments.recording],
        baseline=arguments.baseline,
        held_out=[],
        calibration=arguments.calibration,
        effects=arguments.effects,
        device=arguments.device,
        seed=arguments.seed or 0,
        out=arguments.out,
        json=False,
    )
    return diagnose.run(plan)


def _drive(arguments: argparse.Namespace) -> int:

    from rig.connection import connected
    from rig.fault import Fault
    from rig.interrupts import Interrupts
    from rig.replay import drive_rig
    from rig.setup_file import read_setup

    setup = read_setup(arguments.drive)
    out = arguments.out / f"{arguments.recording.stem}-replayed.rrd"
    try:
        with connected(setup) as board, Interrupts(lambda words: remark(words, "")) as interrupts:
            result, difference = drive_rig(arguments.recording, setup, board, out, interrupts=interrupts)
    except Fault as fault:
        remark(f"{fault.kind}: {fault}")
        return 3
    if difference is None:
        remark(f"{result.outcome}: {result.words}")
        return 3
    thrust = "not measured" if difference.thrust is None else f"{1e3 * difference.thrust:.2f} mN"
    say(f"{result.outcome}: {difference.seconds:.1f} s replayed into {out}")
    say(
        f"rms difference: command {1e3 * difference.command:.2f} mrad, angle {1e3 * difference.angle:.2f} mrad, "
        f"thrust {thrust}"
    )
    return 0 if result.outcome == "complete" else 3

"""Arguments of `tentacle rig calibrate` and `tentacle rig emulate`."""

from __future__ import annotations

import argparse
from pathlib import Path


def configure_calibrate(parser: argparse.ArgumentParser) -> None:
    """A part of the rig each, with its arguments."""
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
            part.add_argument(
                "--masses",
                nargs="+",
                type=float,
                required=True,
                metavar="KG",
                help="masses to hang on the load cell, 0 among them",
            )
            part.add_argument(
                "--pulls-back", action="store_true", help="the masses pull along -y (against +y of the base)"
            )
            part.add_argument("--seconds", type=float, default=3.0, help="how long each mass is read, default: 3")
        elif name == "servo":
            part.add_argument(
                "--angles", nargs="+", type=float, required=True, metavar="RAD", help="set points to go to"
            )
            part.add_argument(
                "--seconds", type=float, default=6.0, help="how long each angle is held for the measurement, default: 6"
            )
        elif name == "camera-scale":
            part.add_argument("--points", nargs=4, type=float, required=True, metavar=("U1", "V1", "U2", "V2"))
            part.add_argument("--metres", type=float, required=True)
        else:
            part.add_argument("--flashes", type=int, default=24)
            part.add_argument(
                "--tap",
                action="store_true",
                help="move the servo instead of flashing the LED, where the camera does not see the LED",
            )


def configure_emulate(parser: argparse.ArgumentParser) -> None:
    """Arguments of the emulated rig."""
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder for the emulated port and for its rig.toml")
    parser.add_argument(
        "--model", type=Path, metavar="model.toml", help="the arm to emulate with MuJoCo, default: two stiff links"
    )
    parser.add_argument(
        "--hidden", type=Path, metavar="HIDDEN.json", help="effects that act on the arm and are not declared"
    )
    parser.add_argument("--rate", type=float, default=1.0, help="emulated seconds per real second, default: 1")
    parser.add_argument(
        "--line",
        nargs=3,
        type=float,
        metavar=("CORRUPT", "DROP", "DOUBLE"),
        help="share of bytes on the line that are corrupted, dropped and doubled",
    )
    parser.add_argument("--no-camera", action="store_true")
    parser.add_argument("--seed", type=int, default=1)


def configure_split(parser: argparse.ArgumentParser) -> None:
    """Arguments of a campaign that goes on until its explanations are split."""
    parser.add_argument(
        "--until-split",
        action="store_true",
        help="after the list: diagnose all runs together, run the motion that best separates the explanations left, "
        "and repeat until one explanation holds 95 %% or no motion within the limits splits further",
    )
    parser.add_argument("--most", type=int, default=8, metavar="N", help="of --until-split: experiments (default: 8)")
    parser.add_argument(
        "--reference-every",
        type=int,
        default=2,
        metavar="N",
        help="of --until-split: repeat the reference motion before every Nth experiment (default: 2)",
    )
    parser.add_argument(
        "--repeats",
        type=int,
        default=6,
        metavar="N",
        help="of --until-split: first runs of the reference motion; a drift exceeds their scatter (default: 6)",
    )
    parser.add_argument("--seed", type=int, default=0, help="of --until-split: of the diagnosis and the motions tried")

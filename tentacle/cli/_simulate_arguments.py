"""Arguments of `tentacle simulate`, and the base motion that they name."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._effects import add_effects

if TYPE_CHECKING:
    from tentacle.base_motion import Travel
    from tentacle.waveform import Waveform


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("model", type=Path, metavar="MODEL.toml", help="specimen, fluid, gravity and effects")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR|FILE.rrd", help="where to write it")
    motion = parser.add_mutually_exclusive_group()
    motion.add_argument("--waveform", type=Path, metavar="FILE.toml", help="base motion, a [waveform] table")
    motion.add_argument(
        "--sine", nargs=2, type=float, metavar=("RAD", "HZ"), help="sine at the base: amplitude and frequency"
    )
    motion.add_argument(
        "--chirp",
        nargs=3,
        type=float,
        metavar=("RAD", "HZ", "HZ"),
        help="chirp at the base: amplitude, first and last frequency",
    )
    parser.add_argument(
        "--travel", type=Path, metavar="FILE.csv", help="where the base is, if it travels: t_s, x_m, y_m"
    )
    parser.add_argument(
        "--duration", type=float, default=12.0, metavar="S", help="duration of the recording, default: 12 s"
    )
    parser.add_argument("--fps", type=float, default=60.0, help="frames a second, default: 60")
    parser.add_argument(
        "--seed", type=int, default=0, help="seed of the noise and of all other random choices, default: 0"
    )
    parser.add_argument("--links", type=int, default=20, metavar="N", help="number of hinges of the chain, default: 20")
    parser.add_argument(
        "--noise-mm",
        type=float,
        default=0.15,
        metavar="MM",
        help="standard deviation of the midline's noise, default: 0.15",
    )
    parser.add_argument(
        "--servo-limits",
        nargs=3,
        type=float,
        metavar=("RAD", "RAD/S", "RAD/S2"),
        help="largest angle, speed and acceleration of the servo; a motion beyond them is refused",
    )
    parser.add_argument(
        "--hide",
        action="append",
        default=[],
        metavar="EFFECT[=VALUE]",
        help="an effect that acts and that the recording does not declare: tip_mass, tip_mass=faint, tip_mass=0.002, "
        "current=U_x:0.05,U_y:0",
    )
    add_effects(parser)
    parser.add_argument("--truth", type=Path, metavar="FILE.json", help="file for the hidden effects, outside --out")
    parser.add_argument(
        "--video", metavar="LOOK", help="write a video instead of the midline, in this look: clean, tank, ... or mujoco"
    )
    parser.add_argument(
        "--size", nargs=2, type=int, default=(960, 720), metavar=("W", "H"), help="size of the video [px]"
    )
    parser.add_argument(
        "--trials", type=int, metavar="N", help="write N blind recordings to --out, with effects drawn at random"
    )
    parser.add_argument(
        "--sealed", type=Path, metavar="FILE.jsonl", help="file for the answers of --trials, one line per trial"
    )
    parser.add_argument(
        "--most",
        type=int,
        default=1,
        metavar="N",
        help="largest number of effects in one trial of --trials, default: 1",
    )


def travel_of(arguments: argparse.Namespace) -> Travel | None:
    """The base's travel; None where it stands."""
    if arguments.travel is None:
        return None
    from tentacle.base_motion import fit_travel
    from tentacle.errors import InputError
    from tentacle.io.import_folder import read_travel

    path = read_travel(arguments.travel)
    if path is None:
        raise InputError("no such file", file=arguments.travel, expected="t_s, x_m, y_m")
    return fit_travel(path)


def base_motion_of(arguments: argparse.Namespace) -> Waveform:
    """The base motion; without a flag the chirp on which effects differ most, 0.3 to 2.2 Hz."""
    from tentacle.io.waveform_file import read_waveform
    from tentacle.waveform import Chirp, Sine

    if arguments.waveform is not None:
        return read_waveform(arguments.waveform)
    if arguments.sine is not None:
        return Sine(*arguments.sine)
    amplitude, start, stop = arguments.chirp or (0.5, 0.3, 2.2)
    return Chirp(amplitude, start, stop, arguments.duration)

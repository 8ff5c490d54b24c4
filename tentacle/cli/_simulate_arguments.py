"""Arguments of `tentacle simulate`, and the base motion that they name."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tentacle.waveform import Waveform


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("model", type=Path, metavar="MODEL.toml", help="specimen, fluid, gravity and effects")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR|FILE.rrd", help="where to write it")
    motion = parser.add_mutually_exclusive_group()
    motion.add_argument("--waveform", type=Path, metavar="FILE.toml", help="base motion, a [waveform] table")
    motion.add_argument("--sine", nargs=2, type=float, metavar=("RAD", "HZ"), help="amplitude and frequency")
    motion.add_argument("--chirp", nargs=3, type=float, metavar=("RAD", "HZ", "HZ"), help="amplitude, from, to")
    parser.add_argument("--duration", type=float, default=12.0, metavar="S", help="default: 12 s")
    parser.add_argument("--fps", type=float, default=60.0, help="frames a second, default: 60")
    parser.add_argument("--seed", type=int, default=0, help="of noise and of whatever is drawn, default: 0")
    parser.add_argument("--links", type=int, default=20, metavar="N", help="hinges of the chain, default: 20")
    parser.add_argument("--noise-mm", type=float, default=0.15, metavar="MM", help="of the midline, default: 0.15")
    parser.add_argument(
        "--servo-limits", nargs=3, type=float, metavar=("RAD", "RAD/S", "RAD/S2"), help="refuse a motion beyond them"
    )
    parser.add_argument(
        "--hide",
        action="append",
        default=[],
        metavar="EFFECT[=VALUE]",
        help="act, but do not declare: tip_mass, tip_mass=faint, tip_mass=0.002, current=U_x:0.05,U_y:0",
    )
    parser.add_argument("--truth", type=Path, metavar="FILE.json", help="where to write what is hidden (not in --out)")
    parser.add_argument("--video", metavar="LOOK", help="a video instead of the midline: clean, tank, ... or mujoco")
    parser.add_argument("--size", nargs=2, type=int, default=(960, 720), metavar=("W", "H"), help="of the video [px]")
    parser.add_argument("--trials", type=int, metavar="N", help="N blind recordings in --out, effects drawn at random")
    parser.add_argument("--sealed", type=Path, metavar="FILE.jsonl", help="with --trials: the answers, a line each")
    parser.add_argument("--most", type=int, default=1, metavar="N", help="with --trials: effects in one, default: 1")


def motion_of(arguments: argparse.Namespace) -> Waveform:
    """The base motion; without a flag the chirp on which effects differ most, 0.3 to 2.2 Hz."""
    from tentacle.io.waveform_file import read_waveform
    from tentacle.waveform import Chirp, Sine

    if arguments.waveform is not None:
        return read_waveform(arguments.waveform)
    if arguments.sine is not None:
        return Sine(*arguments.sine)
    amplitude, start, stop = arguments.chirp or (0.5, 0.3, 2.2)
    return Chirp(amplitude, start, stop, arguments.duration)

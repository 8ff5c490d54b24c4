"""tentacle calibrate: scale and lens from a ChArUco board in the arm's plane."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say

HELP = "find scale and lens from pictures of a ChArUco board in the arm's plane, under water"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("source", type=Path, nargs="?", metavar="VIDEO|FOLDER", help="pictures of the board")
    parser.add_argument("--out", type=Path, metavar="FILE.toml", help="where to write the lens, for track --lens")
    parser.add_argument("--print-board", type=Path, metavar="FILE.png", help="only write the board, to print it")
    parser.add_argument("--across", type=int, default=8, help="squares across (default: 8)")
    parser.add_argument("--down", type=int, default=6, help="squares down (default: 6)")
    parser.add_argument("--square", type=float, default=0.02, metavar="M", help="side of a square [m] (default: 0.02)")
    parser.add_argument(
        "--marker", type=float, default=0.015, metavar="M", help="side of a marker [m] (default: 0.015)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the board, or measure with it."""
    import math

    from tentacle.errors import InputError
    from tentacle.io.written_file import write_text
    from vision.calibrate import CharucoBoard, calibrate_lens
    from vision.encode import write_picture
    from vision.frames import read_frames
    from vision.lens_file import format_lens

    board = CharucoBoard(arguments.across, arguments.down, arguments.square, arguments.marker)
    if arguments.print_board is not None:
        write_picture(arguments.print_board, board.picture())
        say(f"wrote {arguments.print_board}: print it so that a square is {1e3 * board.square:g} mm")
        return 0
    if arguments.source is None or arguments.out is None:
        raise InputError(
            "there is nothing to measure", field="VIDEO --out", expected="pictures of the board, and --out"
        )
    found = calibrate_lens(read_frames(arguments.source, fps=1.0), board)
    text = format_lens(found.lens, rms_px=found.rms_px, tilt_rad=found.tilt)
    write_text(arguments.out, text)
    assert found.lens.metres_per_px is not None  # the board's squares give it
    views = "1 view" if found.views == 1 else f"{found.views} views"
    say(f"{views}, corners within {found.rms_px:.3f} px rms, {found.lens.metres_per_px:.6g} m/px")
    say(f"lens bends by {100 * found.lens.k1:.3f} % at the picture's corner")
    if found.tilt > math.radians(5.0):
        say(f"the board is tilted by {math.degrees(found.tilt):.1f} degrees: stand it parallel to the picture")
    say(f"wrote {arguments.out}")
    return 0
